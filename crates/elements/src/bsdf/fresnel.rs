//! Fresnel's equations, averaged over polarisations.

use aureole_spectrum::Spectrum;

/// What a smooth dielectric boundary does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricFresnel {
    /// Reflectance.
    pub reflectance: f32,
    /// Signed cosine of the refracted direction: of sign opposite to the incident one. Zero under total reflection.
    pub cos_t: f32,
    /// Relative index along the path: transmitted side over incident side.
    pub eta_path: f32,
}

/// Fresnel reflectance at the boundary of two dielectrics.
///
/// `eta`: index below the surface over index above; `cos_i`: of the incident direction, negative from below.
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> DielectricFresnel {
    let eta_path = if cos_i >= 0.0 { eta } else { 1.0 / eta };
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta_path * eta_path);
    if sin2_t >= 1.0 {
        return DielectricFresnel { reflectance: 1.0, cos_t: 0.0, eta_path };
    }
    let (cos_i_abs, cos_t_abs) = (cos_i.abs(), (1.0 - sin2_t).sqrt());
    let parallel = (eta_path * cos_i_abs - cos_t_abs) / (eta_path * cos_i_abs + cos_t_abs);
    let perpendicular = (cos_i_abs - eta_path * cos_t_abs) / (cos_i_abs + eta_path * cos_t_abs);
    let reflectance = 0.5 * (parallel * parallel + perpendicular * perpendicular);
    DielectricFresnel { reflectance, cos_t: -cos_t_abs.copysign(cos_i), eta_path }
}

/// Fresnel reflectance of a conductor with complex index `eta + i k`, seen from vacuum.
///
/// # References
/// [Lazanyi and Szirmay-Kalos 2005]; the form with a² + b² after [Born and Wolf], as in [Pharr 2016] section 8.2.1.
#[inline]
pub fn conductor(cos_i: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    let cos2 = cos_i * cos_i;
    let sin2 = 1.0 - cos2;
    let (eta2, k2) = (eta * eta, k * k);
    let t0 = eta2 - k2 - sin2;
    let a2_b2 = (t0 * t0 + eta2 * k2 * 4.0).max_zero().sqrt();
    let t1 = a2_b2 + cos2;
    let a = ((a2_b2 + t0) * 0.5).max_zero().sqrt();
    let t2 = a * (2.0 * cos_i);
    let perpendicular = (t1 - t2) / (t1 + t2);
    let t3 = a2_b2 * cos2 + sin2 * sin2;
    let t4 = t2 * sin2;
    let parallel = perpendicular * (t3 - t4) / (t3 + t4);
    (perpendicular + parallel) * 0.5
}

/// Reflectance of a metal from that at normal incidence, `f0`, and a factor `edge` on Schlick's curve at 82°.
///
/// # References
/// [Kutz, Hašan and Edmondson 2021] "Novel aspects of the Adobe Standard Material": the F82-tint model.
#[inline]
pub fn tinted(cos_i: f32, f0: Spectrum, edge: Spectrum) -> Spectrum {
    /// The cosine of about 82°, where the correction is strongest.
    const PEAK: f32 = 1.0 / 7.0;
    let schlick = |cos: f32| f0 + (Spectrum::ONE - f0) * (1.0 - cos).clamp(0.0, 1.0).powi(5);
    let strength = schlick(PEAK) * (Spectrum::ONE - edge) * (1.0 / (PEAK * (1.0 - PEAK).powi(6)));
    let cos = cos_i.abs().min(1.0);
    (schlick(cos) - strength * (cos * (1.0 - cos).powi(6))).clamp(0.0, 1.0)
}

/// The mean reflectance of a dielectric boundary under uniform diffuse light from its outer side.
///
/// # References
/// Polynomial fits: [d'Eon and Irving 2011] "A Quantized-Diffusion Model for Rendering Translucent Materials" for eta > 1;
/// [Egan and Hilgeman 1973] for eta < 1. Within about one percent of the integral.
pub fn diffuse_reflectance(eta: f32) -> f32 {
    if eta < 1.0 {
        -1.4399 * eta * eta + 0.7099 * eta + 0.6681 + 0.0636 / eta
    } else {
        let x = 1.0 / eta;
        let high = -7.80989 + x * (4.98554 - 1.36881 * x);
        0.919317 + x * (-3.4793 + x * (6.75335 + x * high))
    }
}

/// The mean reflectance of a dielectric boundary under uniform diffuse light from its outer side, exactly.
///
/// # References
/// [Duntley 1942] "The Optical Properties of Diffusing Materials", Walsh's formula; from the denser side by what
/// reciprocity asks of fluxes: (1 - R_inside) · eta² = 1 - R_outside.
pub fn mean_reflectance(eta: f32) -> f32 {
    let n = f64::from(eta.max(1.0 / eta));
    // Next to one the formula is a difference of large numbers, and the reflectance below 2e-5.
    if n < 1.002 {
        return 0.0;
    }
    let (n2, n3) = (n * n, n * n * n);
    let n4 = n2 * n2;
    let outside = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n3 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
    if eta >= 1.0 { outside as f32 } else { (1.0 - (1.0 - outside) / n2) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_at_normal_incidence_reflects_four_percent() {
        assert!((dielectric(1.0, 1.5).reflectance - 0.04).abs() < 1e-6);
        assert!((dielectric(-1.0, 1.5).reflectance - 0.04).abs() < 1e-6);
        assert_eq!(dielectric(-0.2, 1.5).reflectance, 1.0);
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for i in 1..=10 {
            let cos = i as f32 / 10.0;
            let metal = conductor(cos, Spectrum::splat(1.5), Spectrum::ZERO);
            assert!((metal[0] - dielectric(cos, 1.5).reflectance).abs() < 1e-5);
        }
    }

    #[test]
    fn a_tinted_metal_has_its_colours_where_they_are_asked_for() {
        let (f0, edge) = (Spectrum::splat(0.7), Spectrum::splat(0.5));
        assert!((tinted(1.0, f0, edge)[0] - 0.7).abs() < 1e-6);
        let plain = tinted(1.0 / 7.0, f0, Spectrum::ONE)[0];
        assert!((tinted(1.0 / 7.0, f0, edge)[0] - 0.5 * plain).abs() < 1e-6);
        assert!((tinted(0.0, f0, edge)[0] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_fits_are_near_the_integral() {
        for eta in [1.2_f32, 1.5, 1.9, 1.0 / 1.3, 1.0 / 1.5, 1.0 / 1.9] {
            let n = 20_000;
            let integral: f32 = (0..n)
                .map(|i| {
                    let cos2 = (i as f32 + 0.5) / n as f32; // cos² is uniform under a cosine-weighted hemisphere
                    dielectric(cos2.sqrt(), eta).reflectance
                })
                .sum::<f32>()
                / n as f32;
            assert!((diffuse_reflectance(eta) - integral).abs() < 0.015, "{eta}: {integral}");
            assert!((mean_reflectance(eta) - integral).abs() < 1e-4, "{eta}: {integral}");
        }
    }
}
