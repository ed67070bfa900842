//! How much memory a render will need, before it starts.
//!
//! A render that is killed after an hour because it was too large is worse than one that is refused at once. The estimate
//! follows the data: what the files said stays until the scene is built, each mesh is copied once into the world's space
//! and once into the leaves of the accelerator, pictures are kept as they are stored, and the film sums exactly.

use std::path::Path;

use aureole_desc::{Family, Limits, Mesh, Params, SceneDesc, Value};
use aureole_image::{Probe, probe_image};
use aureole_math::{Point3, Transform};
use rustc_hash::FxHashSet;

use crate::exact_sum::ExactSum;
use crate::film::Film;
use crate::integrator::channel_count;

/// The program itself, its tables and the state of its workers.
const BASE: u64 = 12 << 20;
/// Bytes of a triangle in the accelerator, once it is built (measured over meshes of 10⁵ to 5·10⁶ triangles).
const ACCEL_TRIANGLE: u64 = 62;
/// Further bytes of a triangle while it is built: boxes, order, the binary tree before it is widened (measured likewise).
const BUILD_TRIANGLE: u64 = 60;
/// Bytes of a triangle of a mesh that was divided: half a vertex with normal and texture coordinates, and indices. What the
/// dividing needs is less than what the accelerator needs later.
const REFINED_TRIANGLE: u64 = 16 + 12;
/// Bytes of any other shape or instance, with its boxes.
const OTHER_SHAPE: u64 = 1024;
/// Bytes of an instance that does not move, as it is described, as it is rendered, and while the accelerator is built.
const INSTANCE: [u64; 3] = [120, 640, 240];
/// The film is kept in tiles, which overlap as far as filters reach (half as much again for a Gaussian), and copied where it
/// is looked at: for a checkpoint, for the image.
const FILM_COPIES: u64 = 3;
/// Bytes of a pixel of the finished image: three floats.
const OUTPUT_PIXEL: u64 = 3 * 4;
/// Bytes of a pixel of a further channel.
const LAYER_PIXEL: u64 = FILM_COPIES * size_of::<ExactSum>() as u64 + size_of::<f32>() as u64;

/// Bytes that a render will need, by what needs them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// What the files said, kept until the scene is built.
    pub description: u64,
    /// Shapes as they are rendered.
    pub shapes: u64,
    /// The accelerator.
    pub acceleration: u64,
    /// What building the accelerator needs besides.
    pub building: u64,
    /// Textures and environment maps.
    pub textures: u64,
    /// The film, and the image that is written.
    pub film: u64,
}

impl MemoryEstimate {
    /// Estimates the memory of a description, once it is built and an image of some size is rendered. Pictures beyond the
    /// limits are not counted: they will be refused.
    pub fn new(desc: &SceneDesc, width: u32, height: u32, limits: &Limits) -> Self {
        let pixels = u64::from(width) * u64::from(height);
        let film = pixels * (FILM_COPIES * Film::BYTES_PER_PIXEL as u64 + OUTPUT_PIXEL);
        let [description, shapes, building] = INSTANCE.map(|bytes| bytes * desc.instances.len() as u64);
        let mut estimate = Self { description, shapes, building, film, ..Self::default() };
        let mut shared: FxHashSet<*const Mesh> = FxHashSet::default();
        let mut pictures: FxHashSet<&Path> = FxHashSet::default();
        for (_, node) in desc.nodes() {
            if node.family == Family::Shape {
                estimate.shapes += OTHER_SHAPE;
            }
            for param in node.params.iter() {
                match &param.value {
                    Value::Mesh(mesh) => {
                        let mut bytes = mesh_bytes(mesh);
                        let mut triangles = mesh.indices.len() as u64;
                        if shared.insert(std::sync::Arc::as_ptr(mesh)) {
                            estimate.description += bytes;
                        }
                        if let Some(refined) = refined_triangles(mesh, &node.params) {
                            let within = refined.min(limits.max_mesh_elements);
                            bytes = within.saturating_mul(REFINED_TRIANGLE);
                            triangles = within;
                        }
                        estimate.shapes += bytes;
                        estimate.acceleration += ACCEL_TRIANGLE * triangles;
                        estimate.building += BUILD_TRIANGLE * triangles;
                    }
                    Value::String(list) if node.family == Family::Integrator && param.name == "layers" => {
                        estimate.film += pixels.saturating_mul(LAYER_PIXEL * channel_count(list));
                    }
                    Value::String(format) if node.family == Family::Film && param.name == "pixel_format" => {
                        let has_alpha = u64::from(format.ends_with('a') || format.ends_with("alpha"));
                        estimate.film += pixels.saturating_mul(LAYER_PIXEL * has_alpha);
                    }
                    Value::Floats(list) => estimate.description += 4 * list.len() as u64,
                    Value::Ints(list) => estimate.description += 4 * list.len() as u64,
                    Value::Path(path) if pictures.insert(path) => {
                        // Environment maps keep the distribution that they are sampled by beside the picture.
                        let copies = if node.family == Family::Light { 2 } else { 1 };
                        let within =
                            |probe: &Probe| probe.width.saturating_mul(probe.height) <= limits.max_pixels;
                        let picture = probe_image(path).filter(within);
                        estimate.textures += copies * picture.as_ref().map_or(0, Probe::bytes);
                        if is_filtered(&node.params) {
                            // The smaller versions are a third of the picture, in floats.
                            let texels = picture.map_or(0, |probe| probe.width.saturating_mul(probe.height));
                            estimate.textures += texels.saturating_mul(4 * 4) / 3;
                        }
                    }
                    _ => {}
                }
            }
        }
        estimate
    }

    /// The most at once: while the accelerator is built, or while the image is rendered.
    pub fn peak(&self) -> u64 {
        let kept = BASE + self.shapes + self.acceleration + self.textures;
        kept + (self.description + self.building).max(self.film)
    }
}

/// Whether a picture is filtered by what a pixel covers.
fn is_filtered(params: &Params) -> bool {
    matches!(params.get("filter"), Some(Value::String(filter)) if filter == "trilinear" || filter == "ewa")
}

/// Triangles that a mesh is divided into before it is rendered, if it is: an estimate that is rather too high.
fn refined_triangles(mesh: &Mesh, params: &Params) -> Option<u64> {
    let levels = match params.get("levels") {
        Some(Value::Int(levels)) => (*levels).clamp(0, 12) as u32,
        _ => 3,
    };
    let divided = match params.get("subdivision") {
        Some(Value::String(scheme)) if scheme != "none" => {
            // Catmull and Clark's first level makes a quadrilateral of each corner.
            let corners = |list: &[u32]| list.iter().map(|&n| u64::from(n)).sum::<u64>();
            let faces = match scheme.as_str() {
                "catmull_clark" if mesh.polygons.is_empty() => mesh.indices.len() as u64 * 3 / 2,
                "catmull_clark" => corners(&mesh.polygons) / 2,
                _ => mesh.indices.len() as u64,
            };
            Some(faces.saturating_mul(1 << (2 * levels)))
        }
        _ => None,
    };
    if params.get("displacement").is_none() {
        return divided;
    }
    let edge = match params.get("edge_length") {
        Some(Value::Float(x)) => *x as f32,
        Some(Value::Int(x)) => *x as f32,
        _ => 1.0,
    };
    let place = match params.get("world_from_object") {
        Some(Value::Transform(place)) => *place,
        _ => Transform::default(),
    };
    // Dividing longest edges leaves triangles of an eighth of the squared edge or more, a fifth on average, but for slivers.
    let pieces = |t: &[u32; 3]| {
        let at =
            |i: u32| mesh.positions.get(i as usize).map_or(Point3::ORIGIN, |p| place.point(Point3::from(*p)));
        let [a, b, c] = t.map(at);
        let area = (b - a).cross(c - a).length() * 0.5;
        let around = (b - a).length() + (c - b).length() + (a - c).length();
        f64::from(1.0 + 6.0 * area / (edge * edge) + around / edge)
    };
    let displaced: f64 = mesh.indices.iter().map(pieces).sum();
    Some(divided.unwrap_or(0).max(displaced as u64))
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let attributes: usize = mesh.attributes.iter().map(|attribute| 4 * attribute.data.len()).sum();
    let vertices = 12 * (mesh.positions.len() + mesh.normals.len()) + 8 * mesh.uvs.len();
    (vertices + 12 * mesh.indices.len() + attributes) as u64
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use aureole_desc::{Node, Span};

    use super::*;

    #[test]
    fn refined_meshes_count_as_what_they_become() {
        let mesh = Arc::new(Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            indices: vec![[0, 1, 2], [0, 2, 3]],
            polygons: vec![4],
            ..Mesh::default()
        });
        let words = |scheme: &str| Params::new().with("subdivision", Value::String(scheme.to_owned()));
        assert_eq!(refined_triangles(&mesh, &Params::new()), None);
        assert_eq!(refined_triangles(&mesh, &words("none")), None);
        assert_eq!(refined_triangles(&mesh, &words("loop")), Some(2 * 64));
        assert_eq!(refined_triangles(&mesh, &words("catmull_clark")), Some(2 * 64));
        let displaced = Params::new()
            .with("displacement", Value::Float(0.1))
            .with("edge_length", Value::Float(0.01))
            .with("world_from_object", Value::Transform(Transform::scale(aureole_math::Vector3::splat(2.0))));
        let count = refined_triangles(&mesh, &displaced).expect("is refined");
        // Its area is 4; right-angled halves of an edge just below 0.01 are sixteen times 2^13.
        assert!((200_000..400_000).contains(&count), "{count}");
    }

    #[test]
    fn shared_meshes_are_described_once() {
        let mesh = Arc::new(Mesh {
            positions: vec![[0.0; 3]; 1000],
            indices: vec![[0; 3]; 2000],
            ..Mesh::default()
        });
        let mut desc = SceneDesc::default();
        for _ in 0..2 {
            let params = Params::new().with("mesh", Value::Mesh(mesh.clone()));
            desc.add(Node::new(Family::Shape, "mesh", params, Span::NONE));
        }
        let estimate = MemoryEstimate::new(&desc, 100, 50, &Limits::default());
        assert_eq!(estimate.description, 36_000);
        assert_eq!(estimate.acceleration, 4000 * ACCEL_TRIANGLE);
        assert!(estimate.film > 5000 * 64);
        assert!(estimate.peak() > BASE + 4000 * (ACCEL_TRIANGLE + BUILD_TRIANGLE));
    }
}
