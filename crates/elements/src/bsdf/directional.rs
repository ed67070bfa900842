//! How much light rough boundaries pass and reflect by direction, by quadrature over visible normals; and what single
//! scattering loses.

use std::sync::OnceLock;

use aureole_math::{Point2, Vector3, reflect, refract};

use super::fresnel;
use super::microfacet::{Distribution, Microfacet, Shadowing};

/// Points of the quadrature in each dimension.
pub(super) const QUADRATURE: usize = 32;

/// Nodes in [0, 1] and weights that sum to one of Gauss and Legendre's quadrature.
pub(super) fn gauss_legendre() -> [[f32; 2]; QUADRATURE] {
    let n = QUADRATURE as f64;
    std::array::from_fn(|i| {
        // Newton's method from Tricomi's guess; the recurrence gives the polynomial and its derivative.
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut p, mut previous) = (x, 1.0);
            for k in 2..=QUADRATURE {
                let k = k as f64;
                (p, previous) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k, p);
            }
            slope = n * (x * p - previous) / (x * x - 1.0);
            x -= p / slope;
        }
        [(0.5 + 0.5 * x) as f32, (1.0 / ((1.0 - x * x) * slope * slope)) as f32]
    })
}

/// The mean over visible normals of what one facet passes on, for light from `wo`.
fn average(surface: &Microfacet, wo: Vector3, facet: impl Fn(Vector3) -> f32) -> f32 {
    let nodes = gauss_legendre();
    let mut sum = 0.0;
    for [x, weight_x] in nodes {
        for [y, weight_y] in nodes {
            sum += weight_x * weight_y * facet(surface.sample_visible(wo, Point2::new(x, y)));
        }
    }
    sum
}

fn direction(cos: f32) -> Vector3 {
    Vector3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// The share of light from above that gets below the rough boundary.
pub(super) fn transmittance(surface: &Microfacet, cos: f32, eta: f32) -> f32 {
    let wo = direction(cos);
    average(surface, wo, |m| match refract(wo, m, eta) {
        Some(refraction) if refraction.wt.z < 0.0 => {
            let f = fresnel::dielectric(wo.dot(m), eta).reflectance;
            (1.0 - f) * surface.g_given_visible(wo, refraction.wt, m)
        }
        _ => 0.0,
    })
}

/// The share of light that the rough boundary reflects.
pub(super) fn reflectance(surface: &Microfacet, cos: f32, eta: f32) -> f32 {
    let wo = direction(cos);
    average(surface, wo, |m| {
        let wi = reflect(wo, m);
        if wi.z <= 0.0 {
            return 0.0;
        }
        fresnel::dielectric(wo.dot(m), eta).reflectance * surface.g_given_visible(wo, wi, m)
    })
}

/// Entries of an [`AlbedoTable`] in each dimension.
const ENTRIES: usize = 16;

/// The share of light that leaves a rough surface after one scattering, by cosine and roughness.
///
/// What is missing to one met more facets before it left. Dividing by the table gives it back.
///
/// # References
/// [Turquin 2019] "Practical multiple scattering compensation for microfacet models".
#[derive(Clone, Debug)]
pub(super) struct AlbedoTable {
    /// Rows of equal roughness; steps in the root of the cosine.
    values: Box<[[f32; ENTRIES]; ENTRIES]>,
}

impl AlbedoTable {
    /// Tabulates a directional albedo.
    fn new(
        distribution: Distribution,
        shadowing: Shadowing,
        albedo: impl Fn(&Microfacet, f32) -> f32,
    ) -> Self {
        let step = |i: usize| i as f32 / (ENTRIES - 1) as f32;
        let values = std::array::from_fn(|row| {
            let alpha = step(row).max(1e-3);
            let surface = Microfacet::new(distribution, alpha, alpha).with_shadowing(shadowing);
            std::array::from_fn(|i| albedo(&surface, step(i).powi(2).max(1e-4)).clamp(1e-4, 1.0))
        });
        Self { values: Box::new(values) }
    }

    /// The table of a perfectly reflecting surface.
    pub(super) fn mirror(distribution: Distribution, shadowing: Shadowing) -> &'static Self {
        static TABLES: [OnceLock<AlbedoTable>; 4] = [const { OnceLock::new() }; 4];
        let is_correlated = usize::from(shadowing == Shadowing::HeightCorrelated);
        let place = 2 * usize::from(distribution == Distribution::Beckmann) + is_correlated;
        TABLES[place].get_or_init(|| Self::new(distribution, shadowing, mirror_albedo))
    }

    /// The table of a dielectric boundary that light meets from its thinner or thicker side.
    pub(super) fn boundary(distribution: Distribution, shadowing: Shadowing, eta: f32) -> Self {
        Self::new(distribution, shadowing, |surface, cos| {
            reflectance(surface, cos, eta) + transmittance(surface, cos, eta)
        })
    }

    /// The table of what a dielectric boundary reflects of light from above.
    pub(super) fn gloss(eta: f32) -> Self {
        Self::new(Distribution::Ggx, Shadowing::Separable, |surface, cos| reflectance(surface, cos, eta))
    }

    /// The table's value, bilinearly.
    #[inline]
    pub(super) fn at(&self, surface: &Microfacet, cos: f32) -> f32 {
        let alpha = (surface.alpha_u * surface.alpha_v).sqrt();
        let place = |x: f32| {
            let x = x.clamp(0.0, 1.0) * (ENTRIES - 1) as f32;
            let i = (x as usize).min(ENTRIES - 2);
            (i, x - i as f32)
        };
        let ((row, s), (i, t)) = (place(alpha), place(cos.max(0.0).sqrt()));
        let along = |row: &[f32; ENTRIES]| row[i] + (row[i + 1] - row[i]) * t;
        let (a, b) = (along(&self.values[row]), along(&self.values[row + 1]));
        a + (b - a) * s
    }
}

/// What a perfectly reflecting rough surface returns after one scattering.
fn mirror_albedo(surface: &Microfacet, cos: f32) -> f32 {
    let wo = direction(cos);
    average(surface, wo, |m| {
        let wi = reflect(wo, m);
        if wi.z <= 0.0 { 0.0 } else { surface.g_given_visible(wo, wi, m) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_surfaces_lose_nothing_and_rough_ones_much() {
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            let table = AlbedoTable::mirror(distribution, Shadowing::Separable);
            let at = |alpha, cos| table.at(&Microfacet::new(distribution, alpha, alpha), cos);
            assert!(at(0.01, 0.5) > 0.98, "{}", at(0.01, 0.5));
            assert!((0.3..0.8).contains(&at(1.0, 0.5)), "{}", at(1.0, 0.5));
        }
    }

    #[test]
    fn a_boundary_reflects_and_passes_what_it_does_not_lose() {
        let table = AlbedoTable::boundary(Distribution::Ggx, Shadowing::Separable, 1.5);
        assert!(table.at(&Microfacet::new(Distribution::Ggx, 0.05, 0.05), 0.8) > 0.99);
        assert!(table.at(&Microfacet::new(Distribution::Ggx, 1.0, 1.0), 0.8) < 0.97);
    }
}
