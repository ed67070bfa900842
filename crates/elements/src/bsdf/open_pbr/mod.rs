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
//! | `transmission_depth` | float | 0 | where white light has the colour that passes; 0: the surface itself is coloured |
//! | `transmission_scatter`, `transmission_scatter_anisotropy` | texture, float | 0, 0 | of glass with a depth: cloudiness |
//! | `transmission_dispersion_scale`, `transmission_dispersion_abbe_number` | float | 0, 20 | spread of the index over colours |
//! | `subsurface_weight`, `subsurface_color` | texture | 0, 0.8 | from matte to a body that scatters, and the colour it is seen in |
//! | `subsurface_radius`, `subsurface_radius_scale` | texture | 1, (1, 0.5, 0.25) | mean free path inside, and its colour |
//! | `subsurface_scatter_anisotropy` | float | 0 | mean cosine of scattering inside |
//! | `coat_weight`, `coat_color` | texture | 0, 1 | a clear coat, and the colour that it lets pass |
//! | `coat_roughness`, `coat_roughness_anisotropy` | texture | 0, 0 | of the coat's surface |
//! | `coat_ior`, `coat_darkening` | float, texture | 1.6, 1 | index of the coat; how far it deepens the base's colour |
//! | `fuzz_weight`, `fuzz_color`, `fuzz_roughness` | texture | 0, 1, 0.5 | fibres or dust on top |
//! | `thin_film_weight`, `thin_film_thickness` | texture | 0, 0.5 | a film on the base; thickness in micrometres |
//! | `thin_film_ior` | float | 1.4 | index of the film |
//! | `geometry_opacity` | texture | 1 | 0: a hole |
//! | `geometry_thin_walled` | bool | false | glass is a pane without inside |
//! | `geometry_normal`, `geometry_tangent` | texture | | shading normal and tangent of the base, as in `normal_map` |
//! | `geometry_coat_normal`, `geometry_coat_tangent` | texture | | those of the coat |
//! | `emission_luminance`, `emission_color` | texture | 0, 1 | radiance that the base sends out |
//!
//! Glass with a depth and bodies that scatter are filled (see [`Interior`](super::Interior)): light is absorbed on its way and walks at
//! random; the shape should be closed. The boundary of a scattering body spreads light that leaves, as that of
//! [`subsurface`](super::subsurface) with a `diffuse` exit, and its colour is what diffuse light shows of a flat body, with the
//! boundary taken into account (the specification's own formula leaves it out). A thin-walled body scatters half of the
//! light back and half through, by anisotropy.
//!
//! Shapes of a material with an `emission_luminance` are area lights, by one unit of radiance a nit of white; coat and fuzz keep
//! some of it, more at grazing angles. Their outer side shines, and both of a thin-walled one, which looks the same from
//! either side.
//!
//! *Limits.* Dispersion has three wavelengths, one a colour. A shape's own `emission` hides that of its material. Fuzz is
//! [`sheen`](super::sheen)'s.
//!
//! # References
//! [Andersson et al. 2024] "OpenPBR Surface Specification", version 1.1, Academy Software Foundation.

mod bearing;
mod layers;

use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::{Spectrum, SpectrumRole, SpectrumSource};

use super::directional::AlbedoTable;
use super::half_space::Albedos;
use super::{Bsdf, EmissionContext, Material, MaterialContext, MaterialOps, has_holes};
use crate::{Element, Resolver, Texture, TextureContext, float_texture, spectrum_texture};

use bearing::Bearing;

/// A colour with its weight.
#[derive(Clone, Copy, Debug)]
struct Weighted {
    weight: Id<Texture>,
    color: Id<Texture>,
}

impl Weighted {
    fn color_at(&self, at: &TextureContext<'_>) -> Spectrum {
        at.albedo(self.color)
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
    /// Where the transmitted colour is reached; zero at the surface.
    transmission_depth: f32,
    transmission_scatter: Id<Texture>,
    transmission_g: f32,
    /// Indices of red, green and blue over the middle one.
    dispersion: Option<[f32; 3]>,
    subsurface: Weighted,
    subsurface_radius: Id<Texture>,
    subsurface_radius_scale: Id<Texture>,
    subsurface_g: f32,
    /// What a scattering body gives back; none if no body scatters.
    albedos: Option<Arc<Albedos>>,
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
    /// Luminance and colour of light of its own.
    emission: Weighted,
    shines: bool,
    base_bearing: Bearing,
    coat_bearing: Bearing,
    is_thin_walled: bool,
    /// What the base's and the coat's surface reflect.
    gloss: AlbedoTable,
    coat_gloss: AlbedoTable,
}

const fn doc(name: &'static str, ty: &'static str, default: &'static str, doc: &'static str) -> ParamDoc {
    ParamDoc { name, ty, default, doc }
}

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
        doc("transmission_depth", "float", "0", "where light has that colour; 0: the surface is coloured"),
        doc("transmission_scatter", "texture", "0", "cloudiness of glass with a depth"),
        doc("transmission_scatter_anisotropy", "float", "0", "its mean cosine"),
        doc("transmission_dispersion_scale", "float", "0", "how much of the spread of colours there is"),
        doc("transmission_dispersion_abbe_number", "float", "20", "small numbers spread colours widely"),
        doc("subsurface_weight", "texture", "0", "from matte to subsurface scattering"),
        doc("subsurface_color", "texture", "0.8", "the colour that it is seen in"),
        doc("subsurface_radius", "texture", "1", "mean free path inside"),
        doc("subsurface_radius_scale", "texture", "1, 0.5, 0.25", "factor on it by colour"),
        doc("subsurface_scatter_anisotropy", "float", "0", "mean cosine of scattering inside"),
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
        doc("emission_luminance", "texture", "0", "radiance that the base sends out"),
        doc("emission_color", "texture", "1", "its colour"),
        doc("geometry_normal", "texture", "", "shading normal of base and fuzz, [-1, 1] as [0, 1]"),
        doc("geometry_tangent", "texture", "", "tangent of the base's highlights, likewise"),
        doc("geometry_coat_normal", "texture", "", "shading normal of the coat, likewise"),
        doc("geometry_coat_tangent", "texture", "", "tangent of the coat's highlights, likewise"),
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let emission = Weighted {
            weight: float_texture(params, resolver, "emission_luminance", 0.0)?,
            color: spectrum_texture(params, resolver, "emission_color", 1.0, SpectrumRole::Illuminant)?,
        };
        let luminance = resolver.textures()[emission.weight].mean(resolver.textures());
        let base_bearing = Bearing::from_params(params, resolver, ["geometry_normal", "geometry_tangent"])?;
        let coat_bearing =
            Bearing::from_params(params, resolver, ["geometry_coat_normal", "geometry_coat_tangent"])?;
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
        let subsurface_radius =
            spectrum_texture(params, resolver, "subsurface_radius", 1.0, SpectrumRole::Unbounded)?;
        let subsurface_radius_scale = match params.has("subsurface_radius_scale") {
            true => {
                spectrum_texture(params, resolver, "subsurface_radius_scale", 1.0, SpectrumRole::Unbounded)?
            }
            false => resolver.constant(&SpectrumSource::Rgb([1.0, 0.5, 0.25]), SpectrumRole::Unbounded),
        };
        let transmission_scatter =
            spectrum_texture(params, resolver, "transmission_scatter", 0.0, SpectrumRole::Unbounded)?;
        let has_subsurface = params.has("subsurface_weight");
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
            transmission_depth: params.float_in("transmission_depth", 0.0, 0.0, 1e30)?,
            transmission_scatter,
            transmission_g: params.float_in("transmission_scatter_anisotropy", 0.0, -0.99, 0.99)?,
            dispersion: dispersion(params, specular_ior)?,
            subsurface: weighted(params, "subsurface", 0.0, 0.8)?,
            subsurface_radius,
            subsurface_radius_scale,
            subsurface_g: params.float_in("subsurface_scatter_anisotropy", 0.0, -0.99, 0.99)?,
            albedos: has_subsurface.then(|| Arc::new(Albedos::new(specular_ior))),
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
            emission,
            shines: luminance.max_element() > 0.0,
            base_bearing,
            coat_bearing,
            gloss: AlbedoTable::gloss(specular_ior),
            coat_gloss: AlbedoTable::gloss(coat_ior),
        })
    }
}

/// The indices of red, green and blue over that of the yellow D line, by Cauchy's law and Abbe's number.
///
/// # Maths
/// n(λ) = A + B / λ², where V = (n(D) - 1) / (n(F) - n(C)) gives B; red, green and blue are at 611, 549 and 464 nm, the centres of
/// Rec. 709's primaries.
fn dispersion(params: &mut Params, ior: f32) -> Result<Option<[f32; 3]>, SceneError> {
    let scale = params.float_in("transmission_dispersion_scale", 0.0, 0.0, 1e3)?;
    let abbe = params.float_in("transmission_dispersion_abbe_number", 20.0, 1e-3, 1e6)?;
    if scale == 0.0 {
        return Ok(None);
    }
    // Wavelengths of Fraunhofer's lines d, F and C in nanometres.
    let [d, f, c] = [587.56_f32, 486.13, 656.27].map(|lambda| lambda.powi(-2));
    let b = (ior - 1.0) * scale / (abbe * (f - c));
    let index = |lambda: f32| (ior + b * (lambda.powi(-2) - d)).clamp(1.0, 5.0);
    Ok(Some([611.0, 549.0, 464.0].map(|lambda| index(lambda) / ior)))
}

impl MaterialOps for OpenPbr {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        if self.is_thin_walled && at.wo.dot(at.frame.n) < 0.0 {
            // A sheet is the same from behind.
            let behind = MaterialContext { frame: at.frame.flipped(), ng: -at.ng, ..*at };
            layers::evaluate(self, &behind, weight, out);
        } else {
            layers::evaluate(self, at, weight, out);
        }
    }

    fn shines(&self, _: &Arena<Material>) -> bool {
        self.shines
    }

    fn is_see_through(&self, _: &Arena<Material>, textures: &Arena<Texture>) -> bool {
        has_holes(self.opacity, textures)
    }

    fn emitted(&self, at: &EmissionContext<'_>) -> Spectrum {
        layers::emitted(self, at)
    }
}
