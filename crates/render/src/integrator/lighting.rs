//! What integrators share: light samples, and weights for several ways of finding the same light.

use aureole_elements::bsdf::TransportMode;
use aureole_elements::{Bsdf, Light};
use aureole_math::{Id, Point2, Point3, Ray, Vector3};
use aureole_scene::{Interaction, Scene};
use aureole_spectrum::{Spectrum, Wavelengths};

use crate::replay::Event;

/// The power heuristic with exponent two [Veach 1997, section 9.2.4].
#[inline]
pub(super) fn power_heuristic(pdf: f32, other: f32) -> f32 {
    let (a, b) = (pdf * pdf, other * other);
    if a.is_infinite() {
        return 1.0;
    }
    if a > 0.0 { a / (a + b) } else { 0.0 }
}

/// Light that may arrive from a drawn light.
pub(super) struct DirectLight {
    /// Its contribution if nothing is in between: value · cosine · radiance · weight / density.
    pub contribution: Spectrum,
    /// The ray that must be free.
    pub ray: Ray,
    /// Which light, and the density of its direction: for those who watch.
    light: Id<Light>,
    pdf_omega: f32,
}

impl DirectLight {
    /// What to tell of it, given what it adds to the whole sample.
    pub(super) fn event(&self, contribution: Spectrum) -> Event {
        let light = self.light.index() as u32;
        Event::Light { light, wi: self.ray.direction.normalized(), pdf_omega: self.pdf_omega, contribution }
    }
}

/// Numbers that choose a light and a point on it.
#[derive(Clone, Copy)]
pub(super) struct LightNumbers {
    pub choice: f32,
    pub place: Point2,
}

/// How the contributions of light samples are weighted against those of BSDF samples.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Weighting {
    /// Only light samples are drawn.
    Alone,
    /// So many light samples and so many BSDF samples.
    Against { lights: u32, bsdfs: u32 },
}

/// Draws a light, and what it would add at a surface.
#[inline]
pub(super) fn sample_light(
    scene: &Scene,
    at: &Interaction<'_>,
    bsdf: &Bsdf,
    wo: Vector3,
    numbers: LightNumbers,
    weighting: Weighting,
    time: f32,
) -> Option<DirectLight> {
    let choice = scene.picker.pick(numbers.choice)?;
    let lights = scene.light_context(Wavelengths::RGB);
    let sample = scene.lights[choice.light].sample(&lights, at.surface.p, numbers.place)?;
    let value = bsdf.eval_cos(wo, sample.wi, TransportMode::Radiance);
    if value.is_black() {
        return None;
    }
    let pdf = sample.pdf_omega * choice.pmf;
    let weight = match weighting {
        Weighting::Against { lights, bsdfs } if !sample.is_delta => {
            power_heuristic(lights as f32 * pdf, bsdfs as f32 * bsdf.pdf_omega(wo, sample.wi))
        }
        _ => 1.0,
    };
    let contribution = value * sample.radiance * (weight / pdf);
    let ray = scene.shadow_ray(&at.surface, &sample, time);
    Some(DirectLight { contribution, ray, light: choice.light, pdf_omega: pdf })
}

/// The density with which [`sample_light`] would have found the light that a ray from `reference` met.
#[inline]
pub(super) fn light_pdf(scene: &Scene, reference: Point3, wi: Vector3, found: &Interaction<'_>) -> f32 {
    let Some(light) = found.light else { return 0.0 };
    let context = scene.light_context(Wavelengths::RGB);
    scene.picker.pmf(light) * scene.lights[light].pdf_omega(&context, reference, wi, Some(&found.surface))
}

/// Radiance from the surroundings along `wi`; `weight` is asked with the density of each light.
#[inline]
pub(super) fn environment(
    scene: &Scene,
    reference: Point3,
    wi: Vector3,
    weight: impl Fn(f32) -> f32,
) -> Spectrum {
    let context = scene.light_context(Wavelengths::RGB);
    let mut sum = Spectrum::ZERO;
    for &id in scene.environments() {
        let light = &scene.lights[id];
        let radiance = light.environment(&context, reference, wi);
        if !radiance.is_black() {
            sum += radiance * weight(scene.picker.pmf(id) * light.pdf_omega(&context, reference, wi, None));
        }
    }
    sum
}
