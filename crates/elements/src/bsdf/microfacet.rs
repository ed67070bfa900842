//! Microfacet distributions: GGX and Beckmann, anisotropic, sampled by visible normals.
//!
//! # References
//! - [Walter et al. 2007] "Microfacet Models for Refraction through Rough Surfaces", EGSR.
//! - [Heitz 2018] "Sampling the GGX Distribution of Visible Normals", JCGT 7(4).
//! - [Heitz 2014] "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2): both joint forms.
//! - [Jakob 2014] "An Improved Visible Normal Sampling Routine for the Beckmann Distribution".

use std::f32::consts::PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3, warp};

use crate::{Resolver, Texture, TextureContext, float_texture};

/// The slope distribution of the facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Trowbridge and Reitz: long tails.
    Ggx,
    /// Gaussian slopes.
    Beckmann,
}

/// How likely a facet is seen from both directions at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadowing {
    /// Seen from one or from the other, independently: too dark at grazing angles.
    #[default]
    Separable,
    /// What lies high is likely to be seen from both [Heitz 2014, equation 99].
    HeightCorrelated,
}

/// A rough surface: a distribution and its widths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacet {
    /// The distribution.
    pub distribution: Distribution,
    /// Root mean square slope along local X (times √2 for Beckmann's convention), in (0, 1].
    pub alpha_u: f32,
    /// The same along local Y.
    pub alpha_v: f32,
    /// How shadowing and masking go together.
    pub shadowing: Shadowing,
}

/// The smallest roughness: smoother surfaces would lose their digits.
const MIN_ALPHA: f32 = 1e-4;

impl Microfacet {
    /// A rough surface, with separable shadowing.
    pub fn new(distribution: Distribution, alpha_u: f32, alpha_v: f32) -> Self {
        let [alpha_u, alpha_v] = [alpha_u, alpha_v].map(|alpha| alpha.max(MIN_ALPHA));
        Self { distribution, alpha_u, alpha_v, shadowing: Shadowing::Separable }
    }

    /// The same surface with that shadowing.
    pub fn with_shadowing(self, shadowing: Shadowing) -> Self {
        Self { shadowing, ..self }
    }

    /// The density of facets with unit normal `m`, per steradian and unit area.
    #[inline]
    pub fn d(&self, m: Vector3) -> f32 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let cos2 = m.z * m.z;
        let area = PI * self.alpha_u * self.alpha_v;
        let (x, y) = (m.x / self.alpha_u, m.y / self.alpha_v);
        let slope2 = x * x + y * y;
        let value = match self.distribution {
            Distribution::Ggx => 1.0 / (area * (slope2 + cos2).powi(2)),
            Distribution::Beckmann => (-slope2 / cos2).exp() / (area * cos2 * cos2),
        };
        // Values too small to matter would only become infinite quotients.
        if value * m.z > 1e-20 { value } else { 0.0 }
    }

    /// Smith's shadowing of a direction `v` by facets around `m`.
    #[inline]
    pub fn g1(&self, v: Vector3, m: Vector3) -> f32 {
        if v.dot(m) * v.z <= 0.0 {
            return 0.0;
        }
        let projected2 = (v.x * self.alpha_u).powi(2) + (v.y * self.alpha_v).powi(2);
        let tan2 = projected2 / (v.z * v.z);
        if projected2 == 0.0 {
            return 1.0;
        }
        match self.distribution {
            Distribution::Ggx => 2.0 / (1.0 + (1.0 + tan2).sqrt()),
            Distribution::Beckmann => {
                // The rational fit of [Walter et al. 2007], equation 27.
                let a = 1.0 / tan2.sqrt();
                if a >= 1.6 { 1.0 } else { (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a) }
            }
        }
    }

    /// Shadowing of both directions.
    #[inline]
    pub fn g(&self, wo: Vector3, wi: Vector3, m: Vector3) -> f32 {
        let (a, b) = (self.g1(wo, m), self.g1(wi, m));
        match self.shadowing {
            Shadowing::Separable => a * b,
            // 1 / (1 + Λ(wo) + Λ(wi)), where G1 = 1 / (1 + Λ).
            Shadowing::HeightCorrelated if a * b > 0.0 => a * b / (a + b - a * b),
            Shadowing::HeightCorrelated => 0.0,
        }
    }

    /// The share of light to `wi` that gets past the facets from one around `m` that is seen from `wo`.
    #[inline]
    pub(super) fn g_given_visible(&self, wo: Vector3, wi: Vector3, m: Vector3) -> f32 {
        match self.shadowing {
            Shadowing::Separable => self.g1(wi, m),
            Shadowing::HeightCorrelated => self.g(wo, wi, m) / self.g1(wo, m).max(f32::MIN_POSITIVE),
        }
    }

    /// The density of normals visible from `wo` (with `wo.z > 0`), per steradian of `m`.
    #[inline]
    pub fn pdf_visible(&self, wo: Vector3, m: Vector3) -> f32 {
        self.d(m) * self.g1(wo, m) * wo.abs_dot(m) / wo.z
    }

    /// Density of `wi` per steradian where it mirrors `wo` at a visible normal; both above the surface.
    #[inline]
    pub fn pdf_mirrored(&self, wo: Vector3, wi: Vector3) -> f32 {
        let m = (wo + wi).normalized();
        self.pdf_visible(wo, m) / (4.0 * wo.abs_dot(m))
    }

    /// Draws a normal in proportion to its area visible from `wo` (with `wo.z > 0`).
    #[inline]
    pub fn sample_visible(&self, wo: Vector3, u: Point2) -> Vector3 {
        // Stretched to unit roughness, an anisotropic surface becomes isotropic.
        let stretched = Vector3::new(self.alpha_u * wo.x, self.alpha_v * wo.y, wo.z).normalized();
        let m = match self.distribution {
            Distribution::Ggx => sample_ggx_unit(stretched, u),
            Distribution::Beckmann => sample_beckmann_unit(stretched, u),
        };
        Vector3::new(self.alpha_u * m.x, self.alpha_v * m.y, m.z.max(1e-6)).normalized()
    }
}

/// Visible normals of GGX with unit roughness [Heitz 2018, section 3].
#[inline]
fn sample_ggx_unit(w: Vector3, u: Point2) -> Vector3 {
    let length2 = w.x * w.x + w.y * w.y;
    let t1 = if length2 > 0.0 { Vector3::new(-w.y, w.x, 0.0) / length2.sqrt() } else { Vector3::X };
    let t2 = w.cross(t1);
    let disk = warp::square_to_disk_concentric(u);
    let s = 0.5 * (1.0 + w.z);
    let y = (1.0 - s) * (1.0 - disk.x * disk.x).max(0.0).sqrt() + s * disk.y;
    let z = (1.0 - disk.x * disk.x - y * y).max(0.0).sqrt();
    t1 * disk.x + t2 * y + w * z
}

/// Visible normals of Beckmann with unit roughness, by inverting the distribution of slopes [Jakob 2014].
fn sample_beckmann_unit(w: Vector3, u: Point2) -> Vector3 {
    let sin = (1.0 - w.z * w.z).max(0.0).sqrt();
    let (cos_phi, sin_phi) = if sin > 0.0 { (w.x / sin, w.y / sin) } else { (1.0, 0.0) };
    let [sx, sy] = beckmann_slopes(w.z, u);
    let slope = [cos_phi * sx - sin_phi * sy, sin_phi * sx + cos_phi * sy];
    Vector3::new(-slope[0], -slope[1], 1.0).normalized()
}

/// Slopes along and across the direction of view at polar angle `acos(cos_theta)`.
fn beckmann_slopes(cos_theta: f32, u: Point2) -> [f32; 2] {
    const INV_SQRT_PI: f32 = 0.564_189_6;
    let across = erf_inv(2.0 * u.y.max(1e-6) - 1.0);
    if cos_theta > 0.9999 {
        let r = (-(1.0 - u.x).max(1e-12).ln()).sqrt();
        let (sin, cos) = (2.0 * PI * u.y).sin_cos();
        return [r * cos, r * sin];
    }
    let theta = cos_theta.clamp(-1.0, 1.0).acos();
    let tan = theta.tan();
    let cot = 1.0 / tan;
    // Search on erf(slope), which is the linear scale of the problem, by bisection and Newton steps.
    let mut a = -1.0;
    let mut c = erf(cot);
    let sample_x = u.x.max(1e-6);
    // A fit gives a start near the root.
    let fit = 1.0 + theta * (-0.876 + theta * (0.4265 - 0.0594 * theta));
    let mut b = c - (1.0 + c) * (1.0 - sample_x).powf(fit);
    let normalization = 1.0 / (1.0 + c + INV_SQRT_PI * tan * (-cot * cot).exp());
    for _ in 0..10 {
        if !(b >= a && b <= c) {
            b = 0.5 * (a + c);
        }
        let inv_erf = erf_inv(b);
        let value = normalization * (1.0 + b + INV_SQRT_PI * tan * (-inv_erf * inv_erf).exp()) - sample_x;
        let derivative = normalization * (1.0 - inv_erf * tan);
        if value.abs() < 1e-5 {
            break;
        }
        if value > 0.0 {
            c = b;
        } else {
            a = b;
        }
        b -= value / derivative;
    }
    [erf_inv(b.clamp(-0.999_999, 0.999_999)), across]
}

/// The error function [Abramowitz and Stegun 7.1.26]; absolute error below 1.5e-7.
fn erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let poly =
        t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_7 + t * (-1.453_152 + t * 1.061_405_4))));
    (1.0 - poly * (-x * x).exp()).copysign(x)
}

/// The inverse error function [Giles 2010, "Approximating the erfinv Function"].
fn erf_inv(x: f32) -> f32 {
    let x = x.clamp(-0.999_999, 0.999_999);
    let w = -((1.0 - x) * (1.0 + x)).ln();
    let horner = |w: f32, c: [f32; 9]| c.iter().fold(0.0, |sum, &c| sum * w + c);
    let series = if w < 5.0 {
        horner(
            w - 2.5,
            [
                2.810_226_4e-8,
                3.432_739_4e-7,
                -3.523_387_7e-6,
                -4.391_506_5e-6,
                2.185_808_7e-4,
                -1.253_725e-3,
                -4.177_681_6e-3,
                0.246_640_73,
                1.501_409_4,
            ],
        )
    } else {
        horner(
            w.sqrt() - 3.0,
            [
                -2.002_142_6e-4,
                1.009_505_6e-4,
                1.349_343_2e-3,
                -3.673_428_4e-3,
                5.739_507_7e-3,
                -7.622_461_3e-3,
                9.438_870_5e-3,
                1.001_674,
                2.832_976_8,
            ],
        )
    };
    series * x
}

/// The parameters that rough materials share: a distribution and textures for its widths.
#[derive(Clone, Copy, Debug)]
pub struct Roughness {
    /// The slope distribution.
    pub(super) distribution: Distribution,
    pub(super) shadowing: Shadowing,
    alpha_u: Id<Texture>,
    alpha_v: Id<Texture>,
}

/// Documentation of those parameters.
pub const ROUGHNESS_PARAMS: [ParamDoc; 5] = [
    ParamDoc { name: "distribution", ty: "string", default: "beckmann", doc: "`beckmann` or `ggx`" },
    ParamDoc { name: "alpha", ty: "texture", default: "0.1", doc: "roughness in both directions, in (0, 1]" },
    ParamDoc { name: "alpha_u", ty: "texture", default: "alpha", doc: "roughness along the tangent" },
    ParamDoc { name: "alpha_v", ty: "texture", default: "alpha", doc: "roughness across it" },
    ParamDoc {
        name: "shadowing",
        ty: "string",
        default: "separable",
        doc: "of light and of sight: `separable` or `height_correlated`",
    },
];

/// Documentation of the switch of energy compensation.
pub(super) const COMPENSATION_PARAM: ParamDoc = ParamDoc {
    name: "energy_compensation",
    ty: "bool",
    default: "false",
    doc: "give back what light loses that meets several facets",
};

/// The distribution that the parameters name.
pub(super) fn distribution(params: &mut Params) -> Result<Distribution, SceneError> {
    params.one_of("distribution", &[("beckmann", Distribution::Beckmann), ("ggx", Distribution::Ggx)])
}

impl Roughness {
    /// Reads the shared parameters.
    ///
    /// # Errors
    /// [`SceneError::BadParam`], or whatever is wrong with the textures.
    pub fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let both = float_texture(params, resolver, "alpha", 0.1)?;
        let mut one =
            |name| if params.has(name) { float_texture(params, resolver, name, 0.1) } else { Ok(both) };
        let (alpha_u, alpha_v) = (one("alpha_u")?, one("alpha_v")?);
        let shadowing = params.one_of(
            "shadowing",
            &[("separable", Shadowing::Separable), ("height_correlated", Shadowing::HeightCorrelated)],
        )?;
        Ok(Self { distribution: distribution(params)?, shadowing, alpha_u, alpha_v })
    }

    /// The rough surface at a point.
    #[inline]
    pub fn at(&self, at: &TextureContext<'_>) -> Microfacet {
        Microfacet::new(self.distribution, at.float(self.alpha_u), at.float(self.alpha_v))
            .with_shadowing(self.shadowing)
    }
}

/// Facets of a surface that is smooth where they are too fine to matter: pbrt's interfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finish {
    alpha_u: Id<Texture>,
    alpha_v: Id<Texture>,
}

impl Finish {
    /// Reads the roughness of that name, and those along and across the tangent that end in `_u` and `_v`; 0 by default.
    pub(super) fn from_params(
        params: &mut Params,
        resolver: &mut dyn Resolver,
        name: &str,
    ) -> Result<Self, SceneError> {
        let both = float_texture(params, resolver, name, 0.0)?;
        let mut one = |name: String| {
            if params.has(&name) { float_texture(params, resolver, &name, 0.0) } else { Ok(both) }
        };
        Ok(Self { alpha_u: one(format!("{name}_u"))?, alpha_v: one(format!("{name}_v"))? })
    }

    /// The facets at a point; none where the surface is smooth.
    #[inline]
    pub(super) fn at(&self, at: &TextureContext<'_>) -> Option<Microfacet> {
        let [u, v] = [self.alpha_u, self.alpha_v].map(|alpha| at.float(alpha));
        (u.max(v) >= 1e-3)
            .then(|| Microfacet::new(Distribution::Ggx, u, v).with_shadowing(Shadowing::HeightCorrelated))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::{Pcg32, spherical_direction};

    fn surfaces() -> impl Iterator<Item = Microfacet> {
        [Distribution::Ggx, Distribution::Beckmann]
            .into_iter()
            .flat_map(|d| [(0.1, 0.1), (0.5, 0.5), (0.2, 0.6)].map(|(u, v)| Microfacet::new(d, u, v)))
    }

    #[test]
    fn facets_project_to_unit_area() {
        for surface in surfaces() {
            let (mut sum, n) = (0.0_f64, 400);
            for i in 0..n {
                for j in 0..n {
                    let theta = (i as f32 + 0.5) / n as f32 * PI / 2.0;
                    let phi = (j as f32 + 0.5) / n as f32 * 2.0 * PI;
                    let m = spherical_direction(theta, phi);
                    sum += f64::from(surface.d(m) * m.z * theta.sin());
                }
            }
            let integral = sum * f64::from(PI * PI) / f64::from(n * n);
            assert!((integral - 1.0).abs() < 2e-3, "{surface:?}: {integral}");
        }
    }

    /// Joint shadowing by Smith's function of slopes, of GGX: Λ = (sqrt(1 + (α tan θ)²) - 1) / 2 [Heitz 2014, equation 72].
    #[test]
    fn correlated_shadowing_is_heitzs() {
        let surface = Microfacet::new(Distribution::Ggx, 0.7, 0.7);
        let lambda = |w: Vector3| 0.5 * ((1.0 + (0.7 * w.z.acos().tan()).powi(2)).sqrt() - 1.0);
        for [a, b] in [[0.3_f32, 0.9_f32], [1.3, 1.4], [0.0, 1.5]] {
            let (wo, wi) = (spherical_direction(a, 0.4), spherical_direction(b, 2.0));
            let m = (wo + wi).normalized();
            let separable = surface.g(wo, wi, m);
            let correlated = surface.with_shadowing(Shadowing::HeightCorrelated).g(wo, wi, m);
            let [o, i] = [lambda(wo), lambda(wi)];
            assert!((separable - 1.0 / ((1.0 + o) * (1.0 + i))).abs() < 1e-4, "{a} {b}: {separable}");
            assert!((correlated - 1.0 / (1.0 + o + i)).abs() < 1e-4, "{a} {b}: {correlated}");
        }
    }

    /// E[h(m)] of drawn normals against the integral of h under the stated density, for three functions h.
    #[test]
    fn visible_normals_follow_their_density() {
        for surface in surfaces() {
            for theta_o in [0.1_f32, 0.8, 1.4] {
                let wo = spherical_direction(theta_o, 0.7);
                let tests: [fn(Vector3) -> f32; 3] = [|m| m.x, |m| m.z, |m| m.y * m.y];
                let (mut drawn, mut integral, mut mass) = ([0.0_f64; 3], [0.0_f64; 3], 0.0_f64);
                let mut rng = Pcg32::new(9);
                const DRAWS: usize = 60_000;
                for _ in 0..DRAWS {
                    let m = surface.sample_visible(wo, rng.point2());
                    for (sum, h) in drawn.iter_mut().zip(tests) {
                        *sum += f64::from(h(m)) / DRAWS as f64;
                    }
                }
                let n = 500;
                for i in 0..n {
                    for j in 0..n {
                        let theta = (i as f32 + 0.5) / n as f32 * PI / 2.0;
                        let phi = (j as f32 + 0.5) / n as f32 * 2.0 * PI;
                        let m = spherical_direction(theta, phi);
                        let weight = f64::from(surface.pdf_visible(wo, m) * theta.sin()) * f64::from(PI * PI)
                            / f64::from(n * n);
                        mass += weight;
                        for (sum, h) in integral.iter_mut().zip(tests) {
                            *sum += f64::from(h(m)) * weight;
                        }
                    }
                }
                // Beckmann's shadowing is a fit, so its density integrates to one only within half a percent.
                assert!((mass - 1.0).abs() < 6e-3, "{surface:?} {theta_o}: mass {mass}");
                for (a, b) in drawn.iter().zip(integral) {
                    assert!((a - b).abs() < 0.008, "{surface:?} {theta_o}: {a} {b}");
                }
            }
        }
    }
}
