//! Vertex normals for meshes that have none.

use aureole_math::{Point3, Vector3};
use rustc_hash::FxHashMap;

use crate::Mesh;

impl Mesh {
    /// Gives vertices the normals of the faces around each, weighted by the faces' angles there; see
    /// [`smooth_normals`](Self::smooth_normals).
    pub fn add_smooth_normals(&mut self) {
        self.normals = self.smooth_normals(self.positions.len(), |vertex| vertex);
    }

    /// The same, but faces around a vertex that meet at more than an angle (in radians) stay apart: the vertex becomes several.
    ///
    /// Each face joins the first around its vertex whose normal is near enough, as with `maxSmoothAngle` in Mitsuba 0.6. Vertices that
    /// agree in place and texture coordinates count as one.
    ///
    /// # Panics
    /// If a vertex of a face is not there.
    pub fn add_smooth_normals_up_to(&mut self, angle: f32) {
        /// Around a vertex; with more, which no solid has, its further faces are flat.
        const MOST_CLUSTERS: usize = 64;
        let least_cos = angle.cos();
        // Around each place: a number and the normal of each cluster's first face.
        let mut clusters: FxHashMap<[u32; 5], Vec<(usize, Vector3)>> = FxHashMap::default();
        let mut count = 0;
        let mut cluster_of = Vec::with_capacity(3 * self.indices.len());
        for triangle in &self.indices {
            let [a, b, c] = triangle.map(|i| Point3::from(self.positions[i as usize]));
            let normal = (b - a).cross(c - a).try_normalized().unwrap_or(Vector3::ZERO);
            for &vertex in triangle {
                let [x, y, z] = self.positions[vertex as usize];
                let [u, v] = self.uvs.get(vertex as usize).copied().unwrap_or_default();
                let around = clusters.entry([x, y, z, u, v].map(|x| (x + 0.0).to_bits())).or_default();
                let near = around.iter().find(|(_, first)| first.dot(normal) > least_cos);
                cluster_of.push(near.map_or(count, |near| near.0));
                if near.is_none() {
                    if around.len() < MOST_CLUSTERS {
                        around.push((count, normal));
                    }
                    count += 1;
                }
            }
        }
        self.normals.clear();
        let corners = self.split_vertices(cluster_of.iter().copied());
        self.normals =
            self.smooth_normals(count + 1, |vertex| corners[vertex].map_or(count, |i| cluster_of[i]));
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
    fn edges_sharper_than_an_angle_stay_sharp() {
        // A roof of two squares that meet at 60 degrees along x, its halves with vertices of their own there.
        let (s, c) = (3f32.sqrt() / 2.0, 0.5);
        let roof = Mesh {
            positions: vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [1.0, 1.0, 0.0],
                [-0.0, 0.0, 0.0],
                [0.0, -c, -s],
                [1.0, -c, -s],
            ],
            indices: vec![[0, 1, 2], [2, 1, 3], [4, 5, 1], [1, 5, 6]],
            ..Mesh::default()
        };
        let normals_at_edge = |degrees: f32| {
            let mut mesh = roof.clone();
            mesh.add_smooth_normals_up_to(degrees.to_radians());
            mesh.check().unwrap();
            [mesh.normals[mesh.indices[0][0] as usize], mesh.normals[mesh.indices[2][0] as usize]]
        };
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        let [up, down] = normals_at_edge(59.0);
        assert!(near(up, [0.0, 0.0, 1.0]) && near(down, [0.0, -s, c]), "{up:?} {down:?}");
        let [up, down] = normals_at_edge(61.0);
        assert!(near(up, [0.0, -0.5, s]) && near(down, up), "halfway: {up:?} {down:?}");
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
