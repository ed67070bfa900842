//! `area`: a surface that shines, the same in all directions of its outer side.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radiance` | texture | 1 | emitted radiance, over the shape's uv |
//! | `two_sided` | bool | false | shine on the inner side as well |
//! | `power` | float | 0 | if positive: scale to this power of the whole shape, W |
//!
//! It is given to a shape as `emission`.

use std::f32::consts::PI;
use std::sync::OnceLock;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Id, Point2, Point3, Vector3, offset_ray_origin};
use aureole_spectrum::{Spectrum, SpectrumRole, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver, Shape, SurfacePoint, Texture, TextureContext, spectrum_texture};

/// A shining surface.
#[derive(Clone, Debug)]
pub struct Area {
    shape: Id<Shape>,
    radiance: Id<Texture>,
    two_sided: bool,
    /// The power to scale to, if positive.
    power: f32,
    /// The factor that does it, once its shape and texture can be asked.
    scale: OnceLock<f32>,
}

impl Element for Area {
    const SUMMARY: &'static str = "A surface that shines; given to a shape as `emission`.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "radiance",
            ty: "texture",
            default: "1",
            doc: "emitted radiance, over the shape's uv",
        },
        ParamDoc { name: "two_sided", ty: "bool", default: "false", doc: "shine on the inner side as well" },
        ParamDoc { name: "power", ty: "float", default: "0", doc: "if positive: scale to this power, W" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let shape = resolver.emitting_shape().ok_or_else(|| {
            SceneError::invalid("an `area` light belongs to a shape, as its `emission`", Span::NONE)
        })?;
        let radiance = spectrum_texture(params, resolver, "radiance", 1.0, SpectrumRole::Illuminant)?;
        Ok(Self {
            shape,
            radiance,
            two_sided: params.bool("two_sided", false)?,
            power: params.float("power", 0.0)?,
            scale: OnceLock::new(),
        })
    }
}

impl Area {
    #[inline]
    fn radiance(&self, at: &LightContext<'_>, uv: Point2, cos: f32) -> Spectrum {
        if cos > 0.0 || self.two_sided {
            let radiance = TextureContext::at_uv(at.textures, at.wavelengths, uv).spectrum(self.radiance);
            if self.power > 0.0 { radiance * self.scale(at) } else { radiance }
        } else {
            Spectrum::ZERO
        }
    }
}

impl Area {
    fn unscaled_power(&self, at: &LightContext<'_>) -> f32 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        let mean = at.textures[self.radiance].mean(at.textures);
        luminance(mean.rgb()) * at.shapes[self.shape].area() * PI * sides
    }

    fn scale(&self, at: &LightContext<'_>) -> f32 {
        *self.scale.get_or_init(|| self.power / self.unscaled_power(at).max(f32::MIN_POSITIVE))
    }
}

impl LightOps for Area {
    #[inline]
    fn sample(&self, at: &LightContext<'_>, reference: Point3, u: Point2) -> Option<LightSample> {
        let drawn = at.shapes[self.shape].sample_towards(reference, u)?;
        let wi = (drawn.p - reference).try_normalized()?;
        let radiance = self.radiance(at, drawn.uv, -drawn.ng.dot(wi));
        let target = offset_ray_origin(drawn.p, drawn.error, drawn.ng, -wi);
        (!radiance.is_black()).then_some(LightSample {
            wi,
            target: Some(target),
            radiance,
            pdf_omega: drawn.pdf,
            is_delta: false,
        })
    }

    #[inline]
    fn pdf_omega(
        &self,
        at: &LightContext<'_>,
        reference: Point3,
        wi: Vector3,
        surface: Option<&SurfacePoint>,
    ) -> f32 {
        surface.map_or(0.0, |surface| at.shapes[self.shape].pdf_towards(reference, wi, surface))
    }

    #[inline]
    fn emitted(&self, at: &LightContext<'_>, surface: &SurfacePoint, w: Vector3) -> Spectrum {
        self.radiance(at, surface.uv, surface.ng.dot(w))
    }

    fn power(&self, at: &LightContext<'_>, _: &Bounds3) -> f32 {
        if self.power > 0.0 { self.power } else { self.unscaled_power(at) }
    }
}
