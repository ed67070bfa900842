//! `projector`: throws a picture from one point, as a slide projector does, along +Z of its space.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `irradiance` | texture | 1 | the slide: irradiance on a plane at distance one that faces the projector |
//! | `measure` | string | irradiance | `irradiance`, or `intensity`: the slide says W/sr |
//! | `scale` | float | 1 | factor |
//! | `power` | float | 0 | if positive: scale to this power, W |
//! | `fov` | float | 45 | angle of view along `fov_axis`, degrees |
//! | `fov_axis` | string | x | `x`, `y`, `diagonal`, `smaller` or `larger` side of the slide |
//! | `flip_v` | bool | false | hang the slide upside down |
//! | `world_from_light` | transform | identity | |

use std::sync::OnceLock;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Id, Point2, Point3, Transform, Vector3};
use aureole_spectrum::{SpectrumRole, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::camera::FovAxis;
use crate::{Element, Resolver, Texture, TextureContext, spectrum_texture};

/// A slide projector.
#[derive(Clone, Debug)]
pub struct Projector {
    light_from_world: Transform,
    position: Point3,
    axis: Vector3,
    slide: Id<Texture>,
    is_intensity: bool,
    scale: f32,
    /// The power to scale to, if positive.
    target: f32,
    /// The factor that does it, once the slide can be asked.
    strength: OnceLock<f32>,
    fov: f32,
    fov_axis: FovAxis,
    flip_v: bool,
}

impl Element for Projector {
    const SUMMARY: &'static str = "Throws a picture from one point, as a slide projector does.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "irradiance", ty: "texture", default: "1", doc: "the slide" },
        ParamDoc {
            name: "measure",
            ty: "string",
            default: "irradiance",
            doc: "what the slide says: `irradiance` or `intensity`",
        },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor" },
        ParamDoc { name: "power", ty: "float", default: "0", doc: "if positive: scale to this power, W" },
        ParamDoc { name: "fov", ty: "float", default: "45", doc: "angle of view along `fov_axis`, degrees" },
        ParamDoc {
            name: "fov_axis",
            ty: "string",
            default: "x",
            doc: "`x`, `y`, `diagonal`, `smaller` or `larger`",
        },
        ParamDoc { name: "flip_v", ty: "bool", default: "false", doc: "hang the slide upside down" },
        ParamDoc {
            name: "world_from_light",
            ty: "transform",
            default: "identity",
            doc: "where the projector is",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let place = params.transform("world_from_light")?;
        Ok(Self {
            light_from_world: place.inverse(),
            position: place.point(Point3::ORIGIN),
            axis: place.vector(Vector3::Z).normalized(),
            slide: spectrum_texture(params, resolver, "irradiance", 1.0, SpectrumRole::Illuminant)?,
            is_intensity: params.one_of("measure", &[("irradiance", false), ("intensity", true)])?,
            scale: params.float("scale", 1.0)?,
            target: params.float("power", 0.0)?,
            strength: OnceLock::new(),
            fov: params.float_in("fov", 45.0, 1e-3, 179.9)?.to_radians(),
            fov_axis: FovAxis::from_params(params)?,
            flip_v: params.bool("flip_v", false)?,
        })
    }
}

impl Projector {
    /// Half the slide's width and height at distance one.
    fn half_size(&self, at: &LightContext<'_>) -> [f32; 2] {
        let aspect = at.textures[self.slide].resolution().map_or(1.0, |[w, h]| w as f32 / h as f32);
        let half_width = (0.5 * self.fov_axis.horizontal(self.fov, aspect)).tan();
        [half_width, half_width / aspect]
    }
}

impl Projector {
    /// The flux through the slide, by a grid over it.
    fn unscaled_power(&self, at: &LightContext<'_>) -> f32 {
        const N: usize = 128;
        let [w, h] = self.half_size(at);
        let cell = |i: usize| {
            let uv = Point2::new(((i % N) as f32 + 0.5) / N as f32, ((i / N) as f32 + 0.5) / N as f32);
            let (x, y) = ((2.0 * uv.x - 1.0) * w, (2.0 * uv.y - 1.0) * h);
            let cos = 1.0 / (1.0 + x * x + y * y).sqrt();
            let share = if self.is_intensity { cos * cos * cos } else { 1.0 };
            let slide = TextureContext::at_uv(at.textures, at.wavelengths, uv).spectrum(self.slide);
            f64::from(luminance(slide.rgb()) * share)
        };
        ((0..N * N).map(cell).sum::<f64>() / (N * N) as f64) as f32 * 4.0 * w * h
    }

    /// The factor of the slide.
    fn strength(&self, at: &LightContext<'_>) -> f32 {
        if self.target <= 0.0 {
            return self.scale;
        }
        *self.strength.get_or_init(|| self.target / self.unscaled_power(at).max(f32::MIN_POSITIVE))
    }
}

impl LightOps for Projector {
    fn sample(&self, at: &LightContext<'_>, reference: Point3, _: Point2) -> Option<LightSample> {
        let local = self.light_from_world.point(reference);
        let wi = (self.position - reference).try_normalized()?;
        if local.z <= 0.0 {
            return None;
        }
        let [half_width, half_height] = self.half_size(at);
        // +X of the projector is the left of its picture, as for cameras.
        let u = 0.5 - 0.5 * local.x / (local.z * half_width);
        let v = 0.5 + 0.5 * local.y / (local.z * half_height);
        if !(0.0..=1.0).contains(&u) || !(0.0..=1.0).contains(&v) {
            return None;
        }
        let v = if self.flip_v { 1.0 - v } else { v };
        let slide =
            TextureContext::at_uv(at.textures, at.wavelengths, Point2::new(u, v)).spectrum(self.slide);
        // Irradiance is on the plane at distance one: intensity over cos³.
        let cos = -self.axis.dot(wi);
        let spread = if self.is_intensity { cos * cos } else { 1.0 / cos };
        let radiance = slide * (self.strength(at) * spread / (local.z * local.z));
        (!radiance.is_black()).then_some(LightSample {
            wi,
            target: Some(self.position),
            radiance,
            pdf_omega: 1.0,
            is_delta: true,
        })
    }

    fn power(&self, at: &LightContext<'_>, _: &Bounds3) -> f32 {
        if self.target > 0.0 { self.target } else { self.scale * self.unscaled_power(at) }
    }
}
