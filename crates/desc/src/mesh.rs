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
}

impl Mesh {
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
