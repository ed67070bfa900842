//! Terms that the principled materials share.
//!
//! # References
//! - [Burley 2012] "Physically Based Shading at Disney", SIGGRAPH course notes.
//! - [Burley 2015] "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", SIGGRAPH course notes.
//!
//! Where the notes leave a choice, it is Mitsuba 3's.

use std::f32::consts::{FRAC_1_PI, PI};

use aureole_math::{Point2, Vector3};
use aureole_spectrum::{Spectrum, luminance};

use super::microfacet::{Distribution, Microfacet};

/// Schlick's weight: (1 - cos θ)⁵.
#[inline]
pub(super) fn schlick_weight(cos: f32) -> f32 {
    (1.0 - cos).clamp(0.0, 1.0).powi(5)
}

/// Schlick's approximation of Fresnel reflectance, seen from either side of a boundary of relative index `eta`.
#[inline]
pub(super) fn schlick(r0: Spectrum, cos_i: f32, eta: f32) -> Spectrum {
    let eta_path = if cos_i >= 0.0 { eta } else { 1.0 / eta };
    // The weight belongs to the angle on the thinner side.
    let cos = if eta_path > 1.0 {
        cos_i.abs()
    } else {
        (1.0 - (1.0 - cos_i * cos_i) / (eta_path * eta_path)).max(0.0).sqrt()
    };
    r0.lerp(Spectrum::ONE, schlick_weight(cos))
}

/// Reflectance at normal incidence.
#[inline]
pub(super) fn normal_reflectance(eta: f32) -> f32 {
    ((eta - 1.0) / (eta + 1.0)).powi(2)
}

/// The hue and saturation of a colour: the colour at luminance one.
#[inline]
pub(super) fn hue(color: Spectrum) -> Spectrum {
    let y = luminance(color.rgb());
    if y > 0.0 { color / y } else { Spectrum::ONE }
}

/// Facets by roughness and anisotropy, both in [0, 1] [Burley 2012, section 5.4].
#[inline]
pub(super) fn facets(roughness: f32, anisotropic: f32) -> Microfacet {
    let (alpha, aspect) = (roughness * roughness, (1.0 - 0.9 * anisotropic).max(0.0).sqrt());
    Microfacet::new(Distribution::Ggx, (alpha / aspect).max(1e-3), (alpha * aspect).max(1e-3))
}

/// The matte part: diffuse with retro-reflection, flattened as if light scattered below the surface, and sheen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matte {
    pub color: Spectrum,
    pub roughness: f32,
    pub flatness: f32,
    pub sheen: f32,
    pub sheen_tint: f32,
}

impl Matte {
    /// The diffuse part, without cosine; `cos_d`: between the half vector and either direction.
    #[inline]
    pub(super) fn diffuse(&self, cos_o: f32, cos_i: f32, cos_d: f32) -> Spectrum {
        let (fo, fi) = (schlick_weight(cos_o), schlick_weight(cos_i));
        let rr = 2.0 * self.roughness * cos_d * cos_d;
        let base = (1.0 - 0.5 * fo) * (1.0 - 0.5 * fi);
        let retro = rr * (fo + fi + fo * fi * (rr - 1.0));
        let mut value = base + retro;
        if self.flatness > 0.0 {
            // Hanrahan and Krueger's subsurface scattering, approximately [Burley 2012, section 5.3].
            let towards = |f: f32| 1.0 + (0.5 * rr - 1.0) * f;
            let scatter = towards(fo) * towards(fi);
            let subsurface = 1.25 * (scatter * (1.0 / (cos_o + cos_i) - 0.5) + 0.5);
            value += (subsurface - value) * self.flatness;
        }
        self.color * (FRAC_1_PI * value)
    }

    /// The sheen, without cosine.
    #[inline]
    pub(super) fn sheen(&self, cos_d: f32) -> Spectrum {
        if self.sheen <= 0.0 {
            return Spectrum::ZERO;
        }
        let tint = Spectrum::ONE.lerp(hue(self.color), self.sheen_tint);
        tint * (self.sheen * schlick_weight(cos_d.abs()))
    }
}

/// Generalised Trowbridge-Reitz with exponent one: the clearcoat's long tails [Burley 2012, appendix B].
#[derive(Clone, Copy, Debug)]
pub(super) struct Gtr1 {
    alpha: f32,
}

impl Gtr1 {
    /// The clearcoat's facets by gloss in [0, 1].
    #[inline]
    pub(super) fn of_gloss(gloss: f32) -> Self {
        Self { alpha: 0.1 + (0.001 - 0.1) * gloss }
    }

    /// The density of facets with normal `m`.
    #[inline]
    pub(super) fn d(&self, m: Vector3) -> f32 {
        let alpha2 = self.alpha * self.alpha;
        let value = (alpha2 - 1.0) / (PI * alpha2.ln() * (1.0 + (alpha2 - 1.0) * m.z * m.z));
        if value * m.z > 1e-20 { value } else { 0.0 }
    }

    /// The density of [`sample`](Self::sample).
    #[inline]
    pub(super) fn pdf(&self, m: Vector3) -> f32 {
        self.d(m) * m.z.max(0.0)
    }

    /// Draws a normal in proportion to its projected density.
    #[inline]
    pub(super) fn sample(&self, u: Point2) -> Vector3 {
        let alpha2 = self.alpha * self.alpha;
        let cos2 = ((1.0 - alpha2.powf(1.0 - u.y)) / (1.0 - alpha2)).clamp(0.0, 1.0);
        let sin = (1.0 - cos2).sqrt();
        let (sin_phi, cos_phi) = (2.0 * PI * u.x).sin_cos();
        Vector3::new(cos_phi * sin, sin_phi * sin, cos2.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schlick_is_one_at_grazing_and_r0_at_normal_incidence() {
        let r0 = Spectrum::splat(0.04);
        assert!((schlick(r0, 1.0, 1.5)[0] - 0.04).abs() < 1e-6);
        assert!((schlick(r0, 0.0, 1.5)[0] - 1.0).abs() < 1e-6);
        // Total reflection from inside.
        assert!((schlick(r0, -0.3, 1.5)[0] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn clearcoat_facets_project_to_unit_area() {
        let gtr1 = Gtr1::of_gloss(0.2);
        let n = 200_000;
        let sum: f64 = (0..n)
            .map(|i| {
                // Even steps in ln(1 - z²) resolve the peak.
                let cos2 = 1.0 - (f64::from(i) + 0.5) / f64::from(n);
                let m = Vector3::new((1.0 - cos2).sqrt() as f32, 0.0, cos2.sqrt() as f32);
                f64::from(gtr1.d(m)) * std::f64::consts::PI / f64::from(n)
            })
            .sum();
        assert!((sum - 1.0).abs() < 2e-3, "{sum}");
    }
}
