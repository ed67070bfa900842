//! `projector`: throws a picture from one point, as a slide projector does, along +Z of its space.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `irradiance` | texture | 1 | the slide: irradiance on a plane at distance one that faces the projector |
//! | `scale` | float | 1 | factor |
//! | `fov` | float | 45 | angle of view along `fov_axis`, degrees |
//! | `fov_axis` | string | x | `x`, `y`, `diagonal`, `smaller` or `larger` side of the slide |
//! | `flip_v` | bool | false | hang the slide upside down |
//! | `world_from_light` | transform | identity | |

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
    scale: f32,
    fov: f32,
    fov_axis: FovAxis,
    flip_v: bool,
}

impl Element for Projector {
    const SUMMARY: &'static str = "Throws a picture from one point, as a slide projector does.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "irradiance", ty: "texture", default: "1", doc: "the slide" },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor" },
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
            scale: params.float("scale", 1.0)?,
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
        let radiance = slide * (self.scale / (local.z * local.z * -self.axis.dot(wi)));
        (!radiance.is_black()).then_some(LightSample {
            wi,
            target: Some(self.position),
            radiance,
            pdf_omega: 1.0,
            is_delta: true,
        })
    }

    fn power(&self, at: &LightContext<'_>, _: &Bounds3) -> f32 {
        let [w, h] = self.half_size(at);
        luminance(at.textures[self.slide].mean(at.textures).rgb()) * self.scale * 4.0 * w * h
    }
}
