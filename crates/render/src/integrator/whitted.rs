//! `whitted`: the tree of primary, shadow, reflected and refracted rays, as on the lecture's slide.
//!
//! References: [Whitted 1980] "An Improved Illumination Model for Shaded Display", CACM 23(6).

use aureole_desc::ParamDoc;
use aureole_elements::Bsdf;
use aureole_elements::bsdf::TransportMode;
use aureole_math::{Point2, Ray};
use aureole_scene::{Interaction, Scene};
use aureole_spectrum::{Spectrum, Wavelengths};

use super::lighting::{LightNumbers, Weighting, environment, sample_light};
use super::{FIRST_FREE_DIMENSION, IntegratorManual, OneByOne, PathStart, RayIntegrator};

pub(super) const MANUAL: IntegratorManual = IntegratorManual {
    kind: "whitted",
    summary: "The tree of primary, shadow, reflected and refracted rays.",
    params: &[ParamDoc { name: "max_depth", ty: "int", default: "8", doc: "depth of the tree" }],
    build: |params| {
        let max_depth = params.int_in("max_depth", 8, -1, 64)?;
        Ok(Box::new(OneByOne(Whitted { max_depth: if max_depth < 0 { 64 } else { max_depth as u32 } })))
    },
};

struct Whitted {
    max_depth: u32,
}

impl Whitted {
    /// The slide's `trace(ray)`: nearest hit, direct lighting, reflect, refract, recurse.
    fn trace(&self, scene: &Scene, ray: &Ray, start: &PathStart, depth: u32, rays: &mut u64) -> Spectrum {
        *rays += 1;
        let Some(hit) = scene.closest_hit(ray) else {
            return environment(scene, ray.origin, ray.direction, |_| 1.0);
        };
        let at = scene.interaction(ray, &hit);
        let bsdf = scene.bsdf(&at, -ray.direction, Wavelengths::RGB);
        let mut color = scene.emitted(&at, -ray.direction, Wavelengths::RGB);
        color += direct_lighting(scene, ray, start, &at, &bsdf, depth, rays);
        if depth < self.max_depth {
            color += self.reflect_and_refract(scene, ray, start, &at, &bsdf, depth, rays);
        }
        color
    }

    #[expect(clippy::too_many_arguments, reason = "the slide's variables")]
    fn reflect_and_refract(
        &self,
        scene: &Scene,
        ray: &Ray,
        start: &PathStart,
        at: &Interaction<'_>,
        bsdf: &Bsdf,
        depth: u32,
        rays: &mut u64,
    ) -> Spectrum {
        let mut color = Spectrum::ZERO;
        let mut reflected = None;
        // The two ends of the unit interval draw the mirror direction and the refracted one.
        for end in [0.0, 1.0 - f32::EPSILON] {
            let drawn = bsdf.sample(-ray.direction, end, Point2::new(0.5, 0.5), TransportMode::Radiance);
            let Some(drawn) = drawn.filter(|drawn| drawn.flags.delta) else { continue };
            if reflected == Some(drawn.flags.transmission) {
                continue; // the same ray again: there is only one
            }
            reflected = Some(drawn.flags.transmission);
            // Both rays are followed, so each counts with its share, not with one over its probability.
            let share = drawn.weight * drawn.pdf_omega;
            let next = at.surface.spawn_ray(drawn.wi, ray.time);
            color += share * self.trace(scene, &next, start, depth + 1, rays);
        }
        color
    }
}

/// A shadow ray to a light, if the surface is not a pure mirror.
fn direct_lighting(
    scene: &Scene,
    ray: &Ray,
    start: &PathStart,
    at: &Interaction<'_>,
    bsdf: &Bsdf,
    depth: u32,
    rays: &mut u64,
) -> Spectrum {
    if !bsdf.is_smooth() {
        return Spectrum::ZERO;
    }
    let dimension = FIRST_FREE_DIMENSION + 2 * depth;
    let numbers = LightNumbers {
        choice: scene.sampler.get_1d(start.key, dimension),
        place: scene.sampler.get_2d(start.key, dimension + 1),
    };
    match sample_light(scene, at, bsdf, -ray.direction, numbers, Weighting::Alone, ray.time) {
        Some(light) => {
            *rays += 1;
            if scene.occluded(&light.ray) { Spectrum::ZERO } else { light.contribution }
        }
        None => Spectrum::ZERO,
    }
}

impl RayIntegrator for Whitted {
    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum {
        self.trace(scene, &start.ray, start, 0, rays)
    }
}
