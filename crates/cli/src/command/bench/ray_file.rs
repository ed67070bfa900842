//! Mesh and ray files, little-endian.
//!
//! A mesh: `TRIMESH1`, number of vertices, number of triangles (32 bits each), vertices (three floats), triangles (three
//! numbers of 32 bits). Rays: `RAYSETS1`, number of sets, zero (32 bits each); for each set its kind, whether any hit will do
//! (32 bits each), number of rays, where they begin in the file (64 bits each); each ray as origin, t_min, direction, t_max.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use aureole::accel::Geometry;
use aureole::math::{Point3, Ray, Vector3};

use crate::exit::{Exit, Failure};

/// What the kinds of rays are called.
pub(super) const KINDS: [&str; 4] = ["primary", "shadow", "ao", "diffuse"];
/// Rays that a thread takes at once.
pub(super) const CHUNK: usize = 4096;

/// A ray as files have it: origin, t_min, direction, t_max.
pub(super) type Record = [f32; 8];

/// Rays of one kind.
pub(super) struct RaySet {
    pub kind: usize,
    /// Whether any hit will do.
    pub any: bool,
    pub rays: Vec<Record>,
}

/// The triangles of a mesh file.
pub(super) fn read_mesh(path: &Path) -> Result<Geometry, Failure> {
    let file = File::read(path, b"TRIMESH1")?;
    let (vertices, triangles) = (file.u32(8)? as usize, file.u32(12)? as usize);
    let positions = file.bytes(16, vertices, 12)?.chunks_exact(12).map(floats).collect::<Arc<[[f32; 3]]>>();
    let numbers = file.bytes(16 + 12 * vertices, triangles, 12)?.chunks_exact(12);
    let indices = numbers.map(|t| floats(t).map(f32::to_bits)).collect();
    Ok(Geometry::Triangles { positions, indices })
}

/// The rays of a ray file: of every `every` runs of [`CHUNK`] rays the first.
pub(super) fn read_rays(path: &Path, every: usize) -> Result<Vec<RaySet>, Failure> {
    let file = File::read(path, b"RAYSETS1")?;
    (0..file.u32(8)? as usize).map(|set| file.ray_set(16 + 24 * set, every)).collect()
}

struct File<'a> {
    path: &'a Path,
    content: Vec<u8>,
}

impl<'a> File<'a> {
    fn read(path: &'a Path, magic: &[u8; 8]) -> Result<Self, Failure> {
        let content = fs::read(path).map_err(|error| {
            Failure::new(Exit::Scene, format!("cannot read `{}`: {error}", path.display()))
        })?;
        let file = Self { path, content };
        if file.content.starts_with(magic) { Ok(file) } else { Err(file.broken("is of another kind")) }
    }

    fn broken(&self, what: &str) -> Failure {
        Failure::new(Exit::Scene, format!("`{}` {what}", self.path.display()))
    }

    /// `count` things of `size` bytes from a place on.
    fn bytes(&self, at: usize, count: usize, size: usize) -> Result<&[u8], Failure> {
        let end = count.checked_mul(size).and_then(|length| length.checked_add(at));
        end.and_then(|end| self.content.get(at..end)).ok_or_else(|| self.broken("ends too early"))
    }

    fn u32(&self, at: usize) -> Result<u32, Failure> {
        let bytes = self.bytes(at, 4, 1)?;
        Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
    }

    fn u64(&self, at: usize) -> Result<usize, Failure> {
        Ok((u64::from(self.u32(at)?) | u64::from(self.u32(at + 4)?) << 32) as usize)
    }

    fn ray_set(&self, at: usize, every: usize) -> Result<RaySet, Failure> {
        let kind = self.u32(at)? as usize;
        if kind >= KINDS.len() {
            return Err(self.broken("has a kind of rays that is not known"));
        }
        let rays = self.bytes(self.u64(at + 16)?, self.u64(at + 8)?, 32)?;
        let taken = rays.chunks(32 * CHUNK).step_by(every);
        let rays = taken.flat_map(|run| run.chunks_exact(32)).map(floats).collect();
        Ok(RaySet { kind, any: self.u32(at + 4)? != 0, rays })
    }
}

fn floats<const N: usize>(bytes: &[u8]) -> [f32; N] {
    std::array::from_fn(|i| f32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * i + byte])))
}

/// The ray of a record.
#[inline]
pub(super) fn ray(&[ox, oy, oz, t_min, dx, dy, dz, t_max]: &Record) -> Ray {
    let (origin, direction) = (Point3::new(ox, oy, oz), Vector3::new(dx, dy, dz));
    Ray { origin, t_min, direction, t_max, time: 0.0 }
}
