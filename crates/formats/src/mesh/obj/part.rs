//! A mesh that grows corner by corner.

use aureole_desc::{Attribute, AttributeDomain, Mesh};
use rustc_hash::FxHashMap;

/// A part of a file: the faces of one object or group with one material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// The object's or group's name; empty when the file gives none.
    pub name: String,
    /// The material's name.
    pub material: Option<String>,
    /// The faces.
    pub mesh: Mesh,
}

/// Stands for a texture coordinate or normal that a corner does not have.
pub(super) const MISSING: u32 = u32::MAX;

/// Added to a smoothing group's number where a corner has one in the place of a normal.
const SMOOTH: u32 = 1 << 31;

/// A corner of a face: indices into the file's positions, texture coordinates and normals.
pub(super) type Corner = [u32; 3];

/// What stands for the normal of a corner that has none: a smoothing group, or nothing for group 0.
pub(super) fn smoothed(group: u32) -> u32 {
    if group == 0 { MISSING } else { SMOOTH | (group % (SMOOTH - 1)) }
}

/// The lists that corners point into.
#[derive(Debug, Default)]
pub(super) struct Pools {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// One for each position, none for those that have no colour; or an empty list.
    pub(super) colors: Vec<Option<[f32; 3]>>,
}

/// A part under construction.
#[derive(Debug, Default)]
pub(super) struct PartBuilder {
    pub(super) name: String,
    pub(super) material: Option<String>,
    corners: Vec<Corner>,
    vertices: FxHashMap<Corner, u32>,
    /// The faces; its other arrays are filled in at the end.
    mesh: Mesh,
    /// Vertices of the face at work.
    face: Vec<u32>,
}

impl PartBuilder {
    pub(super) fn new(name: String, material: Option<String>) -> Self {
        Self { name, material, ..Self::default() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.mesh.indices.is_empty()
    }

    pub(super) fn triangles(&self) -> usize {
        self.mesh.indices.len()
    }

    /// Adds a polygon.
    pub(super) fn add_face(&mut self, face: &[Corner]) {
        let mut vertices = std::mem::take(&mut self.face);
        vertices.clear();
        vertices.extend(face.iter().map(|&corner| self.vertex(corner)));
        self.mesh.add_face(&vertices);
        self.face = vertices;
    }

    fn vertex(&mut self, corner: Corner) -> u32 {
        *self.vertices.entry(corner).or_insert_with(|| {
            self.corners.push(corner);
            self.corners.len() as u32 - 1
        })
    }

    /// Looks the corners up in the pools. Positions must be there.
    pub(super) fn finish(mut self, pools: &Pools) -> Part {
        self.vertices = FxHashMap::default();
        let has_normal = |c: &Corner| (c[2] as usize) < pools.normals.len() || is_smoothed(c[2]);
        let with_normal = self.corners.iter().filter(|c| has_normal(c)).count();
        if with_normal > 0 && with_normal < self.corners.len() {
            self.part_from_neighbours(has_normal);
        }
        let corners = &self.corners;
        let mut mesh = self.mesh;
        mesh.positions = corners.iter().map(|c| pools.positions[c[0] as usize]).collect();
        let color = |c: &Corner| pools.colors.get(c[0] as usize).copied().flatten();
        if corners.iter().any(|c| color(c).is_some()) {
            let data = corners.iter().flat_map(|c| color(c).unwrap_or([1.0; 3])).collect();
            let (name, domain) = ("vertex_color".to_owned(), AttributeDomain::Vertex);
            mesh.attributes.push(Attribute { name, domain, channels: 3, data });
        }
        if corners.iter().any(|c| (c[1] as usize) < pools.uvs.len()) {
            let uv = |c: &Corner| pools.uvs.get(c[1] as usize).copied().unwrap_or_default();
            mesh.uvs = corners.iter().map(uv).collect();
        }
        if with_normal > 0 {
            mesh.normals = normals(&mesh, corners, pools);
        }
        Part { name: self.name, material: self.material, mesh }
    }

    /// Gives each corner without a normal a vertex of its own, so that its face stays flat beside those that are not.
    fn part_from_neighbours(&mut self, has_normal: impl Fn(&Corner) -> bool) {
        let mut is_taken = vec![false; self.corners.len()];
        for index in self.mesh.indices.iter_mut().flatten() {
            let corner = self.corners[*index as usize];
            if !has_normal(&corner) && std::mem::replace(&mut is_taken[*index as usize], true) {
                *index = self.corners.len() as u32;
                self.corners.push(corner);
            }
        }
    }
}

fn is_smoothed(normal: u32) -> bool {
    normal >= SMOOTH && normal != MISSING
}

/// The normals that are written; else those of the faces of one smoothing group around a position; else that of the face.
fn normals(mesh: &Mesh, corners: &[Corner], pools: &Pools) -> Vec<[f32; 3]> {
    if corners.iter().all(|c| (c[2] as usize) < pools.normals.len()) {
        return corners.iter().map(|c| pools.normals[c[2] as usize]).collect();
    }
    // Vertices that share a normal: those of one position and group, which texture coordinates may part.
    let mut shared: FxHashMap<[u32; 2], usize> = FxHashMap::default();
    let mut groups = 0;
    let mut new_group = || {
        groups += 1;
        groups - 1
    };
    let group_of: Vec<usize> = corners
        .iter()
        .map(|&[position, _, normal]| match is_smoothed(normal) {
            true => *shared.entry([position, normal]).or_insert_with(&mut new_group),
            false => new_group(),
        })
        .collect();
    let made = mesh.smooth_normals(groups, |vertex| group_of[vertex]);
    let normal = |(c, made): (&Corner, [f32; 3])| pools.normals.get(c[2] as usize).copied().unwrap_or(made);
    corners.iter().zip(made).map(normal).collect()
}
