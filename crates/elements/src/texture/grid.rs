//! `grid`: values on a regular grid in space, interpolated.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `values` | floats | | channel fastest, then x, y, z |
//! | `resolution` | ints | | cells along x, y, z |
//! | `channels` | int | 1 | 1 (a number) or 3 (a colour) |
//! | `filter` | string | trilinear | `trilinear` or `nearest` |
//! | `wrap` | string | clamp | beyond the unit cube: `clamp`, `repeat` or `mirror` |
//! | `texture_from_world` | transform | identity | the grid fills the unit cube of the texture's space |

use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Arena, Transform};
use aureole_spectrum::Spectrum;

use super::mapping::TEXTURE_FROM_WORLD;
use super::wrap::Wrap;
use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Filter {
    Trilinear,
    Nearest,
}

/// Values in space.
#[derive(Clone, Debug)]
pub struct Grid {
    values: Arc<[f32]>,
    resolution: [i64; 3],
    channels: usize,
    filter: Filter,
    wrap: Wrap,
    texture_from_world: Transform,
}

impl Element for Grid {
    const SUMMARY: &'static str = "Values on a regular grid in space, interpolated.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "values", ty: "floats", default: "", doc: "channel fastest, then x, y, z" },
        ParamDoc { name: "resolution", ty: "ints", default: "", doc: "cells along x, y, z" },
        ParamDoc { name: "channels", ty: "int", default: "1", doc: "1 or 3" },
        ParamDoc { name: "filter", ty: "string", default: "trilinear", doc: "`trilinear` or `nearest`" },
        ParamDoc { name: "wrap", ty: "string", default: "clamp", doc: "`clamp`, `repeat` or `mirror`" },
        TEXTURE_FROM_WORLD,
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let values = params.try_floats("values")?.unwrap_or_default();
        let at = params.span("resolution");
        let resolution: Vec<i64> =
            params.try_ints("resolution")?.unwrap_or_default().iter().map(|&n| i64::from(n)).collect();
        let channels = params.int_in("channels", 1, 1, 4)? as usize;
        let wrong = || {
            let message = "a grid needs `resolution` of three counts and as many `values`";
            SceneError::invalid(message, if at.is_none() { Span::NONE } else { at })
        };
        let resolution: [i64; 3] = resolution.try_into().map_err(|_| wrong())?;
        let count = resolution.iter().try_fold(channels as i64, |product, &n| product.checked_mul(n));
        if resolution.iter().any(|&n| n < 1) || count != Some(values.len() as i64) {
            return Err(wrong());
        }
        Ok(Self {
            values,
            resolution,
            channels,
            filter: params
                .one_of("filter", &[("trilinear", Filter::Trilinear), ("nearest", Filter::Nearest)])?,
            wrap: params.one_of(
                "wrap",
                &[("clamp", Wrap::Clamp), ("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror)],
            )?,
            texture_from_world: params.transform("texture_from_world")?,
        })
    }
}

impl Grid {
    fn cell(&self, place: [i64; 3]) -> [f32; 3] {
        let index = |axis: usize| self.wrap.index(place[axis], self.resolution[axis]);
        let (Some(x), Some(y), Some(z)) = (index(0), index(1), index(2)) else { return [0.0; 3] };
        let [nx, ny] = [self.resolution[0] as usize, self.resolution[1] as usize];
        let first = ((z * ny + y) * nx + x) * self.channels;
        std::array::from_fn(|c| self.values[first + c.min(self.channels - 1)])
    }

    fn lookup(&self, at: &TextureContext<'_>) -> [f32; 3] {
        let p = self.texture_from_world.point(at.p);
        let clip = |x: f32| if x.is_finite() { x.clamp(-1e6, 1e6) } else { 0.0 };
        let place: [f32; 3] = std::array::from_fn(|i| clip([p.x, p.y, p.z][i]) * self.resolution[i] as f32);
        if self.filter == Filter::Nearest {
            return self.cell(place.map(|x| x.floor() as i64));
        }
        // Values stand in the middles of their cells.
        let place = place.map(|x| x - 0.5);
        let low = place.map(f32::floor);
        let mut sum = [0.0; 3];
        for corner in 0..8_usize {
            let offset: [i64; 3] = std::array::from_fn(|i| ((corner >> i) & 1) as i64);
            let weight: f32 = (0..3)
                .map(|i| {
                    let t = place[i] - low[i];
                    if offset[i] == 1 { t } else { 1.0 - t }
                })
                .product();
            let value = self.cell(std::array::from_fn(|i| low[i] as i64 + offset[i]));
            sum = std::array::from_fn(|c| sum[c] + weight * value[c]);
        }
        sum
    }
}

impl TextureOps for Grid {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        Spectrum::from_rgb(self.lookup(at))
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        let value = self.lookup(at);
        if self.channels < 3 { value[0] } else { aureole_spectrum::luminance(value) }
    }

    fn mean(&self, _: &Arena<Texture>) -> Spectrum {
        let n = (self.values.len() / self.channels).max(1) as f32;
        let sum = |c: usize| {
            let channel = self.values.iter().skip(c.min(self.channels - 1)).step_by(self.channels);
            channel.map(|&x| f64::from(x)).sum::<f64>() as f32
        };
        Spectrum::from_rgb(std::array::from_fn(|c| sum(c) / n))
    }
}
