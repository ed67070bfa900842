//! `open_pbr`: the OpenPBR surface, version 1.1: one material for nearly everything, by its specification's parameters.
//!
//! From below to above: a base, mixed of metal, glass and a glossy matte surface; a coat; fuzz. Each layer lets the
//! layers below have the light that it does not reflect, as seen by the viewer (the specification's *albedo scaling*).
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `base_weight`, `base_color` | texture | 1, 0.8 | albedo of the matte base and of metal at normal incidence |
//! | `base_diffuse_roughness` | texture | 0 | grooves of the matte base |
//! | `base_metalness` | texture | 0 | from dielectric to metal |
//! | `specular_weight`, `specular_color` | texture | 1, 1 | reflectance of the base's surface; of metals, the tint at 82° |
//! | `specular_roughness`, `specular_roughness_anisotropy` | texture | 0.3, 0 | of the base's surface |
//! | `specular_ior` | float | 1.5 | index of the dielectric base |
//! | `transmission_weight`, `transmission_color` | texture | 0, 1 | from matte to glass; the colour that passes |
//! | `subsurface_weight`, `subsurface_color` | texture | 0, 0.8 | from matte to subsurface scattering |
//! | `coat_weight`, `coat_color` | texture | 0, 1 | a clear coat, and the colour that it lets pass |
//! | `coat_roughness`, `coat_roughness_anisotropy` | texture | 0, 0 | of the coat's surface |
//! | `coat_ior`, `coat_darkening` | float, texture | 1.6, 1 | index of the coat; how far it deepens the base's colour |
//! | `fuzz_weight`, `fuzz_color`, `fuzz_roughness` | texture | 0, 1, 0.5 | fibres or dust on top |
//! | `thin_film_weight`, `thin_film_thickness` | texture | 0, 0.5 | a film on the base; thickness in micrometres |
//! | `thin_film_ior` | float | 1.4 | index of the film |
//! | `geometry_opacity` | texture | 1 | 0: a hole |
//! | `geometry_thin_walled` | bool | false | glass is a pane without inside |
//!
//! *Limits.* Subsurface scattering is a matte reflection of its colour, and what a volume inside would do
//! (`transmission_depth`, `transmission_scatter`, dispersion) is left out: the parameters are read, with a warning where
//! they ask for something. Light of its own is a shape's (`emission`). Fuzz is [`sheen`](super::sheen)'s.
//!
//! # References
//! [Andersson et al. 2024] "OpenPBR Surface Specification", version 1.1, Academy Software Foundation.

mod layers;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Id;
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::directional::AlbedoTable;
use super::{Bsdf, MaterialContext, MaterialOps};
use crate::{Element, Resolver, Texture, TextureContext, float_texture, spectrum_texture};

/// A colour with its weight.
#[derive(Clone, Copy, Debug)]
struct Weighted {
    weight: Id<Texture>,
    color: Id<Texture>,
}

impl Weighted {
    fn color_at(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.color).clamp(0.0, 1.0)
    }

    fn weight_at(&self, at: &TextureContext<'_>) -> f32 {
        at.float(self.weight).clamp(0.0, 1.0)
    }
}

/// A roughness with its anisotropy.
#[derive(Clone, Copy, Debug)]
struct Finish {
    roughness: Id<Texture>,
    anisotropy: Id<Texture>,
}

/// The OpenPBR surface.
#[derive(Clone, Debug)]
pub struct OpenPbr {
    base: Weighted,
    diffuse_roughness: Id<Texture>,
    metalness: Id<Texture>,
    specular: Weighted,
    specular_finish: Finish,
    specular_ior: f32,
    transmission: Weighted,
    subsurface: Weighted,
    coat: Weighted,
    coat_finish: Finish,
    coat_ior: f32,
    coat_darkening: Id<Texture>,
    fuzz: Weighted,
    fuzz_roughness: Id<Texture>,
    film_weight: Id<Texture>,
    film_thickness: Id<Texture>,
    film_ior: f32,
    opacity: Id<Texture>,
    is_thin_walled: bool,
    /// What the base's and the coat's surface reflect.
    gloss: AlbedoTable,
    coat_gloss: AlbedoTable,
}

const fn doc(name: &'static str, ty: &'static str, default: &'static str, doc: &'static str) -> ParamDoc {
    ParamDoc { name, ty, default, doc }
}

/// Parameters of volumes and light, that are read but not rendered.
const UNUSED: [&str; 11] = [
    "transmission_depth",
    "transmission_scatter",
    "transmission_scatter_anisotropy",
    "transmission_dispersion_scale",
    "transmission_dispersion_abbe_number",
    "subsurface_radius",
    "subsurface_radius_scale",
    "subsurface_scatter_anisotropy",
    "emission_luminance",
    "emission_color",
    "geometry_coat_normal",
];

impl Element for OpenPbr {
    const SUMMARY: &'static str = "The OpenPBR surface, version 1.1: one material for nearly everything.";
    const PARAMS: &'static [ParamDoc] = &[
        doc("base_weight", "texture", "1", "factor on the base's colour"),
        doc("base_color", "texture", "0.8", "albedo of the matte base and of metal"),
        doc("base_diffuse_roughness", "texture", "0", "grooves of the matte base"),
        doc("base_metalness", "texture", "0", "from dielectric to metal"),
        doc("specular_weight", "texture", "1", "reflectance of the base's surface"),
        doc("specular_color", "texture", "1", "its tint; of metals, at 82 degrees"),
        doc("specular_roughness", "texture", "0.3", "roughness of the base's surface"),
        doc("specular_roughness_anisotropy", "texture", "0", "stretch of its highlights"),
        doc("specular_ior", "float", "1.5", "index of the dielectric base"),
        doc("transmission_weight", "texture", "0", "from matte to glass"),
        doc("transmission_color", "texture", "1", "the colour that passes"),
        doc("subsurface_weight", "texture", "0", "from matte to subsurface scattering"),
        doc("subsurface_color", "texture", "0.8", "its colour"),
        doc("coat_weight", "texture", "0", "a clear coat"),
        doc("coat_color", "texture", "1", "the colour that it lets pass"),
        doc("coat_roughness", "texture", "0", "roughness of its surface"),
        doc("coat_roughness_anisotropy", "texture", "0", "stretch of its highlights"),
        doc("coat_ior", "float", "1.6", "its index"),
        doc("coat_darkening", "texture", "1", "how far it deepens the base's colour"),
        doc("fuzz_weight", "texture", "0", "fibres or dust on top"),
        doc("fuzz_color", "texture", "1", "their colour"),
        doc("fuzz_roughness", "texture", "0.5", "spread of their reflection"),
        doc("thin_film_weight", "texture", "0", "a film on the base"),
        doc("thin_film_thickness", "texture", "0.5", "its thickness in micrometres"),
        doc("thin_film_ior", "float", "1.4", "its index"),
        doc("geometry_opacity", "texture", "1", "0: a hole"),
        doc("geometry_thin_walled", "bool", "false", "glass is a pane without inside"),
        doc("transmission_depth", "float", "0", "not rendered"),
        doc("transmission_scatter", "spectrum", "0", "not rendered"),
        doc("subsurface_radius", "float", "1", "not rendered"),
        doc("emission_luminance", "float", "0", "not rendered: light is a shape's"),
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        for name in UNUSED {
            let at = params.span(name);
            if params.take(name).is_some() {
                resolver.report().warn(format!("`{name}` of `open_pbr` is not rendered"), at);
            }
        }
        let mut float =
            |params: &mut Params, name: &str, default| float_texture(params, resolver, name, default);
        let (diffuse_roughness, metalness) =
            (float(params, "base_diffuse_roughness", 0.0)?, float(params, "base_metalness", 0.0)?);
        let mut finish = |params: &mut Params, layer: &str, default| -> Result<Finish, SceneError> {
            let name = format!("{layer}_roughness");
            let anisotropy = float(params, &format!("{name}_anisotropy"), 0.0)?;
            Ok(Finish { roughness: float(params, &name, default)?, anisotropy })
        };
        let (specular_finish, coat_finish) = (finish(params, "specular", 0.3)?, finish(params, "coat", 0.0)?);
        let (coat_darkening, fuzz_roughness) =
            (float(params, "coat_darkening", 1.0)?, float(params, "fuzz_roughness", 0.5)?);
        let (film_weight, film_thickness) =
            (float(params, "thin_film_weight", 0.0)?, float(params, "thin_film_thickness", 0.5)?);
        let opacity = float(params, "geometry_opacity", 1.0)?;
        let mut weighted =
            |params: &mut Params, layer: &str, weight, color| -> Result<Weighted, SceneError> {
                let (weight_name, color_name) = (format!("{layer}_weight"), format!("{layer}_color"));
                let weight = float_texture(params, resolver, &weight_name, weight)?;
                let color = spectrum_texture(params, resolver, &color_name, color, SpectrumRole::Albedo)?;
                Ok(Weighted { weight, color })
            };
        let (specular_ior, coat_ior) =
            (params.float_in("specular_ior", 1.5, 1.0, 5.0)?, params.float_in("coat_ior", 1.6, 1.0, 5.0)?);
        Ok(Self {
            base: weighted(params, "base", 1.0, 0.8)?,
            specular: weighted(params, "specular", 1.0, 1.0)?,
            transmission: weighted(params, "transmission", 0.0, 1.0)?,
            subsurface: weighted(params, "subsurface", 0.0, 0.8)?,
            coat: weighted(params, "coat", 0.0, 1.0)?,
            fuzz: weighted(params, "fuzz", 0.0, 1.0)?,
            film_ior: params.float_in("thin_film_ior", 1.4, 1.0, 5.0)?,
            is_thin_walled: params.bool("geometry_thin_walled", false)?,
            diffuse_roughness,
            metalness,
            specular_finish,
            specular_ior,
            coat_finish,
            coat_ior,
            coat_darkening,
            fuzz_roughness,
            film_weight,
            film_thickness,
            opacity,
            gloss: AlbedoTable::gloss(specular_ior),
            coat_gloss: AlbedoTable::gloss(coat_ior),
        })
    }
}

impl MaterialOps for OpenPbr {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        layers::evaluate(self, at, weight, out);
    }
}
