//! `dielectric`: smooth glass, water, diamond.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `int_ior` | float or string | bk7 | index inside, or a substance's name |
//! | `ext_ior` | float or string | air | index outside |
//! | `specular_reflectance` | texture | 1 | factor on what is reflected |
//! | `specular_transmittance` | texture | 1 | factor on what passes |
//! | `film_thickness` | texture | 0 | thickness in nanometres of a transparent film that makes colours by interference |
//! | `film_ior` | float | 1.33 | index of the film over that outside |

use aureole_desc::{ParamDoc, Params, SceneError, Value};
use aureole_math::{Id, Point2, Vector3};
use aureole_spectrum::{Spectrum, SpectrumRole, dielectric_ior, dielectrics};

use super::fresnel::DielectricFresnel;
use super::lobe::Sides;
use super::thin_film::{FILM_PARAMS, Film, FilmTexture};
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver, Texture, TextureContext, spectrum_texture};

/// Documentation of the parameters that all dielectrics share.
pub(super) const BOUNDARY_PARAMS: [ParamDoc; 4] = [
    ParamDoc {
        name: "int_ior",
        ty: "float or name",
        default: "bk7",
        doc: "index inside, or a substance's name",
    },
    ParamDoc { name: "ext_ior", ty: "float or name", default: "air", doc: "index outside" },
    ParamDoc {
        name: "specular_reflectance",
        ty: "texture",
        default: "1",
        doc: "factor on what is reflected",
    },
    ParamDoc { name: "specular_transmittance", ty: "texture", default: "1", doc: "factor on what passes" },
];

/// An index of refraction, by number or by name.
fn ior(params: &mut Params, name: &str, default: &str) -> Result<f32, SceneError> {
    let word = match params.get(name) {
        Some(Value::String(_)) => params.try_string(name)?.unwrap_or_default(),
        Some(_) => return params.float_in(name, 1.0, 0.1, 100.0),
        None => default.to_owned(),
    };
    dielectric_ior(&word).ok_or_else(|| SceneError::UnknownName {
        what: "substance",
        name: word.clone(),
        known: dielectrics().map(|(name, _)| name.to_owned()).collect(),
        at: params.span(name),
    })
}

/// The relative index: inside over outside.
pub(super) fn relative_ior(params: &mut Params, default: &str) -> Result<f32, SceneError> {
    Ok(ior(params, "int_ior", default)? / ior(params, "ext_ior", "air")?)
}

/// What all dielectrics share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary {
    /// Index inside over outside.
    pub eta: f32,
    reflectance: Id<Texture>,
    transmittance: Id<Texture>,
}

impl Boundary {
    pub(super) fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let eta = relative_ior(params, "bk7")?;
        let mut factor = |name| spectrum_texture(params, resolver, name, 1.0, SpectrumRole::Albedo);
        Ok(Self {
            eta,
            reflectance: factor("specular_reflectance")?,
            transmittance: factor("specular_transmittance")?,
        })
    }

    #[inline]
    pub(super) fn at(&self, at: &TextureContext<'_>) -> Glass {
        Glass {
            eta: self.eta,
            reflectance: at.albedo(self.reflectance),
            transmittance: at.albedo(self.transmittance),
            film: None,
        }
    }
}

/// A dielectric boundary at a point.
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    /// Index below the surface over index above.
    pub eta: f32,
    /// Factor on what is reflected.
    pub reflectance: Spectrum,
    /// Factor on what passes.
    pub transmittance: Spectrum,
    /// A transparent film on it.
    pub film: Option<Film>,
}

impl Glass {
    /// The share of light that the boundary reflects, in colour if there is a film; and what it does without one.
    #[inline]
    pub(super) fn fresnel(&self, cos: f32) -> (Spectrum, DielectricFresnel) {
        let bare = fresnel::dielectric(cos, self.eta);
        let Some(film) = self.film else { return (Spectrum::splat(bare.reflectance), bare) };
        // A film reflects as much light from below as from above on the same path.
        let above = if cos >= 0.0 { cos } else { bare.cos_t.abs() };
        if bare.cos_t == 0.0 {
            return (Spectrum::ONE, bare);
        }
        let filmed = film.reflectance(above, Spectrum::splat(self.eta), Spectrum::ZERO);
        (Spectrum::splat(bare.reflectance).lerp(filmed, film.weight), bare)
    }

    /// All light that is reflected or passes.
    pub(super) fn albedo(&self, cos: f32) -> Spectrum {
        let (f, _) = self.fresnel(cos);
        self.reflectance * f + self.transmittance * (Spectrum::ONE - f)
    }
}

/// Smooth glass.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    boundary: Boundary,
    film: Option<FilmTexture>,
}

impl Element for Dielectric {
    const SUMMARY: &'static str = "Smooth glass, water, diamond.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d] = BOUNDARY_PARAMS;
        let [e, f] = FILM_PARAMS;
        [a, b, c, d, e, f]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let boundary = Boundary::from_params(params, resolver)?;
        Ok(Self { boundary, film: FilmTexture::from_params(params, resolver)? })
    }
}

impl MaterialOps for Dielectric {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let film = self.film.and_then(|film| film.at(&at.texture));
        let glass = Glass { film, ..self.boundary.at(&at.texture) };
        out.push(DielectricLobe { glass }, weight, at.frame, at.frame.n);
    }
}

/// Mirror reflection and refraction.
#[derive(Clone, Copy, Debug)]
pub struct DielectricLobe {
    /// The boundary.
    pub glass: Glass,
}

impl LobeOps for DielectricLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    #[inline]
    fn sample(&self, wo: Vector3, uc: f32, _: Point2, mode: TransportMode) -> Option<LobeSample> {
        self.sample_from(Sides::Both, wo, uc, mode)
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.glass.albedo(wo.z)
    }
}

impl DielectricLobe {
    /// Draws from some sides.
    #[inline]
    pub(super) fn sample_from(
        &self,
        sides: Sides,
        wo: Vector3,
        uc: f32,
        mode: TransportMode,
    ) -> Option<LobeSample> {
        let (reflectance, f) = self.glass.fresnel(wo.z);
        let p = sides.reflection_probability(reflectance.average())?;
        if wo.z == 0.0 {
            return None;
        }
        if uc < p {
            let wi = Vector3::new(-wo.x, -wo.y, wo.z);
            let value = self.glass.reflectance * reflectance / wi.z.abs();
            return Some(LobeSample {
                wi,
                value,
                pdf_omega: p,
                flags: LobeFlags::DELTA_REFLECTION,
                eta: 1.0,
            });
        }
        let scale = 1.0 / f.eta_path;
        let wi = Vector3::new(-wo.x * scale, -wo.y * scale, f.cos_t);
        // Refraction squeezes a pencil of radiance by the square of the relative index.
        let squeeze = if mode == TransportMode::Radiance { scale * scale } else { 1.0 };
        let value = self.glass.transmittance * (Spectrum::ONE - reflectance) * (squeeze / wi.z.abs());
        let flags = LobeFlags::DELTA_TRANSMISSION;
        Some(LobeSample { wi, value, pdf_omega: 1.0 - p, flags, eta: f.eta_path })
    }
}
