//! The Stanford polygon format: ascii and binary of both byte orders, packed or not.
//!
//! Elements may come in any order and properties under any of their usual names; elements that are no vertices, faces or triangle
//! strips (`tristrips`) are left out with a note. Polygons become fans of triangles. Texture coordinates of faces (`texcoord`) go
//! before those of vertices.
//!
//! # Attributes
//! As in Mitsuba, further numbers of a vertex or face become an [`Attribute`](aureole_desc::Attribute) when they end in
//! a known series: `r g b` or `red green blue` alone are `vertex_color`; `heat_0` alone is `vertex_heat` with one channel,
//! `tint_x tint_y tint_z` is `vertex_tint` with three. On faces, `face_` stands before. Whole numbers of 8 and 16 bits are
//! divided by the largest of their type, colours of 32 bits by the largest of 8 or 16 where none goes beyond that.
//!
//! # References
//! Turk 1994, "The PLY Polygon File Format".

mod body;
mod faces;
mod header;
mod layout;
mod numbers;
mod pictures;
mod seams;

use std::path::Path;

use aureole_desc::{Limits, Mesh, SceneError, Span};

use crate::file;
use crate::mesh::{MeshError, MeshFile};

/// What a PLY file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyFile {
    /// The faces as they are: no normals are made up, texture coordinates are not turned.
    pub mesh: Mesh,
    /// The pictures that the file names for them (`comment TextureFile`).
    pub pictures: Vec<String>,
    /// Which of the pictures each triangle shows; empty where all show the first.
    pub picture_of: Vec<u32>,
    /// What is left out, in sentences.
    pub notes: Vec<String>,
}

/// Reads the mesh of a PLY file.
///
/// # Errors
/// A file that cannot be read, is not PLY, ends early, or holds no triangle.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<MeshFile, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    let PlyFile { mesh, notes, .. } = decode(&bytes, limits).map_err(|error| error.in_file(path, at))?;
    Ok(MeshFile { mesh, notes })
}

/// Reads PLY from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(bytes: &[u8], limits: &Limits) -> Result<PlyFile, MeshError> {
    let (header, rest) = header::Header::parse(bytes)?;
    let body::Content { mut mesh, mut corner_uvs, mut picture_of, notes } =
        body::read(&header, rest, limits)?;
    let notes = notes.finish();
    if mesh.positions.is_empty() {
        return Err(MeshError::content("no vertices with x, y and z"));
    }
    if mesh.indices.is_empty() {
        return Err(MeshError::nothing_but("no faces: point clouds cannot be rendered", &notes));
    }
    mesh.check().map_err(MeshError::Content)?;
    if !corner_uvs.is_empty() {
        corner_uvs.resize(3 * mesh.indices.len(), [f32::NAN; 2]);
        seams::split_at_seams(&mut mesh, &corner_uvs);
    }
    if !picture_of.is_empty() {
        picture_of.resize(mesh.indices.len(), 0);
    }
    Ok(PlyFile { mesh, pictures: header.pictures, picture_of, notes })
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
