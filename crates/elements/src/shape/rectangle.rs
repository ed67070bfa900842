//! `rectangle`: the square [-1, 1]² in the plane z = 0, its normal along +Z, uv from 0 to 1.

use aureole_desc::{Mesh, ParamDoc, Params, SceneError};
use aureole_math::warp::SphericalRectangle;
use aureole_math::{Bounds3, Point2, Point3, Ray, Transform, Vector3};

use super::mesh::{is_near, is_sound};
use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint, TriangleMesh};
use crate::{Element, Resolver};

/// A parallelogram: to the accelerator two triangles.
#[derive(Clone, Debug)]
pub struct Rectangle {
    mesh: TriangleMesh,
    corner: Point3,
    sides: [Vector3; 2],
    /// Whether the sides are at right angles, so that it can be drawn by solid angle as a whole.
    is_right: bool,
}

impl Rectangle {
    /// The square [-1, 1]² placed by a transform.
    ///
    /// # Errors
    /// A transform that makes vertices infinite.
    pub fn new(world_from_object: &Transform, flip_normals: bool) -> Result<Self, SceneError> {
        let mesh = Mesh {
            positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
            indices: vec![[0, 1, 2], [2, 3, 0]],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            ..Mesh::default()
        };
        let mesh = TriangleMesh::new(&mesh, world_from_object, flip_normals, true)?;
        let corner = world_from_object.point(Point3::new(-1.0, -1.0, 0.0));
        let sides = [Vector3::X, Vector3::Y].map(|axis| world_from_object.vector(axis * 2.0));
        let skew = sides[0].dot(sides[1]).abs();
        let is_right = skew <= 1e-5 * sides[0].length() * sides[1].length();
        Ok(Self { mesh, corner, sides, is_right })
    }
}

impl Element for Rectangle {
    const SUMMARY: &'static str = "The square [-1, 1]^2 in the plane z = 0, its normal along +Z.";
    const PARAMS: &'static [ParamDoc] = &[];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        Self::new(&placement.world_from_object, placement.flip_normals)
    }
}

impl Rectangle {
    /// What the rectangle covers around a point that is so near that it should be drawn by that.
    #[inline]
    fn seen_from(&self, reference: Point3) -> Option<SphericalRectangle> {
        let (corner, [u, v]) = (self.corner, self.sides);
        let points = [corner, corner + u, corner + v, corner + u + v, corner + (u + v) * 0.5];
        if !(self.is_right && is_near(reference, u.cross(v).length(), &points)) {
            return None;
        }
        SphericalRectangle::new(reference, corner, self.sides).filter(|seen| is_sound(seen.solid_angle()))
    }
}

impl ShapeOps for Rectangle {
    fn geometry(&self) -> Geometry {
        self.mesh.geometry()
    }

    fn bounds(&self) -> Bounds3 {
        self.mesh.bounds()
    }

    fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
        self.mesh.intersect(ray, primitive)
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.mesh.surface(ray, hit)
    }

    fn area(&self) -> f32 {
        self.mesh.area()
    }

    fn primitive_area(&self, primitive: u32) -> f32 {
        self.mesh.primitive_area(primitive)
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        Some(ShapeSample { pdf: 1.0 / self.mesh.area(), ..self.mesh.sample_square(u) })
    }

    fn sample_towards(&self, reference: Point3, u: Point2) -> Option<ShapeSample> {
        if !self.is_right {
            return self.mesh.sample_towards(reference, u);
        }
        match self.seen_from(reference) {
            Some(seen) => {
                let at = seen.sample(u);
                Some(ShapeSample { pdf: 1.0 / seen.solid_angle(), ..self.mesh.sample_square(at) })
            }
            None => self.sample_area(u)?.into_solid_angle(reference),
        }
    }

    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        if !self.is_right {
            return self.mesh.pdf_towards(reference, wi, surface);
        }
        match self.seen_from(reference) {
            Some(seen) => 1.0 / seen.solid_angle(),
            None => super::pdf_of_area(self.mesh.area(), reference, wi, surface),
        }
    }

    fn primitive_count(&self) -> usize {
        self.mesh.primitive_count()
    }
}
