//! `ao`: how much of the sky each point of the first surface sees.

use aureole_desc::ParamDoc;
use aureole_elements::SurfacePoint;
use aureole_math::{Frame, Ray, warp};
use aureole_scene::Scene;
use aureole_spectrum::{Spectrum, Wavelengths};

use super::{FIRST_FREE_DIMENSION, IntegratorManual, OneByOne, PathStart, RayIntegrator};

pub(super) const MANUAL: IntegratorManual = IntegratorManual {
    kind: "ao",
    summary: "How much of the sky each point of the first surface sees.",
    params: &[
        ParamDoc {
            name: "distance",
            ty: "float",
            default: "-1",
            doc: "how far things occlude; -1 for any distance",
        },
        ParamDoc {
            name: "cos_sample",
            ty: "bool",
            default: "true",
            doc: "draw directions in proportion to the cosine",
        },
    ],
    build: |params| {
        let distance = params.float("distance", -1.0)?;
        let distance = if distance < 0.0 { f32::INFINITY } else { distance };
        Ok(Box::new(OneByOne(AmbientOcclusion { distance, cos_sample: params.bool("cos_sample", true)? })))
    },
};

struct AmbientOcclusion {
    distance: f32,
    cos_sample: bool,
}

/// The first surface on a camera ray that does not let all light pass straight on.
fn first_surface(scene: &Scene, mut ray: Ray, rays: &mut u64) -> Option<SurfacePoint> {
    /// As many surfaces that are not there are enough.
    const MOST: u32 = 1 << 12;
    for _ in 0..MOST {
        *rays += 1;
        let at = scene.interaction(&ray, &scene.closest_hit(&ray)?);
        if !scene.is_see_through()
            || scene.bsdf(&at, -ray.direction, Wavelengths::RGB).null_transmittance() != Spectrum::ONE
        {
            return Some(at.surface);
        }
        ray = at.surface.spawn_ray(ray.direction, ray.time);
    }
    None
}

impl RayIntegrator for AmbientOcclusion {
    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum {
        let Some(surface) = first_surface(scene, start.ray, rays) else { return Spectrum::ZERO };
        let n = surface.frame.n.face_forward(-start.ray.direction);
        let u = scene.sampler.get_2d(start.key, FIRST_FREE_DIMENSION);
        let (w, weight) = if self.cos_sample {
            (warp::square_to_cosine_hemisphere(u), 1.0)
        } else {
            let w = warp::square_to_uniform_hemisphere(u);
            (w, 2.0 * w.z)
        };
        *rays += 1;
        let ray = surface.spawn_ray(Frame::from_normal(n).to_world(w), start.ray.time).until(self.distance);
        if scene.occluded(&ray) { Spectrum::ZERO } else { Spectrum::splat(weight) }
    }
}
