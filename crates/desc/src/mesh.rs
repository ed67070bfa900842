//! Triangle meshes as files give them.

/// Whether an attribute belongs to vertices or to faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeDomain {
    /// One value per vertex, interpolated over the triangle.
    Vertex,
    /// One value per face.
    Face,
}

/// A named quantity on a mesh, such as a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// The name that textures ask for, e.g. `vertex_color` or `face_color`.
    pub name: String,
    /// Vertices or faces.
    pub domain: AttributeDomain,
    /// Values per element: 1 or 3.
    pub channels: usize,
    /// `channels` values per vertex or face.
    pub data: Vec<f32>,
}

/// An indexed triangle mesh in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Triangles: three vertex indices each, counter-clockwise seen from outside.
    pub indices: Vec<[u32; 3]>,
    /// Vertex normals, or empty.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, v upwards, or empty.
    pub uvs: Vec<[f32; 2]>,
    /// Further quantities.
    pub attributes: Vec<Attribute>,
    /// Corners of each polygon that the triangles are fans of, in their order; empty where all faces are triangles.
    pub polygons: Vec<u32>,
}

impl Mesh {
    /// Adds a face of three or more corners as a fan around the first; gives the number of its triangles.
    pub fn add_face(&mut self, corners: &[u32]) -> usize {
        let [first, rest @ ..] = corners else { return 0 };
        if rest.len() < 2 {
            return 0;
        }
        // Only meshes with larger faces keep a list of them.
        if rest.len() > 2 && self.polygons.is_empty() {
            self.polygons.resize(self.indices.len(), 3);
        }
        if rest.len() > 2 || !self.polygons.is_empty() {
            self.polygons.push(corners.len() as u32);
        }
        self.indices.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        rest.len() - 1
    }

    /// The faces: corners, and the first of the triangles that a face is a fan of.
    pub fn faces(&self) -> impl Iterator<Item = (Vec<u32>, usize)> {
        let triangles = if self.polygons.is_empty() { self.indices.len() } else { 0 };
        let sizes = self.polygons.iter().copied().chain(std::iter::repeat_n(3, triangles));
        let mut at = 0;
        sizes.map(move |size| {
            let first = at;
            at += size.max(3) as usize - 2;
            let fan = self.indices.get(first..at).unwrap_or_default();
            let mut corners: Vec<u32> = fan.first().map(|t| t[..2].to_vec()).unwrap_or_default();
            corners.extend(fan.iter().map(|t| t[2]));
            (corners, first)
        })
    }

    /// Checks that every index names a vertex and that every array is as long as it must be.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn check(&self) -> Result<(), String> {
        let n = self.positions.len();
        if let Some(bad) = self.indices.iter().flatten().find(|&&i| i as usize >= n) {
            return Err(format!("vertex index {bad} is out of range: the mesh has {n} vertices"));
        }
        if !self.normals.is_empty() && self.normals.len() != n {
            return Err(format!("{} normals for {n} vertices", self.normals.len()));
        }
        if !self.uvs.is_empty() && self.uvs.len() != n {
            return Err(format!("{} texture coordinates for {n} vertices", self.uvs.len()));
        }
        let fans: u64 = self.polygons.iter().map(|&n| u64::from(n.max(3)) - 2).sum();
        if !self.polygons.is_empty() && fans != self.indices.len() as u64 {
            return Err(format!("polygons of {fans} triangles, where there are {}", self.indices.len()));
        }
        for attribute in &self.attributes {
            let count = match attribute.domain {
                AttributeDomain::Vertex => n,
                AttributeDomain::Face => self.indices.len(),
            };
            if attribute.data.len() != count * attribute.channels {
                return Err(format!(
                    "attribute `{}` has {} values, not {}",
                    attribute.name,
                    attribute.data.len(),
                    count * attribute.channels
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_survive_their_triangles() {
        let mut mesh = Mesh { positions: vec![[0.0; 3]; 7], ..Mesh::default() };
        mesh.add_face(&[0, 1, 2]);
        assert!(mesh.polygons.is_empty());
        assert_eq!(mesh.add_face(&[0, 2, 3, 4, 5]), 3);
        assert_eq!(mesh.add_face(&[4, 5]), 0);
        mesh.add_face(&[4, 5, 6]);
        let faces: Vec<_> = mesh.faces().collect();
        assert_eq!(faces, [(vec![0, 1, 2], 0), (vec![0, 2, 3, 4, 5], 1), (vec![4, 5, 6], 4)]);
        assert_eq!(mesh.check(), Ok(()));
        mesh.polygons.pop();
        assert!(mesh.check().is_err());
    }
}
