//! Scattering by a fibre of hair. References: see [`hair`](super::hair).

use std::f32::consts::{FRAC_1_PI, LN_2, PI};

use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::{LobeFlags, LobeOps, LobeSample, TransportMode, fresnel};

/// Paths with more passages than this are taken together.
const P_MAX: usize = 3;

/// A fibre where a ray meets it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fibre {
    /// The angle around the fibre between the viewer and where the ray meets it; its sine is the offset across the fibre.
    pub gamma: f32,
    /// Index of refraction.
    pub eta: f32,
    /// Absorption per radius.
    pub sigma_a: Spectrum,
    /// Roughness along the fibre.
    pub beta_m: f32,
    /// Roughness around it.
    pub beta_n: f32,
    /// Tilt of the scales in radians.
    pub alpha: f32,
}

/// A fibre's scattering; local X runs along the fibre.
#[derive(Clone, Copy, Debug)]
pub struct HairLobe {
    gamma: f32,
    /// Sine of that: the offset across the fibre.
    h: f32,
    eta: f32,
    sigma_a: Spectrum,
    /// Longitudinal variance of each lobe.
    v: [f32; P_MAX + 1],
    /// Azimuthal logistic scale.
    s: f32,
    /// Sine and cosine of the tilt that each lobe has from the scales.
    tilt: [[f32; 2]; P_MAX],
}

/// A direction in the fibre's angles.
#[derive(Clone, Copy)]
struct Angles {
    sin_theta: f32,
    cos_theta: f32,
    phi: f32,
}

impl Angles {
    #[inline]
    fn of(w: Vector3) -> Self {
        Self { sin_theta: w.x, cos_theta: (1.0 - w.x * w.x).max(1e-12).sqrt(), phi: w.z.atan2(w.y) }
    }
}

/// What only depends on the viewer.
struct View {
    wo: Angles,
    gamma_o: f32,
    gamma_t: f32,
    /// Attenuation of each lobe.
    ap: [Spectrum; P_MAX + 1],
    /// Probability of each lobe.
    probability: [f32; P_MAX + 1],
}

/// ln I₀(x), the modified Bessel function.
fn ln_bessel_i0(x: f32) -> f32 {
    if x > 12.0 {
        return x - 0.5 * (2.0 * PI * x).ln() + (1.0 + 0.5 / x) / (8.0 * x);
    }
    // The power series; twenty terms suffice below 12.
    let (mut sum, mut term, quarter) = (1.0_f32, 1.0_f32, 0.25 * x * x);
    for i in 1..20 {
        term *= quarter / (i * i) as f32;
        sum += term;
    }
    sum.ln()
}

/// Longitudinal scattering, normalised over the sphere but for the azimuth [d'Eon et al. 2011, equation 7].
fn longitudinal(wi: &Angles, sin_o: f32, cos_o: f32, v: f32) -> f32 {
    let a = wi.cos_theta * cos_o / v;
    let b = wi.sin_theta * sin_o / v;
    if v <= 0.1 {
        (ln_bessel_i0(a) - b - 1.0 / v + LN_2 + (0.5 / v).ln()).exp()
    } else {
        (ln_bessel_i0(a) - b).exp() / ((1.0 / v).sinh() * 2.0 * v)
    }
}

fn logistic_cdf(x: f32, s: f32) -> f32 {
    1.0 / (1.0 + (-x / s).exp())
}

/// The logistic distribution on [-π, π].
fn trimmed_logistic(x: f32, s: f32) -> f32 {
    let e = (-x.abs() / s).exp();
    e / (s * (1.0 + e) * (1.0 + e)) / (logistic_cdf(PI, s) - logistic_cdf(-PI, s))
}

fn sample_trimmed_logistic(u: f32, s: f32) -> f32 {
    let (low, high) = (logistic_cdf(-PI, s), logistic_cdf(PI, s));
    let cdf = (low + u * (high - low)).clamp(1e-7, 1.0 - 1e-7);
    (-s * (1.0 / cdf - 1.0).ln()).clamp(-PI, PI)
}

/// An angle in [-π, π].
fn wrapped(phi: f32) -> f32 {
    phi - 2.0 * PI * (phi / (2.0 * PI)).round()
}

impl HairLobe {
    pub(super) fn new(fibre: &Fibre) -> Self {
        let (m, n) = (fibre.beta_m, fibre.beta_n);
        // Fits of the logistic and the longitudinal widths to perceived roughness [Chiang et al. 2016, equations 7, 8].
        let v0 = (0.726 * m + 0.812 * m * m + 3.7 * m.powi(20)).powi(2);
        let s = (PI / 8.0).sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22));
        let tilt = [-2.0, 1.0, 4.0].map(|k: f32| {
            let (sin, cos) = (k * fibre.alpha).sin_cos();
            [sin, cos]
        });
        let (gamma, h) = (fibre.gamma, fibre.gamma.sin());
        let (eta, sigma_a) = (fibre.eta, fibre.sigma_a);
        Self { gamma, h, eta, sigma_a, v: [v0, 0.25 * v0, 4.0 * v0, 4.0 * v0], s, tilt }
    }

    fn view(&self, wo: Vector3) -> View {
        let wo = Angles::of(wo);
        let sin_theta_t = wo.sin_theta / self.eta;
        let cos_theta_t = (1.0 - sin_theta_t * sin_theta_t).max(0.0).sqrt();
        // The index that the cross section seems to have [Marschner et al. 2003].
        let eta_p = (self.eta * self.eta - wo.sin_theta * wo.sin_theta).max(0.0).sqrt() / wo.cos_theta;
        let sin_gamma_t = (self.h / eta_p).clamp(-1.0, 1.0);
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let transmittance = (-self.sigma_a * (2.0 * cos_gamma_t / cos_theta_t)).exp();
        let ap = self.attenuation(wo.cos_theta, transmittance);
        let total: f32 = ap.iter().map(|a| a.average()).sum();
        let probability = ap.map(|a| a.average() / total);
        View { wo, gamma_o: self.gamma, gamma_t: sin_gamma_t.asin(), ap, probability }
    }

    /// How much light takes each path.
    fn attenuation(&self, cos_theta_o: f32, t: Spectrum) -> [Spectrum; P_MAX + 1] {
        let cos_gamma_o = (1.0 - self.h * self.h).max(0.0).sqrt();
        let f = fresnel::dielectric(cos_theta_o * cos_gamma_o, self.eta).reflectance;
        let first = t * ((1.0 - f) * (1.0 - f));
        let second = first * t * f;
        let rest = second * t * f / (Spectrum::ONE - t * f).map(|x| x.max(1e-6));
        [Spectrum::splat(f), first, second, rest]
    }

    /// The viewer's sine and cosine of theta, turned by the tilt that the scales give a lobe.
    #[inline]
    fn tilted(&self, wo: &Angles, p: usize) -> [f32; 2] {
        match self.tilt.get(p) {
            Some([sin, cos]) => {
                [wo.sin_theta * cos + wo.cos_theta * sin, wo.cos_theta * cos - wo.sin_theta * sin]
            }
            None => [wo.sin_theta, wo.cos_theta],
        }
    }

    /// The azimuth that a lobe would turn light by, were the fibre smooth.
    #[inline]
    fn turn(view: &View, p: usize) -> f32 {
        let p = p as f32;
        2.0 * p * view.gamma_t - 2.0 * view.gamma_o + p * PI
    }

    /// The value times cosine of each lobe without its attenuation, which is also its density.
    #[inline]
    fn lobes(&self, view: &View, wi: Vector3) -> [f32; P_MAX + 1] {
        let wi = Angles::of(wi);
        let dphi = wi.phi - view.wo.phi;
        std::array::from_fn(|p| {
            let [sin_o, cos_o] = self.tilted(&view.wo, p);
            let around = if p < P_MAX {
                trimmed_logistic(wrapped(dphi - Self::turn(view, p)), self.s)
            } else {
                0.5 * FRAC_1_PI
            };
            longitudinal(&wi, sin_o, cos_o.abs(), self.v[p]) * around
        })
    }
}

impl LobeOps for HairLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        let view = self.view(wo);
        let lobes = self.lobes(&view, wi);
        let sum: Spectrum = view.ap.iter().zip(lobes).map(|(a, lobe)| *a * lobe).sum();
        // A fibre has no surface whose cosine would count.
        sum / wi.z.abs().max(1e-7)
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        let view = self.view(wo);
        let (mut p, mut uc) = (0, uc);
        while p < P_MAX && uc >= view.probability[p] {
            uc -= view.probability[p];
            p += 1;
        }
        uc = (uc / view.probability[p]).clamp(0.0, 1.0 - f32::EPSILON);
        // Longitudinally [d'Eon et al. 2013, "A Fiber Scattering Model with Non-Separable Lobes"].
        let ([sin_o, cos_o], v) = (self.tilted(&view.wo, p), self.v[p]);
        let cos = (1.0 + v * (u.x.max(1e-6) + (1.0 - u.x) * (-2.0 / v).exp()).ln()).max(-1.0);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let sin_i = (-cos * sin_o + sin * (2.0 * PI * u.y).cos() * cos_o).clamp(-1.0, 1.0);
        let cos_i = (1.0 - sin_i * sin_i).sqrt();
        // Azimuthally.
        let dphi = if p < P_MAX {
            Self::turn(&view, p) + sample_trimmed_logistic(uc, self.s)
        } else {
            2.0 * PI * uc
        };
        let (sin_phi, cos_phi) = (view.wo.phi + dphi).sin_cos();
        let wi = Vector3::new(sin_i, cos_i * cos_phi, cos_i * sin_phi);
        let pdf_omega = self.pdf_omega(wo, wi);
        let flags = if wi.z * wo.z >= 0.0 { LobeFlags::REFLECTION } else { LobeFlags::TRANSMISSION };
        (pdf_omega > 0.0).then(|| LobeSample {
            wi,
            value: self.eval(wo, wi, mode),
            pdf_omega,
            flags,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        let view = self.view(wo);
        self.lobes(&view, wi).iter().zip(view.probability).map(|(lobe, p)| lobe * p).sum()
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.view(wo).ap.into_iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bessel_function_is_right_on_both_sides_of_its_seam() {
        assert!((ln_bessel_i0(1.0) - 0.235_914_4).abs() < 1e-5);
        assert!((ln_bessel_i0(11.99) - 9.839_929).abs() < 1e-4);
        assert!((ln_bessel_i0(12.01) - 9.859_076).abs() < 1e-4);
    }

    #[test]
    fn drawn_logistics_follow_their_density() {
        let (s, n) = (0.4, 4000);
        let sum: f32 = (0..n)
            .map(|i| trimmed_logistic(-PI + 2.0 * PI * (i as f32 + 0.5) / n as f32, s) * 2.0 * PI / n as f32)
            .sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        assert!(sample_trimmed_logistic(0.5, s).abs() < 1e-5);
    }

    /// Values times cosine (red) of Mitsuba 3.9's `hair`, whose fibre runs along local Y.
    #[test]
    fn values_are_those_of_mitsuba() {
        let turned = |v: [f32; 3]| Vector3::new(v[1], -v[0], v[2]).normalized();
        let pairs = [
            [[0.3, -0.5, 0.8], [-0.2, 0.6, 0.5]],
            [[0.9, 0.2, 0.15], [-0.7, 0.1, 0.6]],
            [[0.5, 0.1, 0.6], [-0.6, -0.3, -0.9]],
        ];
        let brown = Spectrum::from_rgb([0.419 * 1.3 + 0.187 * 0.2; 3]);
        let red = Spectrum::from_rgb([0.187 * 0.5; 3]);
        let fibres = [
            (brown, 0.3, 0.3, 2.0_f32, [0.14271, 0.033042, 0.13087]),
            (red, 0.2, 0.5, 4.0, [0.093249, 0.22236, 1.2764]),
        ];
        for (sigma_a, beta_m, beta_n, alpha, expected) in fibres {
            for (pair, expected) in pairs.iter().zip(expected) {
                let [wo, wi] = pair.map(turned);
                let gamma = (-wo.y).atan2(wo.z);
                let (eta, alpha) = (1.55 / 1.000_277, alpha.to_radians());
                let lobe = HairLobe::new(&Fibre { gamma, eta, sigma_a, beta_m, beta_n, alpha });
                let found = (lobe.eval(wo, wi, TransportMode::Radiance) * wi.z.abs())[0];
                assert!((found - expected).abs() < 0.01 * expected, "{found}, not {expected}");
            }
        }
    }
}
