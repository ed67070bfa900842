//! `direct`: light that reaches the first surface straight from lights, by samples of lights and of BSDFs.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_elements::Bsdf;
use aureole_elements::bsdf::TransportMode;
use aureole_math::Vector3;
use aureole_scene::{Interaction, Scene};
use aureole_spectrum::{Spectrum, Wavelengths};

use super::lighting::{LightNumbers, Weighting, environment, light_pdf, power_heuristic, sample_light};
use super::{FIRST_FREE_DIMENSION, IntegratorManual, OneByOne, PathStart, RayIntegrator};

pub(super) const MANUAL: IntegratorManual = IntegratorManual {
    kind: "direct",
    summary: "Light that reaches the first surface straight from lights.",
    params: &[
        ParamDoc { name: "emitter_samples", ty: "int", default: "1", doc: "samples of lights" },
        ParamDoc { name: "bsdf_samples", ty: "int", default: "1", doc: "samples of BSDFs" },
        ParamDoc {
            name: "hide_emitters",
            ty: "bool",
            default: "false",
            doc: "lights are not seen by the camera itself",
        },
    ],
    build: |params| Ok(Box::new(OneByOne(Direct::from_params(params)?))),
};

struct Direct {
    emitter_samples: u32,
    bsdf_samples: u32,
    hide_emitters: bool,
}

impl Direct {
    fn from_params(params: &mut Params) -> Result<Self, SceneError> {
        let mut count = |name| params.int_in(name, 1, 0, 1 << 16).map(|n| n as u32);
        Ok(Self {
            emitter_samples: count("emitter_samples")?,
            bsdf_samples: count("bsdf_samples")?,
            hide_emitters: params.bool("hide_emitters", false)?,
        })
    }

    fn by_lights(
        &self,
        scene: &Scene,
        start: &PathStart,
        at: &Interaction<'_>,
        bsdf: &Bsdf,
        rays: &mut u64,
    ) -> Spectrum {
        let (lights, bsdfs) = (self.emitter_samples, self.bsdf_samples);
        let weighting = if bsdfs > 0 { Weighting::Against { lights, bsdfs } } else { Weighting::Alone };
        let mut sum = Spectrum::ZERO;
        for i in 0..lights {
            let dimension = FIRST_FREE_DIMENSION + 2 * i;
            let numbers = LightNumbers {
                choice: scene.sampler.get_1d(start.key, dimension),
                place: scene.sampler.get_2d(start.key, dimension + 1),
            };
            let wo = -start.ray.direction;
            if let Some(light) = sample_light(scene, at, bsdf, wo, numbers, weighting, start.ray.time) {
                *rays += 1;
                if !scene.occluded(&light.ray) {
                    sum += light.contribution;
                }
            }
        }
        sum / lights.max(1) as f32
    }

    fn by_bsdf(
        &self,
        scene: &Scene,
        start: &PathStart,
        at: &Interaction<'_>,
        bsdf: &Bsdf,
        rays: &mut u64,
    ) -> Spectrum {
        let mut sum = Spectrum::ZERO;
        for i in 0..self.bsdf_samples {
            let dimension = FIRST_FREE_DIMENSION + 2 * (self.emitter_samples + i);
            let lobe = scene.sampler.get_1d(start.key, dimension);
            let direction = scene.sampler.get_2d(start.key, dimension + 1);
            let Some(drawn) = bsdf.sample(-start.ray.direction, lobe, direction, TransportMode::Radiance)
            else {
                continue;
            };
            let weight = |light_pdf: f32| {
                if drawn.flags.delta {
                    return 1.0;
                }
                power_heuristic(
                    self.bsdf_samples as f32 * drawn.pdf_omega,
                    self.emitter_samples as f32 * light_pdf,
                )
            };
            *rays += 1;
            sum += drawn.weight * light_along(scene, at, drawn.wi, start.ray.time, weight);
        }
        sum / self.bsdf_samples.max(1) as f32
    }
}

/// Light that arrives at a surface along `wi` straight from a light.
fn light_along(
    scene: &Scene,
    from: &Interaction<'_>,
    wi: Vector3,
    time: f32,
    weight: impl Fn(f32) -> f32,
) -> Spectrum {
    let ray = from.surface.spawn_ray(wi, time);
    match scene.closest_hit(&ray) {
        None => environment(scene, from.surface.p, wi, weight),
        Some(hit) => {
            let found = scene.interaction(&ray, &hit);
            let emitted = scene.emitted(&found, -wi, Wavelengths::RGB);
            if emitted.is_black() {
                return Spectrum::ZERO;
            }
            emitted * weight(light_pdf(scene, from.surface.p, wi, &found))
        }
    }
}

impl RayIntegrator for Direct {
    fn hides_emitters(&self) -> bool {
        self.hide_emitters
    }

    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum {
        *rays += 1;
        let (ray, wo) = (&start.ray, -start.ray.direction);
        let Some(hit) = scene.closest_hit(ray) else {
            let background = environment(scene, ray.origin, ray.direction, |_| 1.0);
            return if self.hide_emitters { Spectrum::ZERO } else { background };
        };
        let at = scene.interaction(ray, &hit);
        let emitted =
            if self.hide_emitters { Spectrum::ZERO } else { scene.emitted(&at, wo, Wavelengths::RGB) };
        let bsdf = scene.bsdf(&at, wo, Wavelengths::RGB);
        let mut sum = emitted;
        if bsdf.is_smooth() {
            sum += self.by_lights(scene, start, &at, &bsdf, rays);
        }
        sum + self.by_bsdf(scene, start, &at, &bsdf, rays)
    }
}
