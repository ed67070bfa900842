//! `hair`: a fibre of hair or fur, to be put on curves.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `sigma_a` | texture | | absorption inside, per radius of the fibre |
//! | `scale` | float | 1 | factor on `sigma_a` |
//! | `reflectance` | texture | | instead: the colour that a head of hair shall have |
//! | `eumelanin`, `pheomelanin` | texture | 1.3, 0 | instead: concentrations of the brown and the red pigment |
//! | `eta` | texture | 1.55 | index of refraction |
//! | `int_ior`, `ext_ior` | float or name | amber, air | instead: indices inside and outside |
//! | `beta_m`, `beta_n` | texture | 0.3 | roughness along and around the fibre, in [0, 1] |
//! | `alpha` | texture | 2 | tilt of the scales in degrees |
//! | `offset` | string | uv | where a ray meets the fibre: `uv`: from v = 0 to 1 across it; `normal`: by the shading normal, for round tubes |
//!
//! The fibre runs along the derivative of position by u, and with `offset` = `normal`, for tubes whose u goes around, across it,
//! as in Mitsuba. The direct reflection, the paths that leave after one and two
//! passages, and all others together are four lobes.
//!
//! # References
//! - [Chiang et al. 2016] "A Practical and Controllable Hair and Fur Model for Production Path Tracing".
//! - [Pharr 2016] "The Implementation of a Hair Scattering Model".
//! - [d'Eon et al. 2011] "An Energy-Conserving Hair Reflectance Model": the longitudinal term and pigments.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Frame, Id};
use aureole_spectrum::{Spectrum, SpectrumRole, SpectrumSource};

use super::dielectric::relative_ior;
use super::hair_lobe::{Fibre, HairLobe};
use super::{Bsdf, MaterialContext, MaterialOps};
use crate::{Element, Resolver, Texture, TextureContext, float_texture, spectrum_texture};

/// Absorption of eumelanin at concentration one [Pharr 2016].
const EUMELANIN: [f32; 3] = [0.419, 0.697, 1.37];
/// Absorption of pheomelanin at concentration one.
const PHEOMELANIN: [f32; 3] = [0.187, 0.4, 1.05];

/// What colours hair.
#[derive(Clone, Copy, Debug)]
enum Colour {
    Absorption(Id<Texture>, f32),
    Reflectance(Id<Texture>),
    Pigments(Id<Texture>, Id<Texture>),
}

/// How the place across the fibre is known.
#[derive(Clone, Copy, Debug)]
enum Offset {
    Uv,
    Normal,
}

/// A fibre.
#[derive(Clone, Copy, Debug)]
pub struct Hair {
    colour: Colour,
    eta: Id<Texture>,
    beta_m: Id<Texture>,
    beta_n: Id<Texture>,
    alpha: Id<Texture>,
    offset: Offset,
}

impl Element for Hair {
    const SUMMARY: &'static str = "A fibre of hair or fur, to be put on curves.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "sigma_a", ty: "texture", default: "", doc: "absorption inside, per radius" },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor on `sigma_a`" },
        ParamDoc {
            name: "reflectance",
            ty: "texture",
            default: "",
            doc: "instead: the colour of many hairs",
        },
        ParamDoc { name: "eumelanin", ty: "texture", default: "1.3", doc: "instead: brown pigment" },
        ParamDoc { name: "pheomelanin", ty: "texture", default: "0", doc: "red pigment" },
        ParamDoc { name: "eta", ty: "texture", default: "1.55", doc: "index of refraction" },
        ParamDoc { name: "int_ior", ty: "float or name", default: "amber", doc: "instead: index inside" },
        ParamDoc { name: "ext_ior", ty: "float or name", default: "air", doc: "instead: index outside" },
        ParamDoc { name: "beta_m", ty: "texture", default: "0.3", doc: "roughness along the fibre" },
        ParamDoc { name: "beta_n", ty: "texture", default: "0.3", doc: "roughness around it" },
        ParamDoc { name: "alpha", ty: "texture", default: "2", doc: "tilt of the scales in degrees" },
        ParamDoc {
            name: "offset",
            ty: "string",
            default: "uv",
            doc: "place across the fibre by `uv` or `normal`",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let scale = params.float("scale", 1.0)?;
        let has_pigments = params.has("eumelanin") || params.has("pheomelanin");
        let colour = if params.has("sigma_a") {
            let texture = spectrum_texture(params, resolver, "sigma_a", 0.0, SpectrumRole::Unbounded)?;
            Colour::Absorption(texture, scale)
        } else if params.has("reflectance") {
            Colour::Reflectance(spectrum_texture(params, resolver, "reflectance", 0.5, SpectrumRole::Albedo)?)
        } else {
            let brown = if has_pigments { 0.0 } else { 1.3 };
            let eumelanin = float_texture(params, resolver, "eumelanin", brown)?;
            Colour::Pigments(eumelanin, float_texture(params, resolver, "pheomelanin", 0.0)?)
        };
        let eta = if params.has("int_ior") || params.has("ext_ior") {
            let eta = SpectrumSource::Uniform(relative_ior(params, "amber")?);
            resolver.constant(&eta, SpectrumRole::Unbounded)
        } else {
            float_texture(params, resolver, "eta", 1.55)?
        };
        let mut float = |name, default| float_texture(params, resolver, name, default);
        let alpha = float("alpha", 2.0)?;
        let (beta_m, beta_n) = (float("beta_m", 0.3)?, float("beta_n", 0.3)?);
        let offset = params.one_of("offset", &[("uv", Offset::Uv), ("normal", Offset::Normal)])?;
        Ok(Self { colour, eta, beta_m, beta_n, alpha, offset })
    }
}

/// The absorption of single fibres that gives many of them a colour [Chiang et al. 2016, equation 9].
fn absorption_of_colour(colour: Spectrum, beta_n: f32) -> Spectrum {
    let b = beta_n;
    let denominator = 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
    colour.map(|c| (c.clamp(1e-4, 1.0).ln() / denominator).powi(2))
}

impl Hair {
    fn absorption(&self, at: &TextureContext<'_>, beta_n: f32) -> Spectrum {
        match self.colour {
            Colour::Absorption(sigma_a, scale) => at.spectrum(sigma_a) * scale,
            Colour::Reflectance(colour) => absorption_of_colour(at.spectrum(colour), beta_n),
            Colour::Pigments(brown, red) => {
                Spectrum::from_rgb(EUMELANIN) * at.float(brown)
                    + Spectrum::from_rgb(PHEOMELANIN) * at.float(red)
            }
        }
        .max_zero()
    }
}

impl MaterialOps for Hair {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let texture = &at.texture;
        let along_u = Frame::from_normal_and_tangent(at.frame.n, at.dp_du);
        let (frame, gamma) = match self.offset {
            Offset::Uv => (along_u, (2.0 * texture.uv.y - 1.0).clamp(-0.9999, 0.9999).asin()),
            Offset::Normal => {
                // Round tubes have u around them.
                let frame = Frame::from_normal_and_tangent(along_u.n, along_u.t);
                let wo = frame.to_local(at.wo);
                (frame, (-wo.y).atan2(wo.z))
            }
        };
        let beta_n = texture.float(self.beta_n).clamp(0.02, 1.0);
        let fibre = Fibre {
            gamma,
            eta: texture.float(self.eta).max(1.0001),
            sigma_a: self.absorption(texture, beta_n),
            beta_m: texture.float(self.beta_m).clamp(0.02, 1.0),
            beta_n,
            alpha: texture.float(self.alpha).to_radians(),
        };
        out.push(HairLobe::new(&fibre), weight, frame, frame.n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_hair_absorbs_nothing_and_dark_hair_much() {
        let sigma = absorption_of_colour(Spectrum::from_rgb([1.0, 0.5, 0.05]), 0.3).rgb();
        assert!(sigma[0] == 0.0 && sigma[1] > 0.0 && sigma[2] > sigma[1], "{sigma:?}");
    }
}
