//! `rough_diffuse`: a matte surface of diffusing grooves: clay, plaster, the moon. Flatter than `diffuse`.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `reflectance` | texture | 0.5 | albedo, in [0, 1] |
//! | `roughness` | texture | 0.5 | of the grooves, in [0, 1]; 0 is `diffuse` |
//!
//! Light between grooves is kept: a white surface returns everything. Black from behind.
//!
//! # References
//! - [Oren and Nayar 1994] "Generalization of Lambert's Reflectance Model"; in the form of [Fujii 2012].
//! - [Portsmouth, Kutz and Hill 2024] "EON: A Practical Energy-Preserving Rough Diffuse BRDF".

use std::f32::consts::{FRAC_1_PI, PI};

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3, warp};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver, Texture, float_texture, spectrum_texture};

/// A grooved matte surface.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuse {
    reflectance: Id<Texture>,
    roughness: Id<Texture>,
}

impl Element for RoughDiffuse {
    const SUMMARY: &'static str = "A matte surface of diffusing grooves: clay, plaster, the moon.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "reflectance", ty: "texture", default: "0.5", doc: "albedo, in [0, 1]" },
        ParamDoc { name: "roughness", ty: "texture", default: "0.5", doc: "of the grooves, in [0, 1]" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let reflectance = spectrum_texture(params, resolver, "reflectance", 0.5, SpectrumRole::Albedo)?;
        Ok(Self { reflectance, roughness: float_texture(params, resolver, "roughness", 0.5)? })
    }
}

impl MaterialOps for RoughDiffuse {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let lobe = RoughDiffuseLobe {
            reflectance: at.texture.albedo(self.reflectance),
            roughness: at.texture.float(self.roughness).clamp(0.0, 1.0),
        };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// Reflection by diffusing grooves.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuseLobe {
    /// Albedo of the grooves.
    pub reflectance: Spectrum,
    /// Their roughness, in [0, 1].
    pub roughness: f32,
}

impl RoughDiffuseLobe {
    /// The factor A of Fujii's model.
    #[inline]
    fn a(&self) -> f32 {
        1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * self.roughness)
    }

    /// How much light white grooves return after one scattering.
    #[inline]
    fn single_albedo(&self, cos: f32) -> f32 {
        let cos = cos.clamp(1e-4, 1.0);
        let sin = (1.0 - cos * cos).sqrt();
        let g = sin * (cos.acos() - sin * cos) + (2.0 / 3.0) * (sin / cos * (1.0 - sin.powi(3)) - sin);
        self.a() * (1.0 + self.roughness * FRAC_1_PI * g)
    }
}

impl LobeOps for RoughDiffuseLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let s = wo.dot(wi) - wo.z * wi.z;
        let tilt = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
        let single = self.reflectance * (FRAC_1_PI * self.a() * (1.0 + self.roughness * tilt));
        // What several grooves return, spread evenly [Kulla and Conty 2017].
        let mean = self.a() * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * self.roughness);
        let lost = |cos: f32| (1.0 - self.single_albedo(cos)).max(0.0);
        let missing = lost(wo.z) * lost(wi.z) / (1.0 - mean).max(1e-6);
        let again =
            self.reflectance * self.reflectance * mean / (Spectrum::ONE - self.reflectance * (1.0 - mean));
        single.max_zero() + again * (FRAC_1_PI * missing)
    }

    fn sample(&self, wo: Vector3, _: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = warp::square_to_cosine_hemisphere(u);
        (wi.z > 0.0).then(|| LobeSample {
            wi,
            value: self.eval(wo, wi, mode),
            pdf_omega: warp::cosine_hemisphere_pdf(wi.z),
            flags: LobeFlags::REFLECTION,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z > 0.0 && wi.z > 0.0 { warp::cosine_hemisphere_pdf(wi.z) } else { 0.0 }
    }

    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, _: Vector3) -> Spectrum {
        self.reflectance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_grooves_return_everything() {
        for roughness in [0.0_f32, 0.5, 1.0] {
            let lobe = RoughDiffuseLobe { reflectance: Spectrum::ONE, roughness };
            for cos in [0.1_f32, 0.5, 1.0] {
                let wo = Vector3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let n = 400;
                let sum: f32 = (0..n * n)
                    .map(|i| {
                        let middle = |k: usize| (k as f32 + 0.5) / n as f32;
                        let u = Point2::new(middle(i % n), middle(i / n));
                        let wi = warp::square_to_cosine_hemisphere(u);
                        lobe.eval(wo, wi, TransportMode::Radiance)[0] * PI
                    })
                    .sum();
                assert!((sum / (n * n) as f32 - 1.0).abs() < 5e-3, "{roughness} {cos}: {sum}");
            }
        }
    }
}
