//! Vertex normals for meshes that have none.

use aureole_math::{Point3, Vector3};

use crate::Mesh;

impl Mesh {
    /// Gives vertices the normals of the faces around each, weighted by the faces' angles there; see
    /// [`smooth_normals`](Self::smooth_normals).
    pub fn add_smooth_normals(&mut self) {
        self.normals = self.smooth_normals(self.positions.len(), |vertex| vertex);
    }

    /// The normals of the faces around each of so many groups of vertices, weighted by the faces' angles there: one for each
    /// vertex.
    ///
    /// Vertices without a face, or whose faces cancel, get +Z, so that no normal is zero.
    ///
    /// # Panics
    /// If a vertex of a face is not there, or its group is none of them.
    ///
    /// # References
    /// Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics Tools 3(1).
    pub fn smooth_normals(&self, groups: usize, group_of: impl Fn(usize) -> usize) -> Vec<[f32; 3]> {
        let mut sums = vec![Vector3::ZERO; groups];
        for triangle in &self.indices {
            let p = triangle.map(|i| Point3::from(self.positions[i as usize]));
            let normal = (p[1] - p[0]).cross(p[2] - p[0]);
            let length = normal.length();
            if !(length > 0.0 && length.is_finite()) {
                continue;
            }
            for corner in 0..3 {
                let (a, b) = (p[(corner + 1) % 3] - p[corner], p[(corner + 2) % 3] - p[corner]);
                // atan2 keeps its precision at small and at flat angles, where acos loses it.
                let angle = length.atan2(a.dot(b));
                sums[group_of(triangle[corner] as usize)] += normal * (angle / length);
            }
        }
        let unit = |sum: Vector3| {
            let length = sum.length();
            if length > 0.0 && length.is_finite() { (sum / length).to_array() } else { [0.0, 0.0, 1.0] }
        };
        let units: Vec<[f32; 3]> = sums.into_iter().map(unit).collect();
        (0..self.positions.len()).map(|vertex| units[group_of(vertex)]).collect()
    }
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
        mesh.add_smooth_normals();
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
        mesh.add_smooth_normals();
        assert_eq!(mesh.normals, vec![[0.0, 0.0, 1.0]; 4]);
    }
}
