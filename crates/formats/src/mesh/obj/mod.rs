//! Wavefront OBJ with its material libraries.
//!
//! Faces may have any number of corners, in any of the forms `v`, `v/vt`, `v//vn`, `v/vt/vn`, counted from the start or
//! (negative) from the end. Corners that agree in all three become one vertex. Colours behind positions (`v x y z r g b`, from 0 to
//! 1, 255 or 65535) or painted ones (`#MRGB`) become the attribute `vertex_color`; faces of more than three corners are remembered for
//! subdivision. In parts, corners without normals get smooth ones within their smoothing group (`s`); without such a group
//! they are flat.
//!
//! What is no face (points, lines, free-form curves and surfaces), faces of fewer than three corners and indices to texture
//! coordinates or normals that are not there are left out with a note.
//!
//! # References
//! Wavefront Technologies, "Advanced Visualizer Manual", appendices B1 (object files) and the MTL specification.

mod corner;
mod material;
mod parser;
mod part;
mod texture_map;
mod vertex;

use std::path::Path;

use aureole_desc::{Limits, SceneError, Span};

use crate::file;
use crate::mesh::{MeshError, MeshFile};

pub use material::{MaterialNote, Materials, ObjMaterial, parse_materials};
pub use parser::ObjFile;
pub use part::Part;
pub use texture_map::TextureMap;

/// How a file is cut up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Split {
    /// One mesh of everything.
    #[default]
    Nothing,
    /// A mesh for each run of an object or group with one material.
    Parts,
}

/// Reads a whole OBJ file as one mesh; materials and smoothing groups are not looked at.
///
/// # Errors
/// A file that cannot be read, is malformed, or holds no face.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<MeshFile, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    let in_file = |error: MeshError| error.in_file(path, at);
    let mut file = ObjFile::parse(&bytes, Split::Nothing, limits).map_err(in_file)?;
    match file.parts.pop() {
        Some(part) => Ok(MeshFile { mesh: part.mesh, notes: file.notes }),
        None => Err(in_file(file.no_faces())),
    }
}

#[cfg(test)]
mod tests;
