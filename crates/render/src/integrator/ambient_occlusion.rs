//! `ao`: how much of the sky each point of the first surface sees.

use aureole_desc::ParamDoc;
use aureole_math::{Frame, warp};
use aureole_scene::Scene;
use aureole_spectrum::Spectrum;

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

impl RayIntegrator for AmbientOcclusion {
    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum {
        *rays += 1;
        let Some(hit) = scene.closest_hit(&start.ray) else { return Spectrum::ZERO };
        let surface = scene.interaction(&start.ray, &hit).surface;
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
