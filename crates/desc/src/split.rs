//! Vertices whose faces disagree about them.

use std::hash::Hash;

use rustc_hash::FxHashMap;

use crate::{AttributeDomain, Mesh};

impl Mesh {
    /// Makes several vertices of each whose corners have different tags, one for each corner of the triangles in their order.
    ///
    /// Gives one of the corners of each vertex, as a place in that order; none for a vertex without a face.
    ///
    /// # Panics
    /// If a vertex of a face is not there, or an array is too short.
    pub fn split_vertices<T: Eq + Hash>(&mut self, tags: impl IntoIterator<Item = T>) -> Vec<Option<usize>> {
        let mut corners: Vec<Option<usize>> = vec![None; self.positions.len()];
        let mut copied: Vec<u32> = Vec::new();
        let mut vertex_of: FxHashMap<(u32, T), u32> = FxHashMap::default();
        for ((corner, index), tag) in self.indices.iter_mut().flatten().enumerate().zip(tags) {
            let old = *index;
            *index = *vertex_of.entry((old, tag)).or_insert_with(|| {
                let first = &mut corners[old as usize];
                if first.is_none() {
                    *first = Some(corner);
                    return old;
                }
                copied.push(old);
                corners.push(Some(corner));
                corners.len() as u32 - 1
            });
        }
        extend(&mut self.positions, &copied);
        extend(&mut self.normals, &copied);
        extend(&mut self.uvs, &copied);
        for attribute in self.attributes.iter_mut().filter(|a| a.domain == AttributeDomain::Vertex) {
            let n = attribute.channels;
            for &vertex in &copied {
                let first = vertex as usize * n;
                attribute.data.extend_from_within(first..first + n);
            }
        }
        corners
    }
}

/// Adds copies to a list, unless it is one that a mesh does not have.
fn extend<T: Copy>(list: &mut Vec<T>, copied: &[u32]) {
    if !list.is_empty() {
        list.reserve_exact(copied.len());
        copied.iter().for_each(|&i| list.push(list[i as usize]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Attribute;

    #[test]
    fn corners_that_agree_share_a_vertex() {
        let mut mesh = Mesh {
            positions: (0..5).map(|i| [i as f32; 3]).collect(),
            indices: vec![[0, 1, 2], [2, 1, 3]],
            attributes: vec![Attribute {
                name: "vertex_heat".to_owned(),
                domain: AttributeDomain::Vertex,
                channels: 1,
                data: vec![0.0, 1.0, 2.0, 3.0, 4.0],
            }],
            ..Mesh::default()
        };
        let corners = mesh.split_vertices("aabbac".chars());
        assert_eq!(mesh.indices, [[0, 1, 2], [2, 1, 3]], "the corners of 1 and of 2 agree");
        assert_eq!(corners, [Some(0), Some(1), Some(2), Some(5), None]);
        let corners = mesh.split_vertices("aabcdc".chars());
        assert_eq!(mesh.indices, [[0, 1, 2], [5, 6, 3]]);
        assert_eq!(corners[5..], [Some(3), Some(4)]);
        assert_eq!(mesh.positions[5..], [[2.0; 3], [1.0; 3]]);
        assert_eq!(mesh.attributes[0].data[5..], [2.0, 1.0]);
        mesh.check().unwrap();
    }
}
