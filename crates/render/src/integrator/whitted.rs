//! `whitted`: the tree of primary, shadow, reflected and refracted rays, as on the lecture's slide.
//!
//! Twigs that no longer matter to the pixel are not followed, else the tree between two panes of glass has 2^depth leaves.
//!
//! References: [Whitted 1980] "An Improved Illumination Model for Shaded Display", CACM 23(6); for the twigs [Hall and
//! Greenberg 1983] "A Testbed for Realistic Image Synthesis", IEEE CG&A 3(8).

use aureole_desc::ParamDoc;
use aureole_elements::Bsdf;
use aureole_elements::bsdf::TransportMode;
use aureole_math::{Point2, Ray};
use aureole_scene::{Interaction, Scene};
use aureole_spectrum::{Spectrum, Wavelengths};

use super::lighting::{LightNumbers, Weighting, environment, sample_light};
use super::{FIRST_FREE_DIMENSION, IntegratorManual, OneByOne, PathStart, RayIntegrator};

/// The deepest tree, whatever a scene asks of other integrators by the same parameter.
const DEEPEST: i64 = 64;
/// The smallest share of a pixel that is followed: half a step of an eight-bit image.
const SMALLEST_SHARE: f32 = 0.5 / 255.0;

pub(super) const MANUAL: IntegratorManual = IntegratorManual {
    kind: "whitted",
    summary: "The tree of primary, shadow, reflected and refracted rays.",
    params: &[ParamDoc {
        name: "max_depth",
        ty: "int",
        default: "8",
        doc: "depth of the tree; -1 or more than 64: 64",
    }],
    build: |params| {
        let depth = params.int_in("max_depth", 8, -1, i64::MAX)?;
        let max_depth = if (0..DEEPEST).contains(&depth) { depth } else { DEEPEST } as u32;
        Ok(Box::new(OneByOne(Whitted { max_depth })))
    },
};

struct Whitted {
    max_depth: u32,
}

impl RayIntegrator for Whitted {
    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum {
        Tree { scene, start, max_depth: self.max_depth, rays }.trace(&start.ray, 0, Spectrum::splat(1.0))
    }
}

/// The tree that grows from one camera ray.
struct Tree<'a> {
    scene: &'a Scene,
    start: &'a PathStart,
    max_depth: u32,
    rays: &'a mut u64,
}

impl Tree<'_> {
    /// The slide's `trace(ray)`: nearest hit, direct lighting, reflect, refract, recurse.
    ///
    /// `share` is how much of what comes back reaches the pixel.
    fn trace(&mut self, ray: &Ray, depth: u32, share: Spectrum) -> Spectrum {
        *self.rays += 1;
        let Some(hit) = self.scene.closest_hit(ray) else {
            return environment(self.scene, ray.origin, ray.direction, |_| 1.0);
        };
        let at = self.scene.interaction(ray, &hit);
        let bsdf = self.scene.bsdf(&at, -ray.direction, Wavelengths::RGB);
        let mut color = self.scene.emitted(&at, -ray.direction, Wavelengths::RGB);
        color += self.direct_lighting(ray, &at, &bsdf, depth);
        if depth < self.max_depth {
            color += self.reflect_and_refract(ray, &at, &bsdf, depth, share);
        }
        color
    }

    fn reflect_and_refract(
        &mut self,
        ray: &Ray,
        at: &Interaction<'_>,
        bsdf: &Bsdf,
        depth: u32,
        share: Spectrum,
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
            let weight = drawn.weight * drawn.pdf_omega;
            let next_share = share * weight;
            if next_share.max_element() > SMALLEST_SHARE {
                let next = at.surface.spawn_ray(drawn.wi, ray.time);
                color += weight * self.trace(&next, depth + 1, next_share);
            }
        }
        color
    }

    /// A shadow ray to a light, if the surface is not a pure mirror.
    fn direct_lighting(&mut self, ray: &Ray, at: &Interaction<'_>, bsdf: &Bsdf, depth: u32) -> Spectrum {
        if !bsdf.is_smooth() {
            return Spectrum::ZERO;
        }
        let dimension = FIRST_FREE_DIMENSION + 2 * depth;
        let sampler = &self.scene.sampler;
        let numbers = LightNumbers {
            choice: sampler.get_1d(self.start.key, dimension),
            place: sampler.get_2d(self.start.key, dimension + 1),
        };
        match sample_light(self.scene, at, bsdf, -ray.direction, numbers, Weighting::Alone, ray.time) {
            Some(light) => {
                *self.rays += 1;
                light.contribution * self.scene.visibility(&light.ray, Wavelengths::RGB)
            }
            None => Spectrum::ZERO,
        }
    }
}
