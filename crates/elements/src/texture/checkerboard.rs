//! `checkerboard`: squares of half a uv unit, or cubes of half a unit in space, in two textures.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `color0` | texture | 0.4 | where both coordinates' halves agree |
//! | `color1` | texture | 0.2 | elsewhere |
//! | `dimension` | int | 2 | 2 (squares) or 3 (cubes in space) |
//! | `mapping`, `texture_from_world` | | uv | see `bitmap` |
//! | `to_uv` | transform | identity | of squares: applied to the mapped coordinates; one unit holds two squares |
//! | `swap_numbers` | bool | false | where a number is wanted, exchange the two: Mitsuba's checkerboards do |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Transform, Vector2};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::mapping::{MAPPING, Mapping, TEXTURE_FROM_WORLD, TO_UV};
use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver, spectrum_texture};

/// What is cut into squares or cubes.
#[derive(Clone, Copy, Debug)]
enum Place {
    Plane(Mapping),
    Space(Transform),
}

/// Two textures in squares.
#[derive(Clone, Debug)]
pub struct Checkerboard {
    colors: [Id<Texture>; 2],
    place: Place,
    swap_numbers: bool,
}

impl Checkerboard {
    /// Which of the two is at a point.
    #[inline]
    fn pick(&self, at: &TextureContext<'_>) -> usize {
        let half = |x: f32| x - x.floor() > 0.5;
        match &self.place {
            Place::Plane(mapping) => {
                let p = mapping.apply(at);
                usize::from(half(p.x) != half(p.y))
            }
            Place::Space(texture_from_world) => {
                let p = texture_from_world.point(at.p);
                usize::from(half(p.x) != half(p.y)) ^ usize::from(half(p.z))
            }
        }
    }

    /// The texture that gives the number at a point.
    #[inline]
    fn number(&self, at: &TextureContext<'_>) -> Id<Texture> {
        self.colors[self.pick(at) ^ usize::from(self.swap_numbers)]
    }
}

impl Element for Checkerboard {
    const SUMMARY: &'static str = "Squares of half a uv unit, in two textures.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "color0",
            ty: "texture",
            default: "0.4",
            doc: "where both coordinates' halves agree",
        },
        ParamDoc { name: "color1", ty: "texture", default: "0.2", doc: "elsewhere" },
        ParamDoc { name: "dimension", ty: "int", default: "2", doc: "2 (squares) or 3 (cubes in space)" },
        MAPPING,
        TEXTURE_FROM_WORLD,
        TO_UV,
        ParamDoc {
            name: "swap_numbers",
            ty: "bool",
            default: "false",
            doc: "exchange the two where a number is wanted",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            colors: [
                spectrum_texture(params, resolver, "color0", 0.4, SpectrumRole::Albedo)?,
                spectrum_texture(params, resolver, "color1", 0.2, SpectrumRole::Albedo)?,
            ],
            place: match params.int_in("dimension", 2, 2, 3)? {
                3 => Place::Space(params.transform("texture_from_world")?),
                _ => Place::Plane(Mapping::from_params(params)?),
            },
            swap_numbers: params.bool("swap_numbers", false)?,
        })
    }
}

impl TextureOps for Checkerboard {
    #[inline]
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.colors[self.pick(at)])
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        at.float(self.number(at))
    }

    fn gradient(&self, at: &TextureContext<'_>) -> Vector2 {
        at.gradient(self.number(at))
    }

    fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        (textures[self.colors[0]].mean(textures) + textures[self.colors[1]].mean(textures)) * 0.5
    }
}
