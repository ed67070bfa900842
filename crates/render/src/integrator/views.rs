//! `normals`, `depth`, `uv`, `albedo`, `primitive_id`: views of the first surface, for finding mistakes.

use aureole_desc::ParamDoc;
use aureole_math::hash_u32;
use aureole_scene::{Interaction, Scene, SceneHit};
use aureole_spectrum::{Spectrum, Wavelengths};

use super::{IntegratorManual, OneByOne, PathStart, RayIntegrator};

/// What is shown at a surface.
type Show = fn(&Scene, &PathStart, &SceneHit, &Interaction<'_>) -> [f32; 3];

pub(super) const NORMALS: IntegratorManual = IntegratorManual {
    kind: "normals",
    summary: "Shading normals in the world, [-1, 1] as [0, 1].",
    params: &[],
    build: |_| view(|_, _, _, at| at.surface.frame.n.to_array().map(|x| 0.5 + 0.5 * x)),
};

pub(super) const DEPTH: IntegratorManual = IntegratorManual {
    kind: "depth",
    summary: "Distance from the camera, in scene units.",
    params: &[ParamDoc {
        name: "from_near_clip",
        ty: "bool",
        default: "false",
        doc: "measure from the camera's near plane",
    }],
    build: |params| {
        if params.bool("from_near_clip", false)? {
            view(|_, start, hit, _| [hit.t - start.ray.t_min; 3])
        } else {
            view(|_, start, hit, _| [hit.t * start.ray.direction.length(); 3])
        }
    },
};

pub(super) const UV: IntegratorManual = IntegratorManual {
    kind: "uv",
    summary: "Surface parameters as red and green.",
    params: &[],
    build: |_| view(|_, _, _, at| [at.surface.uv.x.rem_euclid(1.0), at.surface.uv.y.rem_euclid(1.0), 0.0]),
};

pub(super) const ALBEDO: IntegratorManual = IntegratorManual {
    kind: "albedo",
    summary: "How much light surfaces scatter.",
    params: &[],
    build: |_| {
        view(|scene, start, _, at| {
            let wo = -start.ray.direction;
            scene.bsdf(at, wo, Wavelengths::RGB).albedo(wo).rgb()
        })
    },
};

pub(super) const PRIMITIVE_ID: IntegratorManual = IntegratorManual {
    kind: "primitive_id",
    summary: "A colour for each primitive.",
    params: &[],
    build: |_| {
        view(|_, _, hit, _| {
            let hash = hash_u32(hit.primitive ^ hash_u32(hit.geometry ^ hash_u32(hit.instance)));
            [0, 8, 16].map(|shift| 0.1 + 0.9 * ((hash >> shift) & 0xFF) as f32 / 255.0)
        })
    },
};

struct View(Show);

fn view(show: Show) -> Result<Box<dyn super::Integrator>, aureole_desc::SceneError> {
    Ok(Box::new(OneByOne(View(show))))
}

impl RayIntegrator for View {
    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum {
        *rays += 1;
        match scene.closest_hit(&start.ray) {
            Some(hit) => {
                let at = scene.interaction(&start.ray, &hit);
                Spectrum::from_rgb((self.0)(scene, start, &hit, &at))
            }
            None => Spectrum::ZERO,
        }
    }
}
