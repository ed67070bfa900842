//! Wavefront OBJ with its material libraries.
//!
//! Faces may have any number of corners, in any of the forms `v`, `v/vt`, `v//vn`, `v/vt/vn`, counted from the start or
//! (negative) from the end. Corners that agree in all three become one vertex. Curves, surfaces and smoothing groups are
//! skipped. Colours behind positions (`v x y z r g b`) become the attribute `vertex_color`; faces of more than three corners are
//! remembered for subdivision.
//!
//! # References
//! Wavefront Technologies, "Advanced Visualizer Manual", appendices B1 (object files) and the MTL specification.

mod material;
mod parser;
mod part;

use std::path::Path;

use aureole_desc::{Limits, Mesh, SceneError, Span};

use crate::file;
use crate::mesh::MeshError;

pub use material::{ObjMaterial, TextureMap, parse_materials};
pub use parser::ObjFile;
pub use part::Part;

/// How a file is cut up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Split {
    /// One mesh of everything.
    #[default]
    Nothing,
    /// A mesh for each run of an object or group with one material.
    Parts,
}

/// Reads a whole OBJ file as one mesh; materials are not looked at. Vertices that have no normal where others have one
/// get a smooth one.
///
/// # Errors
/// A file that cannot be read, is malformed, or holds no face.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<Mesh, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    let in_file = |error: MeshError| error.in_file(path, at);
    let mut file = ObjFile::parse(&bytes, Split::Nothing, limits).map_err(in_file)?;
    match file.parts.pop() {
        Some(part) => Ok(part.mesh),
        None => Err(in_file(MeshError::content("no faces"))),
    }
}

/// Reads an OBJ file in its parts.
///
/// # Errors
/// As [`read`].
pub fn read_parts(path: &Path, limits: &Limits, at: Span) -> Result<ObjFile, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    let file = ObjFile::parse(&bytes, Split::Parts, limits).map_err(|error| error.in_file(path, at))?;
    if file.parts.is_empty() {
        return Err(MeshError::content("no faces").in_file(path, at));
    }
    Ok(file)
}

#[cfg(test)]
mod tests;
