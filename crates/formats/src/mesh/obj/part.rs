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

/// A corner of a face: indices into the file's positions, texture coordinates and normals.
pub(super) type Corner = [u32; 3];

/// The lists that corners point into.
#[derive(Debug, Default)]
pub(super) struct Pools {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// One for each position, or none at all.
    pub(super) colors: Vec<[f32; 3]>,
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

    /// Looks the corners up in the pools.
    pub(super) fn finish(self, pools: &Pools) -> Part {
        let any = |field: usize| self.corners.iter().any(|corner| corner[field] != MISSING);
        let mut mesh = Mesh {
            positions: self.corners.iter().map(|corner| pools.positions[corner[0] as usize]).collect(),
            ..self.mesh
        };
        if !pools.colors.is_empty() {
            let data = gather(&self.corners, 0, &pools.colors).concat();
            let (name, domain) = ("vertex_color".to_owned(), AttributeDomain::Vertex);
            mesh.attributes.push(Attribute { name, domain, channels: 3, data });
        }
        if any(1) {
            mesh.uvs = gather(&self.corners, 1, &pools.uvs);
        }
        if any(2) {
            let written: Vec<[f32; 3]> = gather(&self.corners, 2, &pools.normals);
            mesh.normals = written;
            if self.corners.iter().any(|corner| corner[2] == MISSING) {
                fill_missing_normals(&mut mesh, &self.corners);
            }
        }
        Part { name: self.name, material: self.material, mesh }
    }
}

/// One value per corner; zeros where there is none.
fn gather<const N: usize>(corners: &[Corner], field: usize, pool: &[[f32; N]]) -> Vec<[f32; N]> {
    corners.iter().map(|corner| pool.get(corner[field] as usize).copied().unwrap_or([0.0; N])).collect()
}

/// Some corners have normals and some do not: the latter get smooth ones.
fn fill_missing_normals(mesh: &mut Mesh, corners: &[Corner]) {
    let written = std::mem::take(&mut mesh.normals);
    mesh.add_smooth_normals();
    for ((normal, written), corner) in mesh.normals.iter_mut().zip(written).zip(corners) {
        if corner[2] != MISSING {
            *normal = written;
        }
    }
}
