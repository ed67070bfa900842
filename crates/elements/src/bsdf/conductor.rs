//! `conductor`: a smooth metal, or a perfect mirror.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `material` | string | Cu | a metal's name (`Au`, `Al`, ...), or `none` for a perfect mirror |
//! | `eta`, `k` | texture | by `material` | complex index of refraction |
//! | `reflectance` | texture | | reflectance at normal incidence, instead of an index |
//! | `ext_eta` | float | 1 | index of the medium outside |
//! | `specular_reflectance` | texture | 1 | factor |
//! | `film_thickness` | texture | 0 | thickness in nanometres of a transparent film that makes colours by interference |
//! | `film_ior` | float | 1.33 | index of the film over that outside |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3};
use aureole_spectrum::{Spectrum, SpectrumRole, SpectrumSource, metal, metals};

use super::thin_film::{FILM_PARAMS, Film, FilmTexture};
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver, Texture, TextureContext, spectrum_texture};

/// What makes a metal's colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metallic {
    color: Color,
    ext_eta: f32,
    tint: Id<Texture>,
    film: Option<FilmTexture>,
}

/// What decides how much a metal reflects.
#[derive(Clone, Copy, Debug)]
enum Color {
    /// Everything.
    Mirror,
    /// The complex index.
    Index([Id<Texture>; 2]),
    /// The reflectance at normal incidence, by an index whose real part is one.
    Reflectance(Id<Texture>),
}

/// The imaginary index, beside a real one of 1, that reflects so much at normal incidence: r = k² / (4 + k²).
fn absorption(reflectance: Spectrum) -> Spectrum {
    let r = reflectance.clamp(0.0, 0.9999);
    (r / (Spectrum::ONE - r)).sqrt() * 2.0
}

/// Documentation of the parameters of metals.
pub(super) const METAL_PARAMS: [ParamDoc; 8] = [
    ParamDoc {
        name: "material",
        ty: "string",
        default: "Cu",
        doc: "a metal's name, or `none` for a perfect mirror",
    },
    ParamDoc { name: "eta", ty: "texture", default: "by material", doc: "index of refraction, real part" },
    ParamDoc { name: "k", ty: "texture", default: "by material", doc: "index of refraction, imaginary part" },
    ParamDoc {
        name: "reflectance",
        ty: "texture",
        default: "",
        doc: "reflectance at normal incidence, instead of an index",
    },
    ParamDoc { name: "ext_eta", ty: "float", default: "1", doc: "index of the medium outside" },
    ParamDoc { name: "specular_reflectance", ty: "texture", default: "1", doc: "factor" },
    FILM_PARAMS[0],
    FILM_PARAMS[1],
];

impl Metallic {
    pub(super) fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let tint = spectrum_texture(params, resolver, "specular_reflectance", 1.0, SpectrumRole::Albedo)?;
        let ext_eta = params.float_in("ext_eta", 1.0, 0.1, 10.0)?;
        let film = FilmTexture::from_params(params, resolver)?;
        let mut this = Self { color: Color::Mirror, ext_eta, tint, film };
        let name = params.try_string("material")?;
        if name.as_deref() == Some("none") {
            return Ok(this);
        }
        if params.has("reflectance") {
            let color = spectrum_texture(params, resolver, "reflectance", 1.0, SpectrumRole::Albedo)?;
            this.color = Color::Reflectance(color);
            return Ok(this);
        }
        if params.has("eta") || params.has("k") {
            let mut part =
                |name, default| spectrum_texture(params, resolver, name, default, SpectrumRole::Unbounded);
            this.color = Color::Index([part("eta", 0.0)?, part("k", 1.0)?]);
            return Ok(this);
        }
        let name = name.unwrap_or_else(|| "Cu".to_owned());
        let found = metal(&name).ok_or_else(|| SceneError::UnknownName {
            what: "metal",
            name: name.clone(),
            known: metals().iter().map(|m| m.name.to_owned()).collect(),
            at: params.span("material"),
        })?;
        let mut part = |table: &std::sync::Arc<_>| {
            resolver.constant(&SpectrumSource::Tabulated(std::sync::Arc::clone(table)), SpectrumRole::Index)
        };
        this.color = Color::Index([part(&found.eta), part(&found.k)]);
        Ok(this)
    }

    #[inline]
    pub(super) fn at(&self, at: &TextureContext<'_>) -> Metal {
        let response = match self.color {
            Color::Mirror => Response::Mirror,
            Color::Index([eta, k]) => Response::Index([at.spectrum(eta), at.spectrum(k)]),
            Color::Reflectance(r) => Response::Index([Spectrum::ONE, absorption(at.spectrum(r))]),
        };
        let film = self.film.and_then(|film| film.at(at));
        Metal { response, tint: at.albedo(self.tint), film }.below(self.ext_eta)
    }
}

/// How a metal's reflectance depends on the angle.
#[derive(Clone, Copy, Debug)]
pub enum Response {
    /// Not at all: a perfect mirror.
    Mirror,
    /// By a complex index.
    Index([Spectrum; 2]),
    /// By Schlick's approximation from the reflectance at normal incidence, darkened by a factor around 82°.
    Tinted([Spectrum; 2]),
}

/// A metal's response and tint at a point.
#[derive(Clone, Copy, Debug)]
pub struct Metal {
    /// What makes its colour.
    pub response: Response,
    /// Factor.
    pub tint: Spectrum,
    /// A transparent film on it.
    pub film: Option<Film>,
}

impl Metal {
    /// The same metal below a medium of index `eta` instead of vacuum.
    #[inline]
    pub fn below(self, eta: f32) -> Self {
        match self.response {
            Response::Index([n, k]) => Self { response: Response::Index([n / eta, k / eta]), ..self },
            _ => self,
        }
    }

    /// Reflectance at a cosine of incidence.
    #[inline]
    pub fn reflectance(&self, cos_i: f32) -> Spectrum {
        let bare = match self.response {
            Response::Mirror => return self.tint,
            Response::Index([eta, k]) => fresnel::conductor(cos_i, eta, k),
            Response::Tinted([f0, edge]) => fresnel::tinted(cos_i, f0, edge),
        };
        self.film.map_or(bare, |film| bare.lerp(self.filmed(film, cos_i), film.weight)) * self.tint
    }

    fn filmed(&self, film: Film, cos_i: f32) -> Spectrum {
        match self.response {
            Response::Index([eta, k]) => film.reflectance(cos_i, eta, k),
            Response::Tinted([f0, _]) => film.reflectance(cos_i, Spectrum::ONE, absorption(f0)),
            Response::Mirror => Spectrum::ONE,
        }
    }
}

/// A smooth metal.
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    metal: Metallic,
}

impl Element for Conductor {
    const SUMMARY: &'static str = "A smooth metal, or a perfect mirror.";
    const PARAMS: &'static [ParamDoc] = &METAL_PARAMS;

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self { metal: Metallic::from_params(params, resolver)? })
    }
}

impl MaterialOps for Conductor {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(ConductorLobe { metal: self.metal.at(&at.texture) }, weight, at.frame, at.frame.n);
    }
}

/// A mirror with a metal's reflectance.
#[derive(Clone, Copy, Debug)]
pub struct ConductorLobe {
    /// The metal.
    pub metal: Metal,
}

impl LobeOps for ConductorLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    #[inline]
    fn sample(&self, wo: Vector3, _: f32, _: Point2, _: TransportMode) -> Option<LobeSample> {
        (wo.z > 0.0).then(|| LobeSample {
            wi: Vector3::new(-wo.x, -wo.y, wo.z),
            value: self.metal.reflectance(wo.z) / wo.z,
            pdf_omega: 1.0,
            flags: LobeFlags::DELTA_REFLECTION,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.metal.reflectance(wo.z.abs())
    }
}
