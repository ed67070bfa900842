//! `spot`: light from one point in a cone around +Z of its space.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `intensity` | spectrum | 1 | radiant intensity in the middle, W/sr |
//! | `cutoff_angle` | float | 20 | half angle of the cone, degrees |
//! | `beam_width` | float | 3/4 cutoff | half angle of full intensity, degrees |
//! | `falloff` | string | linear | between the two: `linear` in the angle, or `smoothstep` in the cosine |
//! | `texture` | texture | 1 | thrown over the square around the cone |
//! | `world_from_light` | transform | identity | |

use std::f32::consts::PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Id, Point2, Point3, Transform, Vector3};
use aureole_spectrum::{PreparedSpectrum, Spectrum, SpectrumRole, Wavelengths, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver, Texture, TextureContext, spectrum_texture};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Falloff {
    Linear,
    Smoothstep,
}

/// A spotlight.
#[derive(Clone, Debug)]
pub struct Spot {
    light_from_world: Transform,
    position: Point3,
    intensity: PreparedSpectrum,
    cutoff: f32,
    beam: f32,
    falloff: Falloff,
    texture: Option<Id<Texture>>,
}

impl Element for Spot {
    const SUMMARY: &'static str = "Light from one point in a cone around +Z.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "intensity",
            ty: "spectrum",
            default: "1",
            doc: "radiant intensity in the middle, W/sr",
        },
        ParamDoc { name: "cutoff_angle", ty: "float", default: "20", doc: "half angle of the cone, degrees" },
        ParamDoc {
            name: "beam_width",
            ty: "float",
            default: "3/4 cutoff",
            doc: "half angle of full intensity, degrees",
        },
        ParamDoc { name: "falloff", ty: "string", default: "linear", doc: "`linear` or `smoothstep`" },
        ParamDoc {
            name: "texture",
            ty: "texture",
            default: "1",
            doc: "thrown over the square around the cone",
        },
        ParamDoc {
            name: "world_from_light",
            ty: "transform",
            default: "identity",
            doc: "where the light is",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let place = params.transform("world_from_light")?;
        let cutoff = params.float_in("cutoff_angle", 20.0, 0.0, 180.0)?;
        let beam = params.float_in("beam_width", cutoff * 0.75, 0.0, 180.0)?.min(cutoff);
        let texture = if params.has("texture") {
            Some(spectrum_texture(params, resolver, "texture", 1.0, SpectrumRole::Albedo)?)
        } else {
            None
        };
        Ok(Self {
            light_from_world: place.inverse(),
            position: place.point(Point3::ORIGIN),
            intensity: params.spectrum("intensity", 1.0)?.prepare(SpectrumRole::Illuminant),
            cutoff: cutoff.to_radians(),
            beam: beam.to_radians(),
            falloff: params
                .one_of("falloff", &[("linear", Falloff::Linear), ("smoothstep", Falloff::Smoothstep)])?,
            texture,
        })
    }
}

impl Spot {
    /// The share of the full intensity in a unit direction of the light's space.
    fn share(&self, at: &LightContext<'_>, w: Vector3) -> Spectrum {
        let cos_cutoff = self.cutoff.cos();
        if w.z <= cos_cutoff {
            return Spectrum::ZERO;
        }
        let cos_beam = self.beam.cos();
        let edge = match self.falloff {
            _ if w.z >= cos_beam => 1.0,
            Falloff::Linear => (self.cutoff - w.z.acos()) / (self.cutoff - self.beam),
            Falloff::Smoothstep => {
                let t = (w.z - cos_cutoff) / (cos_beam - cos_cutoff);
                t * t * (3.0 - 2.0 * t)
            }
        };
        let Some(texture) = self.texture else { return Spectrum::splat(edge) };
        let reach = w.z * self.cutoff.tan();
        let uv = Point2::new(0.5 + 0.5 * w.x / reach, 0.5 + 0.5 * w.y / reach);
        TextureContext::at_uv(at.textures, at.wavelengths, uv).spectrum(texture) * edge
    }
}

impl LightOps for Spot {
    fn sample(&self, at: &LightContext<'_>, reference: Point3, _: Point2) -> Option<LightSample> {
        let d = self.position - reference;
        let d2 = d.length_squared();
        let wi = d.try_normalized()?;
        let share = self.share(at, self.light_from_world.vector(-wi).try_normalized()?);
        (!share.is_black()).then(|| LightSample {
            wi,
            target: Some(self.position),
            radiance: self.intensity.eval(&at.wavelengths) * share / d2,
            pdf_omega: 1.0,
            is_delta: true,
        })
    }

    fn power(&self, at: &LightContext<'_>, _: &Bounds3) -> f32 {
        let mean = self.texture.map_or(Spectrum::ONE, |t| at.textures[t].mean(at.textures));
        let solid_angle = 2.0 * PI * (1.0 - 0.5 * (self.cutoff.cos() + self.beam.cos()));
        luminance((self.intensity.eval(&Wavelengths::RGB) * mean).rgb()) * solid_angle
    }
}
