//! Vertex normals for meshes that have none.

use aureole_desc::Mesh;
use aureole_math::{Point3, Vector3};

/// Gives a mesh vertex normals: the normals of the faces around each vertex, weighted by the faces' angles there.
///
/// Vertices without a face, or whose faces cancel, get +Z, so that no normal is zero.
///
/// # References
/// Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics Tools 3(1).
pub fn add_smooth_normals(mesh: &mut Mesh) {
    let mut sums = vec![Vector3::ZERO; mesh.positions.len()];
    for triangle in &mesh.indices {
        let p = triangle.map(|i| Point3::from(mesh.positions[i as usize]));
        let normal = (p[1] - p[0]).cross(p[2] - p[0]);
        let length = normal.length();
        if !(length > 0.0 && length.is_finite()) {
            continue;
        }
        for corner in 0..3 {
            let (a, b) = (p[(corner + 1) % 3] - p[corner], p[(corner + 2) % 3] - p[corner]);
            // atan2 keeps its precision at small and at flat angles, where acos loses it.
            let angle = length.atan2(a.dot(b));
            sums[triangle[corner] as usize] += normal * (angle / length);
        }
    }
    mesh.normals = sums
        .into_iter()
        .map(|sum| {
            let length = sum.length();
            if length > 0.0 && length.is_finite() { (sum / length).to_array() } else { [0.0, 0.0, 1.0] }
        })
        .collect();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_corner_does_not_depend_on_how_its_faces_are_split() {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
        ];
        // The face at z = 0 is split through the corner, the others are not.
        let indices = vec![[0, 4, 1], [0, 2, 4], [0, 1, 3], [1, 5, 3], [0, 3, 2], [3, 6, 2]];
        let mut mesh = Mesh { positions, indices, ..Mesh::default() };
        add_smooth_normals(&mut mesh);
        for x in mesh.normals[0] {
            assert!((x + 1.0 / 3f32.sqrt()).abs() < 1e-6, "{:?}", mesh.normals[0]);
        }
    }

    #[test]
    fn degenerate_faces_do_no_harm() {
        let mut mesh = Mesh {
            positions: vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [f32::NAN; 3]],
            indices: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        add_smooth_normals(&mut mesh);
        assert_eq!(mesh.normals, vec![[0.0, 0.0, 1.0]; 4]);
    }
}
