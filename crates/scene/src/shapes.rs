//! The scene's side of the accelerator: shapes that are not triangles, and cut-outs.

use aureole_accel::{Hit, UserHit, UserShapes};
use aureole_elements::TextureContext;
use aureole_elements::shape::ShapeHit;
use aureole_math::{Ray, hash_u64};
use aureole_spectrum::Wavelengths;

use crate::scene::{Object, Scene};

/// Answers the accelerator's questions; `ALPHA` when some surface has holes.
pub(crate) struct Lookup<'a, const ALPHA: bool>(pub &'a Scene);

impl<const ALPHA: bool> UserShapes for Lookup<'_, ALPHA> {
    const HAS_FILTER: bool = ALPHA;

    #[inline]
    fn intersect(&self, level: u32, geometry: u32, primitive: u32, ray: &Ray) -> Option<UserHit> {
        match &self.0.levels[level as usize][geometry as usize] {
            object @ Object::Solid { .. } => {
                let hit = self.0.first_there::<ALPHA>(object, primitive, ray)?;
                Some(UserHit { t: hit.t, u: hit.uv[0], v: hit.uv[1] })
            }
            Object::Instance(_) => None,
        }
    }

    fn accept(&self, level: u32, hit: &Hit, ray: &Ray) -> bool {
        let object = &self.0.levels[level as usize][hit.geometry as usize];
        let local = ShapeHit { t: hit.t, primitive: hit.primitive, uv: [hit.u, hit.v] };
        self.0.is_there(object, &local, ray)
    }
}

impl Scene {
    /// The nearest hit with a primitive that is not cut out there: behind a hole in a sphere is its other side.
    #[inline]
    pub(crate) fn first_there<const ALPHA: bool>(
        &self,
        object: &Object,
        primitive: u32,
        ray: &Ray,
    ) -> Option<ShapeHit> {
        /// More often than a ray meets most primitives.
        const MOST: u32 = 16;
        let Object::Solid { shape, .. } = object else { return None };
        let mut rest = *ray;
        for _ in 0..MOST {
            let hit = self.shapes[*shape].intersect(&rest, primitive)?;
            if !ALPHA || self.is_there(object, &hit, ray) {
                return Some(hit);
            }
            // Shapes find their hits in double precision.
            rest.t_min = hit.t * (1.0 + 2.0 * f32::EPSILON);
        }
        None
    }

    /// Whether a cut-out surface is there at a hit: by chance, but by the same chance for the same ray.
    pub(crate) fn is_there(&self, object: &Object, hit: &ShapeHit, ray: &Ray) -> bool {
        let Object::Solid { shape, alpha: Some(alpha), .. } = object else { return true };
        let shape = &self.shapes[*shape];
        let surface = shape.surface(ray, hit);
        let context = TextureContext {
            textures: &self.textures,
            wavelengths: Wavelengths::RGB,
            uv: surface.uv,
            p: surface.p,
            n: surface.frame.n,
            dp_duv: [surface.dp_du, surface.dp_dv],
            mesh: shape.mesh_point(hit),
            footprint: None,
        };
        let alpha = context.float(*alpha);
        if alpha >= 1.0 {
            return true;
        }
        let bits = |a: f32, b: f32| u64::from(a.to_bits()) << 32 | u64::from(b.to_bits());
        let hash = hash_u64(bits(surface.p.x, surface.p.y) ^ hash_u64(bits(surface.p.z, ray.direction.x)));
        alpha > 0.0 && ((hash >> 40) as f32 * (1.0 / 16_777_216.0)) < alpha
    }
}
