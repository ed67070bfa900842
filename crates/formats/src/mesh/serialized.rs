//! Mitsuba's serialized meshes: several meshes in one file, each packed by itself.
//!
//! A mesh is the magic number 0x041C and a version (3 or 4) as two 16-bit numbers, then a zlib stream: flags, a name (version
//! 4), counts of vertices and triangles (64 bits), positions, normals, texture coordinates, colours, indices. The file
//! ends with the offset of every mesh (32 bits in version 3, 64 in version 4) and their number. All is little-endian.

use std::io::{Read, Take};
use std::path::Path;

use aureole_desc::{Attribute, AttributeDomain, Limits, Mesh, SceneError, Span};
use flate2::bufread::ZlibDecoder;

use crate::file;
use crate::mesh::MeshError;
use crate::mesh::error::check_count;

const MAGIC: u16 = 0x041C;

const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE_PRECISION: u32 = 0x2000;

/// A mesh and what the file says about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SerializedMesh {
    /// The name; empty in version 3.
    pub name: String,
    /// Whether the file asks for flat shading.
    pub face_normals: bool,
    /// The mesh.
    pub mesh: Mesh,
}

/// Reads one of a file's meshes.
///
/// # Errors
/// A file that cannot be read or is malformed, or an index beyond its meshes.
pub fn read(path: &Path, index: usize, limits: &Limits, at: Span) -> Result<SerializedMesh, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode(&bytes, index, limits).map_err(|error| error.in_file(path, at))
}

/// Reads one of several meshes from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(bytes: &[u8], index: usize, limits: &Limits) -> Result<SerializedMesh, MeshError> {
    let version = header_version(bytes)?;
    let packed = locate(bytes, index, version)?;
    let version = header_version(packed)?;
    let most = limits.max_unpacked(packed.len());
    let mut stream = Stream { unpack: ZlibDecoder::new(&packed[4..]).take(most), most };

    let flags = u32::from_le_bytes(stream.array()?);
    let name = if version == 4 { stream.string()? } else { String::new() };
    let vertices = check_count("vertices", u64::from_le_bytes(stream.array()?), limits)?;
    let triangles = check_count("triangles", u64::from_le_bytes(stream.array()?), limits)?;

    let double = flags & DOUBLE_PRECISION != 0;
    let mut mesh = Mesh { positions: stream.vectors(vertices, double)?, ..Mesh::default() };
    if flags & HAS_NORMALS != 0 {
        mesh.normals = stream.vectors(vertices, double)?;
    }
    if flags & HAS_UVS != 0 {
        mesh.uvs = stream.vectors(vertices, double)?;
    }
    if flags & HAS_COLORS != 0 {
        let data = stream.vectors::<3>(vertices, double)?.concat();
        let name = "vertex_color".to_owned();
        mesh.attributes.push(Attribute { name, domain: AttributeDomain::Vertex, channels: 3, data });
    }
    mesh.indices = stream.triangles(triangles)?;
    mesh.check().map_err(MeshError::Content)?;
    Ok(SerializedMesh { name, face_normals: flags & FACE_NORMALS != 0, mesh })
}

fn header_version(bytes: &[u8]) -> Result<u16, MeshError> {
    match bytes {
        [a, b, c, d, ..] if u16::from_le_bytes([*a, *b]) == MAGIC => match u16::from_le_bytes([*c, *d]) {
            version @ (3 | 4) => Ok(version),
            version => Err(MeshError::content(format!("unknown version {version} of serialized meshes"))),
        },
        _ => Err(MeshError::content("not a serialized mesh: the magic number is missing")),
    }
}

/// The bytes of mesh number `index`, by the table at the end.
fn locate(bytes: &[u8], index: usize, version: u16) -> Result<&[u8], MeshError> {
    let broken = || MeshError::content("the table at the end is broken");
    let (rest, count) = bytes.split_last_chunk::<4>().ok_or_else(broken)?;
    let count = u32::from_le_bytes(*count) as usize;
    let width = if version == 4 { 8 } else { 4 };
    let table_start =
        count.checked_mul(width).and_then(|size| rest.len().checked_sub(size)).ok_or_else(broken)?;
    if index >= count {
        return Err(MeshError::content(format!(
            "there is no mesh {index}: the file has {count}, counted from 0"
        )));
    }
    let offset = |i: usize| {
        let entry = &rest[table_start + i * width..][..width];
        entry.iter().rev().fold(0usize, |value, &byte| value << 8 | usize::from(byte))
    };
    let end = if index + 1 < count { offset(index + 1) } else { table_start };
    rest.get(offset(index)..end.min(table_start)).ok_or_else(broken)
}

/// An unpacking stream of little-endian values.
struct Stream<'a> {
    unpack: Take<ZlibDecoder<&'a [u8]>>,
    /// Bytes that it may unpack to.
    most: u64,
}

impl Stream<'_> {
    /// Reads exactly `size` bytes; memory grows only as bytes come.
    fn bytes(&mut self, size: usize) -> Result<Vec<u8>, MeshError> {
        let mut bytes = Vec::new();
        self.unpack
            .by_ref()
            .take(size as u64)
            .read_to_end(&mut bytes)
            .map_err(|error| MeshError::content(format!("cannot unpack: {error}")))?;
        if bytes.len() < size && self.unpack.limit() == 0 {
            let what = "unpacked size in bytes".to_owned();
            let name = "max-unpack-ratio";
            return Err(MeshError::Limit { what, found: self.most + 1, limit: self.most, name });
        }
        if bytes.len() < size {
            return Err(MeshError::content(format!(
                "ends early: {size} bytes expected, found {}",
                bytes.len()
            )));
        }
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let mut array = [0; N];
        array.copy_from_slice(&self.bytes(N)?);
        Ok(array)
    }

    /// Text that ends with a zero byte.
    fn string(&mut self) -> Result<String, MeshError> {
        const LONGEST: usize = 4096;
        let mut text = Vec::new();
        loop {
            match self.array::<1>()? {
                [0] => return Ok(String::from_utf8_lossy(&text).into_owned()),
                _ if text.len() == LONGEST => {
                    return Err(MeshError::content("the name of a mesh does not end"));
                }
                [byte] => text.push(byte),
            }
        }
    }

    fn vectors<const N: usize>(&mut self, count: usize, double: bool) -> Result<Vec<[f32; N]>, MeshError> {
        let width = if double { 8 } else { 4 };
        let bytes = self.bytes(count.saturating_mul(N * width))?;
        let number = |bytes: &[u8]| match *bytes {
            [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
            _ => 0.0,
        };
        let vector = |bytes: &[u8]| std::array::from_fn(|i| number(&bytes[i * width..][..width]));
        Ok(bytes.chunks_exact(N * width).map(vector).collect())
    }

    fn triangles(&mut self, count: usize) -> Result<Vec<[u32; 3]>, MeshError> {
        let bytes = self.bytes(count.saturating_mul(12))?;
        let index = |b: &[u8], i: usize| u32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
        Ok(bytes.chunks_exact(12).map(|b| [index(b, 0), index(b, 4), index(b, 8)]).collect())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use aureole_math::Pcg32;

    use super::*;

    /// Two triangles as two meshes, the second in double precision.
    fn example(version: u16) -> Vec<u8> {
        let mut file = Vec::new();
        let mut offsets = Vec::new();
        for (flags, name) in [
            (HAS_NORMALS | HAS_UVS | 0x1000, "first"),
            (HAS_COLORS | FACE_NORMALS | DOUBLE_PRECISION, "second"),
        ] {
            let mut body = flags.to_le_bytes().to_vec();
            if version == 4 {
                body.extend(name.bytes().chain([0]));
            }
            body.extend([3u64, 1].iter().flat_map(|n| n.to_le_bytes()));
            let numbers = if flags & HAS_NORMALS != 0 { 3 * (3 + 3 + 2) } else { 3 * (3 + 3) };
            for i in 0..numbers {
                let value = f64::from(i) / 8.0;
                if flags & DOUBLE_PRECISION != 0 {
                    body.extend(value.to_le_bytes());
                } else {
                    body.extend((value as f32).to_le_bytes());
                }
            }
            body.extend([0u32, 2, 1].iter().flat_map(|n| n.to_le_bytes()));
            offsets.push(file.len());
            file.extend(MAGIC.to_le_bytes().iter().chain(&version.to_le_bytes()));
            let mut encoder = flate2::write::ZlibEncoder::new(&mut file, flate2::Compression::fast());
            encoder.write_all(&body).unwrap();
            encoder.finish().unwrap();
        }
        for offset in &offsets {
            match version {
                4 => file.extend((*offset as u64).to_le_bytes()),
                _ => file.extend((*offset as u32).to_le_bytes()),
            }
        }
        file.extend((offsets.len() as u32).to_le_bytes());
        file
    }

    #[test]
    fn both_versions_and_precisions() {
        for version in [3, 4] {
            let file = example(version);
            let first = decode(&file, 0, &Limits::default()).unwrap();
            assert_eq!(first.name, if version == 4 { "first" } else { "" });
            assert_eq!(first.mesh.positions[1], [0.375, 0.5, 0.625]);
            assert_eq!(first.mesh.normals[0], [1.125, 1.25, 1.375]);
            assert_eq!(first.mesh.uvs[2], [2.75, 2.875]);
            assert_eq!(first.mesh.indices, [[0, 2, 1]]);
            let second = decode(&file, 1, &Limits::default()).unwrap();
            assert!(second.face_normals && second.mesh.normals.is_empty());
            assert_eq!(second.mesh.attributes[0].data.len(), 9);
        }
        let error = decode(&example(4), 2, &Limits::default()).unwrap_err();
        assert_eq!(error.to_string(), "there is no mesh 2: the file has 2, counted from 0");
    }

    #[test]
    fn broken_files_never_panic() {
        let mut rng = Pcg32::new(3);
        let whole = example(4);
        for _ in 0..20_000 {
            let mut bytes = whole.clone();
            for _ in 0..rng.next_u32() % 3 {
                let i = rng.next_u32() as usize % bytes.len();
                bytes[i] ^= 1 << (rng.next_u32() % 8);
            }
            bytes.truncate(rng.next_u32() as usize % (2 * whole.len()));
            let limits = Limits { max_mesh_elements: 1000, ..Limits::default() };
            for index in 0..2 {
                if let Ok(read) = decode(&bytes, index, &limits) {
                    read.mesh.check().unwrap();
                }
            }
        }
    }
}
