//! Meshes that show several pictures.

use std::collections::BTreeMap;

use aureole_desc::{Attribute, AttributeDomain, Mesh};
use rustc_hash::FxHashMap;

use super::PlyFile;

impl PlyFile {
    /// The mesh in parts that show one picture each, or none.
    pub(crate) fn into_parts(self) -> Vec<(Mesh, Option<String>)> {
        let first = self.picture_of.first().copied().unwrap_or(0);
        let picture = |number: u32| self.pictures.get(number as usize).cloned();
        if self.pictures.is_empty() || self.picture_of.iter().all(|&number| number == first) {
            return vec![(self.mesh, picture(first))];
        }
        let mut triangles: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (triangle, &number) in self.picture_of.iter().enumerate() {
            triangles.entry(number).or_default().push(triangle);
        }
        triangles.into_iter().map(|(number, some)| (select(&self.mesh, &some), picture(number))).collect()
    }
}

/// Some of a mesh's triangles, with their vertices.
fn select(mesh: &Mesh, triangles: &[usize]) -> Mesh {
    let mut vertices: Vec<usize> = Vec::new();
    let mut new_of: FxHashMap<u32, u32> = FxHashMap::default();
    let mut place = |old: u32| {
        *new_of.entry(old).or_insert_with(|| {
            vertices.push(old as usize);
            vertices.len() as u32 - 1
        })
    };
    let indices = triangles.iter().map(|&i| mesh.indices[i].map(&mut place)).collect();
    let attribute = |attribute: &Attribute| {
        let n = attribute.channels;
        let elements = if attribute.domain == AttributeDomain::Vertex { &vertices[..] } else { triangles };
        let data = elements.iter().flat_map(|&i| &attribute.data[i * n..(i + 1) * n]).copied().collect();
        Attribute { data, ..attribute.clone() }
    };
    Mesh {
        positions: vertices.iter().map(|&i| mesh.positions[i]).collect(),
        indices,
        normals: vertices.iter().filter_map(|&i| mesh.normals.get(i)).copied().collect(),
        uvs: vertices.iter().filter_map(|&i| mesh.uvs.get(i)).copied().collect(),
        attributes: mesh.attributes.iter().map(attribute).collect(),
        polygons: Vec::new(),
    }
}
