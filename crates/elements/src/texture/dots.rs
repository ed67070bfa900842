//! `dots`: round dots in some of the squares of a grid, a little out of their middles.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `inside` | texture | 1 | within a dot |
//! | `outside` | texture | 0 | elsewhere |
//! | `mapping`, `texture_from_world`, `to_uv` | | uv | see `bitmap`; squares are one unit wide |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Point3};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::mapping::{MAPPING, Mapping, TEXTURE_FROM_WORLD, TO_UV};
use super::noise::noise;
use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver, spectrum_texture};

/// Dots.
#[derive(Clone, Debug)]
pub struct Dots {
    inside: Id<Texture>,
    outside: Id<Texture>,
    mapping: Mapping,
}

impl Element for Dots {
    const SUMMARY: &'static str = "Round dots in some of the squares of a grid.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "inside", ty: "texture", default: "1", doc: "within a dot" },
        ParamDoc { name: "outside", ty: "texture", default: "0", doc: "elsewhere" },
        MAPPING,
        TEXTURE_FROM_WORLD,
        TO_UV,
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            inside: spectrum_texture(params, resolver, "inside", 1.0, SpectrumRole::Unbounded)?,
            outside: spectrum_texture(params, resolver, "outside", 0.0, SpectrumRole::Unbounded)?,
            mapping: Mapping::from_params(params)?,
        })
    }
}

impl Dots {
    fn pick(&self, at: &TextureContext<'_>) -> Id<Texture> {
        const RADIUS: f32 = 0.35;
        const SHIFT: f32 = 0.5 - RADIUS;
        let p = self.mapping.apply(at);
        let (s, t) = ((p.x + 0.5).floor(), (p.y + 0.5).floor());
        let random = |ds: f32, dt: f32| noise(Point3::new(s + ds, t + dt, 0.5));
        if random(0.5, 0.5) <= 0.0 {
            return self.outside;
        }
        let (x, y) = (p.x - s - SHIFT * random(1.5, 2.8), p.y - t - SHIFT * random(4.5, 9.8));
        if x * x + y * y < RADIUS * RADIUS { self.inside } else { self.outside }
    }
}

impl TextureOps for Dots {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.pick(at))
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        at.float(self.pick(at))
    }

    fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        // About half of the squares have a dot of 38 % of their area.
        textures[self.outside].mean(textures).lerp(textures[self.inside].mean(textures), 0.19)
    }
}
