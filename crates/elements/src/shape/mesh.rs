//! `mesh`: indexed triangles.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `mesh` | mesh | | positions, indices, and optionally normals, texture coordinates and attributes |
//! | `face_normals` | bool | false | ignore vertex normals |
//! | `default_uvs` | string | barycentric | of each triangle where the mesh has none: `barycentric` (0,0) (1,0) (0,1), or `half_square` (0,0) (1,0) (1,1), which tangents follow too |
//! | `drawn` | string | by_area | where it shines, points are drawn `by_area`, or of `each_alike` of its triangles |
//! | `subdivision`, `levels`, `crease_edges`, `crease_sharpness` | | | divide the faces first: `loop` or `catmull_clark` |
//! | `displacement`, `edge_length` | | | then move the surface by a texture |
//!
//! How meshes are refined: `refine/mod.rs`.

use std::sync::Arc;

use aureole_desc::{Attribute, Mesh, ParamDoc, Params, SceneError, Span};
use aureole_math::warp::SphericalTriangle;
use aureole_math::{
    Bounds3, Discrete, Frame, Normal3, Point2, Point3, Ray, Transform, Vector2, Vector3, gamma, warp,
};

use super::refine::Refinement;
use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint};
use crate::texture::MeshPoint;
use crate::{Element, Resolver};

/// A triangle mesh in level space.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    positions: Arc<[[f32; 3]]>,
    indices: Arc<[[u32; 3]]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    default_uvs: DefaultUvs,
    attributes: Vec<Attribute>,
    area: f32,
    /// Which triangles points are drawn from: in proportion to their area, or all alike; only for meshes that shine.
    drawn: Option<Arc<Discrete>>,
    all_alike: bool,
    /// +1, or -1 when the geometric normals are turned round.
    orientation: f32,
}

/// Texture coordinates of a triangle's vertices where a mesh has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DefaultUvs {
    /// Of the unit triangle (Mitsuba).
    Barycentric,
    /// Of half the unit square (pbrt).
    HalfSquare,
}

/// Area over squared distance from which drawing by solid angle is worth its time. On a Cornell box, whose lamp covers 0.04
/// from the floor, it spares a thirtieth of the variance and takes a third longer.
const NEAR: f32 = 0.25;
/// Outside these solid angles, drawing by them loses digits.
const MIN_SOLID_ANGLE: f32 = 0.01;
const MAX_SOLID_ANGLE: f32 = 6.22;

/// Whether something flat is so near to a point that it may be drawn by solid angle, judged by some points of it.
#[inline]
pub(super) fn is_near(reference: Point3, area: f32, points: &[Point3]) -> bool {
    let nearest = points.iter().fold(f32::INFINITY, |d2, &p| d2.min((p - reference).length_squared()));
    area > NEAR * nearest
}

/// Whether something that covers a solid angle can be drawn by it.
pub(super) fn is_sound(solid_angle: f32) -> bool {
    (MIN_SOLID_ANGLE..MAX_SOLID_ANGLE).contains(&solid_angle)
}

impl TriangleMesh {
    /// A mesh placed by a transform. `shines` prepares it for being sampled by area.
    ///
    /// # Errors
    /// An invalid index, arrays of wrong lengths, or vertices that are not finite.
    pub fn new(
        mesh: &Mesh,
        world_from_object: &Transform,
        flip_normals: bool,
        shines: bool,
    ) -> Result<Self, SceneError> {
        mesh.check().map_err(|message| SceneError::invalid(message, Span::NONE))?;
        let place = |p: &[f32; 3]| world_from_object.point(Point3::from(*p)).to_array();
        let positions: Arc<[[f32; 3]]> = mesh.positions.iter().map(place).collect();
        let broken = positions.iter().filter(|p| !Point3::from(**p).is_finite()).count();
        if broken > 0 {
            return Err(SceneError::invalid(format!("{broken} vertices are not finite numbers"), Span::NONE));
        }
        let turn = |n: &[f32; 3]| {
            let n = Vector3::from(world_from_object.normal(Normal3::from(*n)));
            let n = if flip_normals { -n } else { n };
            n.try_normalized().unwrap_or(Vector3::ZERO).to_array()
        };
        let normals = mesh.normals.iter().map(turn).collect();
        // A mirrored mesh would turn its cross products round; outside stays outside.
        let orientation = if flip_normals != world_from_object.swaps_handedness() { -1.0 } else { 1.0 };
        let mut this = Self {
            positions,
            indices: mesh.indices.as_slice().into(),
            normals,
            uvs: mesh.uvs.clone(),
            default_uvs: DefaultUvs::Barycentric,
            attributes: mesh.attributes.clone(),
            area: 0.0,
            drawn: None,
            all_alike: false,
            orientation,
        };
        let areas = |this: &Self| (0..this.indices.len()).map(|i| this.triangle_area(i)).collect::<Vec<_>>();
        let areas = areas(&this);
        this.area = areas.iter().map(|&a| f64::from(a)).sum::<f64>() as f32;
        if shines {
            this.drawn = Discrete::new(areas).map(Arc::new);
        }
        Ok(this)
    }

    /// Draws points from each triangle alike that has an area.
    fn draw_all_alike(&mut self) {
        let weights = (0..self.indices.len()).map(|i| if self.triangle_area(i) > 0.0 { 1.0 } else { 0.0 });
        self.drawn = Discrete::new(weights).map(Arc::new);
        self.all_alike = true;
    }

    fn triangle_area(&self, triangle: usize) -> f32 {
        0.5 * self.cross(triangle).length()
    }

    /// Density per unit area of points that are drawn from a triangle.
    #[inline]
    fn pdf_area(&self, triangle: usize) -> f32 {
        if self.all_alike {
            self.probability(triangle) / self.triangle_area(triangle)
        } else {
            1.0 / self.area
        }
    }

    /// Vertices of a triangle.
    #[inline]
    fn triangle(&self, primitive: usize) -> [Point3; 3] {
        let [i, j, k] = self.indices[primitive];
        let at = |i: u32| Point3::from(self.positions[i as usize]);
        [at(i), at(j), at(k)]
    }

    /// Twice the area times the unit normal, as the vertices turn.
    #[inline]
    fn cross(&self, primitive: usize) -> Vector3 {
        let [a, b, c] = self.triangle(primitive);
        (b - a).cross(c - a)
    }

    /// Texture coordinates of a triangle's vertices.
    #[inline]
    fn triangle_uvs(&self, primitive: usize) -> [Point2; 3] {
        if self.uvs.is_empty() {
            let last = if self.default_uvs == DefaultUvs::Barycentric { 0.0 } else { 1.0 };
            [Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(last, 1.0)]
        } else {
            let [i, j, k] = self.indices[primitive];
            let at = |i: u32| Point2::from(self.uvs[i as usize]);
            [at(i), at(j), at(k)]
        }
    }

    /// The mesh's attributes at a hit.
    pub(super) fn mesh_point(&self, hit: &ShapeHit) -> Option<MeshPoint<'_>> {
        if self.attributes.is_empty() {
            return None;
        }
        let [b1, b2] = hit.uv;
        Some(MeshPoint {
            attributes: &self.attributes,
            face: hit.primitive,
            vertices: self.indices[hit.primitive as usize],
            barycentric: [1.0 - b1 - b2, b1, b2],
        })
    }

    /// The point with given barycentric weights, its error, and its texture coordinates.
    #[inline]
    fn interpolate(&self, primitive: usize, b: [f32; 3]) -> (Point3, Vector3, Point2) {
        let [p0, p1, p2] = self.triangle(primitive);
        let [p0, p1, p2] = [p0.to_vector(), p1.to_vector(), p2.to_vector()];
        let p = p0 * b[0] + p1 * b[1] + p2 * b[2];
        let error = ((p0 * b[0]).abs() + (p1 * b[1]).abs() + (p2 * b[2]).abs()) * gamma(7);
        let [t0, t1, t2] = self.triangle_uvs(primitive);
        let uv =
            Point2::new(b[0] * t0.x + b[1] * t1.x + b[2] * t2.x, b[0] * t0.y + b[1] * t1.y + b[2] * t2.y);
        (p.to_point(), error, uv)
    }

    /// A point of the first two triangles as of a parallelogram with corners 0, 1, 2, 0 + 2 - 1; its density is left open.
    pub(super) fn sample_square(&self, at: Point2) -> ShapeSample {
        let (triangle, b) = if at.x >= at.y {
            (0, [1.0 - at.x, at.x - at.y, at.y])
        } else {
            (1, [at.x, at.y - at.x, 1.0 - at.y])
        };
        let (p, error, uv) = self.interpolate(triangle, b);
        ShapeSample { p, error, ng: self.outward(triangle), uv, primitive: triangle as u32, pdf: 0.0 }
    }

    /// The geometric normal of a triangle as a whole.
    fn outward(&self, triangle: usize) -> Vector3 {
        let ng = self.cross(triangle).normalized() * self.orientation;
        if self.normals.is_empty() {
            return ng;
        }
        let i = self.indices[triangle];
        ng.face_forward(i.iter().fold(Vector3::ZERO, |sum, &i| sum + Vector3::from(self.normals[i as usize])))
    }

    /// The probability that a triangle is drawn.
    fn probability(&self, triangle: usize) -> f32 {
        self.drawn.as_ref().map_or(0.0, |drawn| drawn.pmf(triangle))
    }

    /// What a triangle covers around a point that is so near that it should be drawn by that.
    #[inline]
    fn seen_from(&self, reference: Point3, triangle: usize) -> Option<SphericalTriangle> {
        let [a, b, c] = self.triangle(triangle);
        let center = a + ((b - a) + (c - a)) * (1.0 / 3.0);
        let area = 0.5 * (b - a).cross(c - a).length();
        if !is_near(reference, area, &[a, b, c, center]) {
            return None;
        }
        SphericalTriangle::new(reference, [a, b, c]).filter(|seen| is_sound(seen.solid_angle()))
    }

    /// Where the line from `reference` along `w` meets the plane of a triangle, moved into the triangle.
    fn barycentric(&self, triangle: usize, reference: Point3, w: Vector3) -> Option<[f32; 3]> {
        let [a, b, c] = self.triangle(triangle);
        let (e1, e2, s) = (b - a, c - a, reference - a);
        let p = w.cross(e2);
        let below = p.dot(e1);
        if below == 0.0 {
            return None;
        }
        let b1 = (s.dot(p) / below).clamp(0.0, 1.0);
        // Beyond the largest numbers.
        if b1.is_nan() {
            return None;
        }
        let b2 = (w.dot(s.cross(e1)) / below).clamp(0.0, 1.0 - b1);
        Some([1.0 - b1 - b2, b1, b2])
    }

    /// Derivatives of position by the texture coordinates [PBRT4, section 6.5.2].
    #[inline]
    fn derivatives(&self, primitive: usize, ng: Vector3) -> [Vector3; 2] {
        let [p0, p1, p2] = self.triangle(primitive);
        let (dp02, dp12) = (p0 - p2, p1 - p2);
        if !self.uvs.is_empty() || self.default_uvs == DefaultUvs::HalfSquare {
            let [t0, t1, t2] = self.triangle_uvs(primitive);
            let found = by_uv([dp02, dp12], [t0 - t2, t1 - t2]);
            if let Some([dp_du, dp_dv]) = found.filter(|[du, dv]| du.cross(*dv).length_squared() > 0.0) {
                return [dp_du, dp_dv];
            }
        }
        let frame = Frame::from_normal(ng);
        [frame.s, frame.t]
    }
}

/// Derivatives by u and v of what is linear over a triangle, from its differences to the third vertex and those of u and v.
#[inline]
fn by_uv([x02, x12]: [Vector3; 2], [t02, t12]: [Vector2; 2]) -> Option<[Vector3; 2]> {
    let inv = 1.0 / (t02.x * t12.y - t02.y * t12.x);
    let by = [(x02 * t12.y - x12 * t02.y) * inv, (x12 * t02.x - x02 * t12.x) * inv];
    (by[0].is_finite() && by[1].is_finite()).then_some(by)
}

impl Element for TriangleMesh {
    const SUMMARY: &'static str = "Indexed triangles.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "mesh",
            ty: "mesh",
            default: "",
            doc: "positions, indices, and optionally normals, uvs, attributes",
        },
        ParamDoc { name: "face_normals", ty: "bool", default: "false", doc: "ignore vertex normals" },
        ParamDoc {
            name: "default_uvs",
            ty: "string",
            default: "barycentric",
            doc: "of triangles where the mesh has none: `barycentric` or `half_square`",
        },
        super::DRAWN,
        Refinement::SUBDIVISION,
        Refinement::LEVELS,
        Refinement::CREASE_EDGES,
        Refinement::CREASE_SHARPNESS,
        Refinement::DISPLACEMENT,
        Refinement::EDGE_LENGTH,
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let mesh = params.try_mesh("mesh")?.ok_or_else(|| SceneError::MissingParam {
            element: "mesh".into(),
            param: "mesh".into(),
            wanted: "a triangle mesh".into(),
            at: Span::NONE,
        })?;
        let refinement = Refinement::from_params(params, resolver)?;
        let mesh = refinement.apply(mesh, &placement.world_from_object, resolver)?;
        let shines = params.has("emission");
        let mut built = Self::new(&mesh, &placement.world_from_object, placement.flip_normals, shines)?;
        if params.bool("face_normals", false)? {
            built.normals.clear();
        }
        if super::draws_all_alike(params)? && shines {
            built.draw_all_alike();
        }
        built.default_uvs = params.one_of(
            "default_uvs",
            &[("barycentric", DefaultUvs::Barycentric), ("half_square", DefaultUvs::HalfSquare)],
        )?;
        Ok(built)
    }
}

impl ShapeOps for TriangleMesh {
    fn geometry(&self) -> Geometry {
        Geometry::Triangles { positions: self.positions.clone(), indices: self.indices.clone() }
    }

    fn bounds(&self) -> Bounds3 {
        Bounds3::around(self.positions.iter().map(|p| Point3::from(*p)))
    }

    fn intersect(&self, _: &Ray, _: u32) -> Option<ShapeHit> {
        None
    }

    #[inline]
    fn surface(&self, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let primitive = hit.primitive as usize;
        let [b1, b2] = hit.uv;
        let b = [1.0 - b1 - b2, b1, b2];
        let (p, error, uv) = self.interpolate(primitive, b);
        let mut ng = self.cross(primitive).normalized() * self.orientation;
        let mut ns = ng;
        if !self.normals.is_empty() {
            let [i, j, k] = self.indices[primitive];
            let at = |i: u32| Vector3::from(self.normals[i as usize]);
            let (n0, n1, n2) = (at(i), at(j), at(k));
            if let Some(n) = (n0 * b[0] + n1 * b[1] + n2 * b[2]).try_normalized() {
                ns = n;
                // Vertex normals decide which side is outside, as in pbrt and Mitsuba.
                ng = ng.face_forward(n);
            }
        }
        let [dp_du, dp_dv] = self.derivatives(primitive, ng);
        let frame = Frame::from_normal_and_tangent(ns, dp_du);
        let (dn_duv, has_vertex_normals) = ([Vector3::ZERO; 2], !self.normals.is_empty());
        let primitive = hit.primitive;
        SurfacePoint { p, error, ng, frame, uv, dp_du, dp_dv, dn_duv, has_vertex_normals, primitive }
    }

    /// The derivatives of the interpolated normal, as it is before it is made a unit vector [PBRT4, section 6.5.3].
    fn normal_change(&self, _: &SurfacePoint, hit: &ShapeHit) -> [Vector3; 2] {
        if self.normals.is_empty() {
            return [Vector3::ZERO; 2];
        }
        let primitive = hit.primitive as usize;
        let [n0, n1, n2] = self.indices[primitive].map(|i| Vector3::from(self.normals[i as usize]));
        let [t0, t1, t2] = self.triangle_uvs(primitive);
        by_uv([n0 - n2, n1 - n2], [t0 - t2, t1 - t2]).unwrap_or([Vector3::ZERO; 2])
    }

    fn area(&self) -> f32 {
        self.area
    }

    fn primitive_area(&self, primitive: u32) -> f32 {
        self.triangle_area(primitive as usize)
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        let choice = self.drawn.as_ref()?.sample(u.x);
        let b = warp::square_to_triangle(Point2::new(choice.u, u.y));
        let (p, error, uv) = self.interpolate(choice.index, [1.0 - b.x - b.y, b.x, b.y]);
        let (ng, primitive) = (self.outward(choice.index), choice.index as u32);
        Some(ShapeSample { p, error, ng, uv, primitive, pdf: self.pdf_area(choice.index) })
    }

    fn sample_towards(&self, reference: Point3, u: Point2) -> Option<ShapeSample> {
        let choice = self.drawn.as_ref()?.sample(u.x);
        let seen = self.seen_from(reference, choice.index);
        let Some(seen) = seen else { return self.sample_area(u)?.into_solid_angle(reference) };
        let w = seen.sample(Point2::new(choice.u, u.y))?;
        let (p, error, uv) = self.interpolate(choice.index, self.barycentric(choice.index, reference, w)?);
        let pdf = self.probability(choice.index) / seen.solid_angle();
        Some(ShapeSample {
            p,
            error,
            ng: self.outward(choice.index),
            uv,
            primitive: choice.index as u32,
            pdf,
        })
    }

    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        let triangle = surface.primitive as usize;
        match self.seen_from(reference, triangle) {
            Some(seen) => self.probability(triangle) / seen.solid_angle(),
            None => super::pdf_of_area(1.0 / self.pdf_area(triangle), reference, wi, surface),
        }
    }

    fn primitive_count(&self) -> usize {
        self.indices.len()
    }
}

/// Implements [`ShapeOps`] for a newtype around [`TriangleMesh`].
macro_rules! delegate_to_mesh {
    ($T:ident) => {
        impl ShapeOps for $T {
            fn geometry(&self) -> Geometry {
                self.0.geometry()
            }
            fn bounds(&self) -> Bounds3 {
                self.0.bounds()
            }
            fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
                self.0.intersect(ray, primitive)
            }
            fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
                self.0.surface(ray, hit)
            }
            fn normal_change(&self, at: &SurfacePoint, hit: &ShapeHit) -> [Vector3; 2] {
                self.0.normal_change(at, hit)
            }
            fn area(&self) -> f32 {
                self.0.area()
            }
            fn primitive_area(&self, primitive: u32) -> f32 {
                self.0.primitive_area(primitive)
            }
            fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
                self.0.sample_area(u)
            }
            fn sample_towards(&self, reference: Point3, u: Point2) -> Option<ShapeSample> {
                self.0.sample_towards(reference, u)
            }
            fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
                self.0.pdf_towards(reference, wi, surface)
            }
            fn primitive_count(&self) -> usize {
                self.0.primitive_count()
            }
        }
    };
}
pub(super) use delegate_to_mesh;
