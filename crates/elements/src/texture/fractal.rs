//! `fractal`: sums of noise in space: clouds, wrinkles, wind on water.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `pattern` | string | fbm | `fbm` (clouds), `wrinkled` (their absolute values), `windy` (waves, weaker in places) |
//! | `octaves` | int | 8 | how many layers (`windy` has its own) |
//! | `roughness` | float | 0.5 | how strong each layer is beside the one before |
//! | `texture_from_world` | transform | identity | |
//!
//! As the textures `fbm`, `wrinkled` and `windy` of pbrt; without their fading of what is finer than a pixel.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Point3, Transform};
use aureole_spectrum::Spectrum;

use super::mapping::TEXTURE_FROM_WORLD;
use super::noise::Octaves;
use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pattern {
    Fbm,
    Wrinkled,
    Windy,
}

/// Sums of noise.
#[derive(Clone, Debug)]
pub struct Fractal {
    pattern: Pattern,
    octaves: Octaves,
    texture_from_world: Transform,
}

impl Element for Fractal {
    const SUMMARY: &'static str = "Sums of noise in space: clouds, wrinkles, wind on water.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "pattern", ty: "string", default: "fbm", doc: "`fbm`, `wrinkled` or `windy`" },
        ParamDoc { name: "octaves", ty: "int", default: "8", doc: "how many layers" },
        ParamDoc { name: "roughness", ty: "float", default: "0.5", doc: "of each layer in the one before" },
        TEXTURE_FROM_WORLD,
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            pattern: params.one_of(
                "pattern",
                &[("fbm", Pattern::Fbm), ("wrinkled", Pattern::Wrinkled), ("windy", Pattern::Windy)],
            )?,
            octaves: octaves(params)?,
            texture_from_world: params.transform("texture_from_world")?,
        })
    }
}

/// The parameters `octaves` and `roughness`.
pub(super) fn octaves(params: &mut Params) -> Result<Octaves, SceneError> {
    Ok(Octaves {
        count: params.int_in("octaves", 8, 0, 64)? as u32,
        roughness: params.float_in("roughness", 0.5, 0.0, 1.0)?,
    })
}

impl TextureOps for Fractal {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        Spectrum::splat(self.eval_float(at))
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        let p = self.texture_from_world.point(at.p);
        match self.pattern {
            Pattern::Fbm => self.octaves.fbm(p),
            Pattern::Wrinkled => self.octaves.turbulence(p),
            Pattern::Windy => {
                let half = |count| Octaves { count, roughness: 0.5 };
                let wind = half(3).fbm(Point3::new(0.1 * p.x, 0.1 * p.y, 0.1 * p.z));
                wind.abs() * half(6).fbm(p)
            }
        }
    }

    fn mean(&self, _: &Arena<Texture>) -> Spectrum {
        // The mean absolute value of noise is about 0.2.
        let weights: f32 = (0..self.octaves.count).map(|i| self.octaves.roughness.powi(i as i32)).sum();
        Spectrum::splat(if self.pattern == Pattern::Wrinkled { 0.2 * weights } else { 0.0 })
    }
}
