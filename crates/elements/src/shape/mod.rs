//! Shapes: what rays meet.
//!
//! A shape lives in the space of its level: the world, or the group that instances repeat. Its own object space is
//! folded in when it is built.

mod bilinear_mesh;
mod cube;
mod curve;
mod custom;
mod cylinder;
mod disk;
mod height_field;
mod mesh;
mod plane;
mod quadric;
mod rectangle;
mod refine;
mod sdf_grid;
mod sphere;
mod spline;
mod surface;
mod tube;

use std::fmt::Debug;
use std::sync::Arc;

use aureole_math::{Bounds3, Point2, Point3, Ray, Vector3};

pub use bilinear_mesh::BilinearMesh;
pub use cube::Cube;
pub use curve::Curve;
pub use custom::ShapeKind;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use height_field::HeightField;
pub use mesh::TriangleMesh;
pub use plane::Plane;
pub use rectangle::Rectangle;
pub use sdf_grid::SdfGrid;
pub use sphere::Sphere;
pub use surface::{ShapeSample, SurfacePoint};
pub use tube::Tube;

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    /// Ray parameter.
    pub t: f32,
    /// The triangle, patch or part; zero for shapes of one piece.
    pub primitive: u32,
    /// Coordinates on the primitive, whatever the shape wants to remember: barycentrics of vertices 1 and 2 for triangles.
    pub uv: [f32; 2],
}

/// How a shape wants to be put into an acceleration structure.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// As triangles, in level space: the accelerator's kernels find the hits.
    Triangles {
        /// Vertices.
        positions: Arc<[[f32; 3]]>,
        /// Vertex indices.
        indices: Arc<[[u32; 3]]>,
    },
    /// As boxes, one per primitive: the shape's own [`ShapeOps::intersect`] finds the hits.
    Boxes(Vec<Bounds3>),
    /// Not at all: every ray is tested against the shape by itself.
    Unbounded,
}

/// What every shape can do: whatever can be intersected and bounded can be rendered, accelerated and made to shine.
pub trait ShapeOps: Debug + Send + Sync {
    /// How the accelerator sees the shape: by its box, unless it says otherwise.
    fn geometry(&self) -> Geometry {
        Geometry::Boxes(vec![self.bounds()])
    }

    /// The box around the shape, in level space.
    fn bounds(&self) -> Bounds3;

    /// The nearest hit of a ray with one primitive. Shapes that are triangles to the accelerator need not answer.
    fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit>;

    /// Everything about the surface at a hit, in level space.
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint;

    /// Derivatives of the shading normal by u and v at a point of the surface; zero where they are not known.
    fn normal_change(&self, _at: &SurfacePoint, _hit: &ShapeHit) -> [Vector3; 2] {
        [Vector3::ZERO; 2]
    }

    /// Surface area; infinite where it is not known. Only shapes of known area can shine.
    fn area(&self) -> f32 {
        f32::INFINITY
    }

    /// The area of a triangle, patch or part.
    fn primitive_area(&self, _primitive: u32) -> f32 {
        self.area() / self.primitive_count() as f32
    }

    /// A point drawn by area, uniformly unless the shape was asked for something else. `None` where that is not possible.
    fn sample_area(&self, _: Point2) -> Option<ShapeSample> {
        None
    }

    /// A point drawn for light towards `reference`; its `pdf` is per steradian there.
    fn sample_towards(&self, reference: Point3, u: Point2) -> Option<ShapeSample> {
        self.sample_area(u)?.into_solid_angle(reference)
    }

    /// The density with which [`sample_towards`](Self::sample_towards) draws the surface point seen along unit `wi`.
    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        pdf_of_area(self.area(), reference, wi, surface)
    }

    /// Triangles, patches or parts.
    fn primitive_count(&self) -> usize {
        1
    }
}

/// The density per steradian of points that are drawn uniformly by area.
#[inline]
fn pdf_of_area(area: f32, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
    let d2 = (surface.p - reference).length_squared();
    let cos = wi.abs_dot(surface.ng);
    if cos > 0.0 { d2 / (cos * area) } else { 0.0 }
}

registry! {
    ($)
    /// Any built-in shape.
    Shape: ShapeOps, match with each_shape;
    mesh::TriangleMesh as Mesh = "mesh",
    sphere::Sphere as Sphere = "sphere",
    plane::Plane as Plane = "plane",
    disk::Disk as Disk = "disk",
    rectangle::Rectangle as Rectangle = "rectangle",
    cube::Cube as Cube = "cube",
    cylinder::Cylinder as Cylinder = "cylinder",
    bilinear_mesh::BilinearMesh as BilinearMesh = "bilinear_mesh",
    height_field::HeightField as HeightField = "height_field",
    sdf_grid::SdfGrid as SdfGrid = "sdf_grid",
    curve::Curve as Curve = "curve",
    tube::Tube as Tube = "tube",
}

impl Shape {
    /// How the accelerator sees the shape.
    pub fn geometry(&self) -> Geometry {
        each_shape!(self, s => s.geometry())
    }

    /// The box around the shape, in level space.
    pub fn bounds(&self) -> Bounds3 {
        each_shape!(self, s => s.bounds())
    }

    /// The nearest hit of a ray with one primitive.
    #[inline]
    pub fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
        each_shape!(self, s => s.intersect(ray, primitive))
    }

    /// Everything about the surface at a hit.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        each_shape!(self, s => s.surface(ray, hit))
    }

    /// Derivatives of the shading normal by u and v at a point of the surface; zero where they are not known.
    pub fn normal_change(&self, at: &SurfacePoint, hit: &ShapeHit) -> [Vector3; 2] {
        each_shape!(self, s => s.normal_change(at, hit))
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        each_shape!(self, s => s.area())
    }

    /// The area of a triangle, patch or part.
    pub fn primitive_area(&self, primitive: u32) -> f32 {
        each_shape!(self, s => s.primitive_area(primitive))
    }

    /// A point drawn by area.
    pub fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        each_shape!(self, s => s.sample_area(u))
    }

    /// A point drawn for light towards `reference`; its `pdf` is per steradian there.
    #[inline]
    pub fn sample_towards(&self, reference: Point3, u: Point2) -> Option<ShapeSample> {
        each_shape!(self, s => s.sample_towards(reference, u))
    }

    /// The density of [`sample_towards`](Self::sample_towards).
    #[inline]
    pub fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        each_shape!(self, s => s.pdf_towards(reference, wi, surface))
    }

    /// Triangles, patches or parts.
    pub fn primitive_count(&self) -> usize {
        each_shape!(self, s => s.primitive_count())
    }

    /// The mesh's attributes and the place of a hit on it, for textures that read them.
    pub fn mesh_point(&self, hit: &ShapeHit) -> Option<crate::texture::MeshPoint<'_>> {
        match self {
            Self::Mesh(mesh) => mesh.mesh_point(hit),
            _ => None,
        }
    }
}

/// The parameters that every shape understands besides its own; the scene's compiler reads those that are not geometry.
pub const COMMON_PARAMS: &[aureole_desc::ParamDoc] = &[
    aureole_desc::ParamDoc {
        name: "world_from_object",
        ty: "transform",
        default: "identity",
        doc: "where the shape is",
    },
    aureole_desc::ParamDoc {
        name: "flip_normals",
        ty: "bool",
        default: "false",
        doc: "turn the surface inside out",
    },
    aureole_desc::ParamDoc { name: "bsdf", ty: "bsdf", default: "diffuse", doc: "the material" },
    aureole_desc::ParamDoc {
        name: "emission",
        ty: "light",
        default: "",
        doc: "an `area` light that makes the shape shine",
    },
    aureole_desc::ParamDoc {
        name: "alpha",
        ty: "texture",
        default: "1",
        doc: "probability that the surface is there",
    },
];

/// Which points of a shape of many primitives light is drawn from.
pub(crate) const DRAWN: aureole_desc::ParamDoc = aureole_desc::ParamDoc {
    name: "drawn",
    ty: "string",
    default: "by_area",
    doc: "points are drawn `by_area`, or of `each_alike` of the primitives: for a `power` of each",
};

pub(crate) fn draws_all_alike(params: &mut aureole_desc::Params) -> Result<bool, aureole_desc::SceneError> {
    params.one_of("drawn", &[("by_area", false), ("each_alike", true)])
}

/// Where a shape is, and which side is outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// Level space from the shape's own.
    pub world_from_object: aureole_math::Transform,
    /// Whether normals are turned round.
    pub flip_normals: bool,
}

impl Placement {
    pub(crate) fn from_params(params: &mut aureole_desc::Params) -> Result<Self, aureole_desc::SceneError> {
        let world_from_object = params.transform("world_from_object")?;
        let flip_normals = params.bool("flip_normals", false)?;
        for name in ["bsdf", "emission", "alpha", "interior", "exterior"] {
            params.take(name); // read by the scene's compiler
        }
        if !world_from_object.is_invertible() {
            let at = params.span("world_from_object");
            return Err(aureole_desc::SceneError::invalid("the transform cannot be inverted", at));
        }
        Ok(Self { world_from_object, flip_normals })
    }
}
