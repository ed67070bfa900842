//! The Stanford polygon format: ascii and binary of both byte orders, packed or not.
//!
//! Elements may come in any order and properties under any of their usual names; what is unknown is skipped. Polygons
//! become fans of triangles.
//!
//! # Attributes
//! As in Mitsuba, further numbers of a vertex or face become an [`Attribute`](aureole_desc::Attribute) when they end in
//! a known series: `r g b` or `red green blue` alone are `vertex_color` (bytes are divided by 255); `heat_0` alone is
//! `vertex_heat` with one channel, `tint_x tint_y tint_z` is `vertex_tint` with three. On faces, `face_` stands before.
//!
//! # References
//! Turk 1994, "The PLY Polygon File Format".

mod body;
mod header;
mod layout;

use std::path::Path;

use aureole_desc::{Limits, Mesh, SceneError, Span};

use crate::file;
use crate::mesh::MeshError;

/// Reads a PLY file as it is: no normals are made up, texture coordinates are not turned.
///
/// # Errors
/// A file that cannot be read, is not PLY, ends early, or holds no triangle.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<Mesh, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode(&bytes, limits).map_err(|error| error.in_file(path, at))
}

/// Reads PLY from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(bytes: &[u8], limits: &Limits) -> Result<Mesh, MeshError> {
    let (header, rest) = header::Header::parse(bytes)?;
    let mesh = body::read(&header, rest, limits)?;
    if mesh.positions.is_empty() {
        return Err(MeshError::content("no vertices with x, y and z"));
    }
    if mesh.indices.is_empty() {
        return Err(MeshError::content("no faces: point clouds cannot be rendered"));
    }
    mesh.check().map_err(MeshError::Content)?;
    Ok(mesh)
}

/// Columns of a file's first element by their names, row by row: clouds of points are such tables.
///
/// # Errors
/// A file that cannot be read, is not PLY, ends early, or lacks a column.
pub fn read_columns(path: &Path, names: &[&str], limits: &Limits, at: Span) -> Result<Vec<f32>, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode_columns(&bytes, names, limits).map_err(|error| error.in_file(path, at))
}

/// The same from memory.
///
/// # Errors
/// As [`read_columns`].
pub fn decode_columns(bytes: &[u8], names: &[&str], limits: &Limits) -> Result<Vec<f32>, MeshError> {
    let (header, rest) = header::Header::parse(bytes)?;
    body::columns(&header, rest, names, limits)
}

#[cfg(test)]
mod tests;
