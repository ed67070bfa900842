//! `subsurface`: skin, milk, marble, wax: light enters by refraction, walks at random inside the body, and leaves elsewhere.
//!
//! The walk is a true one, through whatever geometry the body has, and ends where it meets the boundary and passes; pbrt's
//! own `subsurface` instead looks up a table for flat, endless bodies. Only the integrator `path` walks.
//! The shape should be closed.
//!
//! What is inside is given in one of three ways: by `name`; by `sigma_a` and `sigma_s`; or by what is seen, `reflectance` and
//! `mfp`. Without any it is whole milk.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `int_ior`, `ext_ior` | float or name | water, air | indices inside and outside |
//! | `alpha`, `alpha_u`, `alpha_v` | texture | 0 | the boundary's GGX roughness, seen from outside |
//! | `name` | string | | a measured substance, per millimetre; scatters isotropically |
//! | `sigma_a`, `sigma_s` | texture | milk | absorption and scattering per unit length |
//! | `reflectance` | texture | | the share of entering diffuse light that leaves again, were the body flat and endless |
//! | `mfp` | texture | 1 | with `reflectance`: mean free path between events |
//! | `scale` | float | 1 | factor on `sigma_a` and `sigma_s`, or on `mfp` |
//! | `g` | float | 0 | mean cosine of scattering, in (-1, 1) |
//! | `exit` | string | refracted | `refracted`: as the walk arrives; `diffuse`: spread out, as pbrt does |
//!
//! A `refracted` exit is what a boundary does, but through a smooth one light samples cannot pass, and lamps without
//! size do not shine in. A `diffuse` exit lets the same light out, in directions that have nothing to do with the walk's last.
//!
//! *Accuracy.* `reflectance` is met within 0.005 for isotropic scattering, and within 0.02 for others (by similarity).
//! Walks end after 65,536 events; of a white, endless body that loses about 0.2 % of the light.
//!
//! # References
//! - [Chiang, Kutz and Burley 2016] "Practical and Controllable Subsurface Scattering for Production Path Tracing".
//! - [Jensen et al. 2001] "A Practical Model for Subsurface Light Transport"; [Narasimhan et al. 2006] "Acquiring Scattering
//!   Properties of Participating Media by Dilution": measured substances.

use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Id;
use aureole_spectrum::{Spectrum, SpectrumRole, SpectrumSource, scattering_substances};

use super::dielectric::{Glass, relative_ior};
use super::half_space::Albedos;
use super::microfacet::Finish;
use super::{
    Bsdf, DielectricLobe, Interior, MaterialContext, MaterialOps, RoughDielectricLobe, SubsurfaceLobe,
};
use crate::{Element, Resolver, Texture, TextureContext, spectrum_texture};

/// How light leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exit {
    Refracted,
    Diffuse,
}

/// What is inside.
#[derive(Clone, Copy, Debug)]
enum Filling {
    Coefficients { absorption: Id<Texture>, scattering: Id<Texture> },
    Look { reflectance: Id<Texture>, mean_free_path: Id<Texture> },
}

/// A body that scatters inside.
#[derive(Clone, Debug)]
pub struct Subsurface {
    eta: f32,
    finish: Finish,
    filling: Filling,
    scale: f32,
    g: f32,
    exit: Exit,
    albedos: Arc<Albedos>,
}

const fn doc(name: &'static str, ty: &'static str, default: &'static str, doc: &'static str) -> ParamDoc {
    ParamDoc { name, ty, default, doc }
}

/// A constant texture of a measured value.
fn constant(resolver: &mut dyn Resolver, rgb: [f32; 3]) -> Id<Texture> {
    resolver.constant(&SpectrumSource::Rgb(rgb), SpectrumRole::Unbounded)
}

impl Filling {
    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("name");
        let name = params.try_string("name")?;
        let has_coefficients = ["sigma_a", "sigma_s"].iter().any(|own| params.has(own));
        if name.is_none() && !has_coefficients && params.has("reflectance") {
            return Ok(Self::Look {
                reflectance: spectrum_texture(params, resolver, "reflectance", 0.5, SpectrumRole::Albedo)?,
                mean_free_path: spectrum_texture(params, resolver, "mfp", 1.0, SpectrumRole::Unbounded)?,
            });
        }
        let wanted = name.as_deref().unwrap_or("Wholemilk");
        let measured = scattering_substances().find(|s| s.name == wanted).ok_or_else(|| {
            let known = scattering_substances().map(|s| s.name.to_owned()).collect();
            SceneError::UnknownName { what: "substance", name: wanted.to_owned(), known, at }
        })?;
        let mut coefficient = |own: &str, measured: [f32; 3]| {
            if name.is_none() && params.has(own) {
                spectrum_texture(params, resolver, own, 0.0, SpectrumRole::Unbounded)
            } else {
                Ok(constant(resolver, measured))
            }
        };
        Ok(Self::Coefficients {
            absorption: coefficient("sigma_a", measured.absorption)?,
            scattering: coefficient("sigma_s", measured.scattering)?,
        })
    }
}

/// The medium that looks as wanted, by colour and mean free path.
pub(super) fn looks_like(albedos: &Albedos, color: Spectrum, mean_free_path: Spectrum, g: f32) -> Interior {
    let albedo = color.map(|c| albedos.albedo(c, g));
    let extinction = mean_free_path.map(|length| 1.0 / length.clamp(1e-9, f32::MAX));
    Interior { extinction, albedo, g }
}

impl Subsurface {
    fn interior(&self, at: &TextureContext<'_>) -> Interior {
        match self.filling {
            Filling::Coefficients { absorption, scattering } => Interior::from_coefficients(
                at.spectrum(absorption) * self.scale,
                at.spectrum(scattering) * self.scale,
                self.g,
            ),
            Filling::Look { reflectance, mean_free_path } => {
                let length = at.spectrum(mean_free_path) * self.scale;
                looks_like(&self.albedos, at.spectrum(reflectance), length, self.g)
            }
        }
    }
}

impl Element for Subsurface {
    const SUMMARY: &'static str = "Skin, milk, marble: light walks at random inside and leaves elsewhere.";
    const PARAMS: &'static [ParamDoc] = &[
        doc("int_ior", "float or name", "water", "index inside, or a substance's name"),
        doc("ext_ior", "float or name", "air", "index outside"),
        doc("alpha", "texture", "0", "the boundary's roughness in both directions"),
        doc("alpha_u", "texture", "alpha", "roughness along the tangent"),
        doc("alpha_v", "texture", "alpha", "roughness across it"),
        doc("name", "string", "", "a measured substance, per millimetre"),
        doc("sigma_a", "texture", "milk", "absorption per unit length"),
        doc("sigma_s", "texture", "milk", "scattering per unit length"),
        doc("reflectance", "texture", "", "the share of entering light that leaves a flat, endless body"),
        doc("mfp", "texture", "1", "with `reflectance`: mean free path between events"),
        doc("scale", "float", "1", "factor on the coefficients, or on `mfp`"),
        doc("g", "float", "0", "mean cosine of scattering"),
        doc("exit", "string", "refracted", "`refracted`, or `diffuse`: spread out, as pbrt does"),
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let eta = relative_ior(params, "water")?;
        let given_g = params.float_in("g", 0.0, -0.99, 0.99)?;
        // Measured coefficients are reduced ones.
        let g = if params.has("name") { 0.0 } else { given_g };
        Ok(Self {
            eta,
            finish: Finish::from_params(params, resolver, "alpha")?,
            filling: Filling::from_params(params, resolver)?,
            scale: params.float_in("scale", 1.0, 0.0, 1e9)?,
            g,
            exit: params.one_of("exit", &[("refracted", Exit::Refracted), ("diffuse", Exit::Diffuse)])?,
            albedos: Arc::new(Albedos::new(eta)),
        })
    }
}

impl MaterialOps for Subsurface {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let glass =
            Glass { eta: self.eta, reflectance: Spectrum::ONE, transmittance: Spectrum::ONE, film: None };
        let (interior, surface) = (self.interior(&at.texture), self.finish.at(&at.texture));
        let (frame, n) = (at.frame, at.frame.n);
        match (self.exit, surface) {
            (Exit::Diffuse, surface) => {
                let returned = interior.albedo.map(|albedo| self.albedos.returned(albedo, self.g));
                out.push_boundary(SubsurfaceLobe { glass, surface, returned }, interior, weight, frame, n);
            }
            (Exit::Refracted, Some(surface)) => {
                out.push_boundary(RoughDielectricLobe { glass, surface }, interior, weight, frame, n);
            }
            (Exit::Refracted, None) => {
                out.push_boundary(DielectricLobe { glass }, interior, weight, frame, n);
            }
        }
    }
}
