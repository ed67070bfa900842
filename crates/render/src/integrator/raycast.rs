//! `raycast`: the first surface, lit from the eye: what early ray casting showed.

use aureole_scene::Scene;
use aureole_spectrum::{Spectrum, Wavelengths};

use super::{IntegratorManual, OneByOne, PathStart, RayIntegrator};

pub(super) const MANUAL: IntegratorManual = IntegratorManual {
    kind: "raycast",
    summary: "The first surface, lit from the eye.",
    params: &[],
    build: |_| Ok(Box::new(OneByOne(Raycast))),
};

struct Raycast;

impl RayIntegrator for Raycast {
    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum {
        *rays += 1;
        let Some(hit) = scene.closest_hit(&start.ray) else { return Spectrum::ZERO };
        let at = scene.interaction(&start.ray, &hit);
        let wo = -start.ray.direction;
        scene.bsdf(&at, wo, Wavelengths::RGB).albedo(wo) * at.surface.frame.n.abs_dot(wo)
    }
}
