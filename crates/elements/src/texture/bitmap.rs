//! `bitmap`: a picture.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `filename` | path | | PNG, JPEG, EXR, HDR, TGA, ... |
//! | `filter` | string | bilinear | `bilinear` or `nearest` |
//! | `wrap` | string | repeat | beyond the unit square: `repeat`, `mirror`, `clamp`, `black` |
//! | `encoding` | string | auto | `auto` (by file type), `srgb`, `linear` (raw data), `gamma` |
//! | `gamma` | float | 2.2 | for `encoding` = `gamma` |
//! | `channel` | string | color | what numbers are taken from: `color` or `alpha` |
//! | `mapping` | string | uv | from the surface (`uv`) or from where it is: `spherical`, `cylindrical`, `planar` |
//! | `texture_from_world` | transform | identity | into the texture's space, for the latter |
//! | `to_uv` | transform | identity | applied to the mapped coordinates |
//! | `scale` | float | 1 | factor |
//! | `invert` | bool | false | 1 - value, before `scale` |
//!
//! v = 0 is the bottom of the picture.

use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_image::{Bitmap, Encoding};
use aureole_math::{Arena, Vector2};
use aureole_spectrum::{Spectrum, luminance};

use super::mapping::{MAPPING, Mapping, TEXTURE_FROM_WORLD, TO_UV};
use super::wrap::Wrap;
use super::{Texture, TextureContext, TextureOps, central_difference};
use crate::{Element, Resolver};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Filter {
    Bilinear,
    Nearest,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Color,
    Alpha,
}

/// A picture as a texture.
#[derive(Clone, Debug)]
pub struct BitmapTexture {
    bitmap: Arc<Bitmap>,
    filter: Filter,
    wrap: Wrap,
    channel: Channel,
    mapping: Mapping,
    scale: f32,
    invert: bool,
}

impl BitmapTexture {
    #[inline]
    fn texel(&self, x: i64, y: i64) -> [f32; 3] {
        let b = &self.bitmap;
        match (self.wrap.index(x, b.width() as i64), self.wrap.index(y, b.height() as i64)) {
            (Some(x), Some(y)) => match self.channel {
                Channel::Color => b.rgb(x, y),
                Channel::Alpha => [b.alpha(x, y); 3],
            },
            _ => [0.0; 3],
        }
    }

    /// Continuous texel coordinates: texel centres lie at whole numbers plus one half.
    #[inline]
    fn place(&self, at: &TextureContext<'_>) -> Vector2 {
        let p = self.mapping.apply(at);
        let clip = |x: f32| if x.is_finite() { x.clamp(-1e9, 1e9) } else { 0.0 };
        Vector2::new(clip(p.x) * self.bitmap.width() as f32, (1.0 - clip(p.y)) * self.bitmap.height() as f32)
    }

    #[inline]
    fn lookup(&self, at: &TextureContext<'_>) -> [f32; 3] {
        let p = self.place(at);
        let value = match self.filter {
            Filter::Nearest => self.texel(p.x.floor() as i64, p.y.floor() as i64),
            Filter::Bilinear => {
                let (x, y) = (p.x - 0.5, p.y - 0.5);
                let (x0, y0) = (x.floor(), y.floor());
                let (fx, fy) = (x - x0, y - y0);
                let (x0, y0) = (x0 as i64, y0 as i64);
                let [a, b, c, d] = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.texel(x0 + i, y0 + j));
                std::array::from_fn(|i| {
                    let top = a[i] + (b[i] - a[i]) * fx;
                    let bottom = c[i] + (d[i] - c[i]) * fx;
                    top + (bottom - top) * fy
                })
            }
        };
        value.map(|x| (if self.invert { 1.0 - x } else { x }) * self.scale)
    }
}

impl Element for BitmapTexture {
    const SUMMARY: &'static str = "A picture.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "filename", ty: "path", default: "", doc: "PNG, JPEG, EXR, HDR, TGA, ..." },
        ParamDoc { name: "filter", ty: "string", default: "bilinear", doc: "`bilinear` or `nearest`" },
        ParamDoc {
            name: "wrap",
            ty: "string",
            default: "repeat",
            doc: "`repeat`, `mirror`, `clamp` or `black`",
        },
        ParamDoc {
            name: "encoding",
            ty: "string",
            default: "auto",
            doc: "`auto`, `srgb`, `linear` or `gamma`",
        },
        ParamDoc { name: "gamma", ty: "float", default: "2.2", doc: "for `encoding` = `gamma`" },
        ParamDoc { name: "channel", ty: "string", default: "color", doc: "`color` or `alpha`" },
        MAPPING,
        TEXTURE_FROM_WORLD,
        TO_UV,
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor" },
        ParamDoc { name: "invert", ty: "bool", default: "false", doc: "1 - value, before `scale`" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("filename");
        let path = params.try_path("filename")?.ok_or_else(|| SceneError::MissingParam {
            element: "bitmap".into(),
            param: "filename".into(),
            wanted: "a picture file".into(),
            at: Span::NONE,
        })?;
        let gamma = params.float_in("gamma", 2.2, 0.01, 100.0)?;
        let encoding = params.one_of(
            "encoding",
            &[
                ("auto", Encoding::Auto),
                ("srgb", Encoding::Srgb),
                ("linear", Encoding::Linear),
                ("gamma", Encoding::Gamma(gamma)),
            ],
        )?;
        Ok(Self {
            bitmap: resolver.bitmap(&path, encoding, at)?,
            filter: params
                .one_of("filter", &[("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)])?,
            wrap: params.one_of(
                "wrap",
                &[
                    ("repeat", Wrap::Repeat),
                    ("mirror", Wrap::Mirror),
                    ("clamp", Wrap::Clamp),
                    ("black", Wrap::Black),
                ],
            )?,
            channel: params.one_of("channel", &[("color", Channel::Color), ("alpha", Channel::Alpha)])?,
            mapping: Mapping::from_params(params)?,
            scale: params.float("scale", 1.0)?,
            invert: params.bool("invert", false)?,
        })
    }
}

impl TextureOps for BitmapTexture {
    #[inline]
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        Spectrum::from_rgb(self.lookup(at))
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        let value = self.lookup(at);
        if self.bitmap.channels() < 3 { value[0] } else { luminance(value) }
    }

    /// The exact derivative of the bilinear interpolation.
    fn gradient(&self, at: &TextureContext<'_>) -> Vector2 {
        let p = self.place(at);
        let (x, y) = (p.x - 0.5, p.y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let number = |i: i64, j: i64| {
            let t = self.texel(x0 as i64 + i, y0 as i64 + j);
            if self.bitmap.channels() < 3 { t[0] } else { luminance(t) }
        };
        let (a, b, c, d) = (number(0, 0), number(1, 0), number(0, 1), number(1, 1));
        let sign = if self.invert { -self.scale } else { self.scale };
        let by_x = ((b - a) * (1.0 - fy) + (d - c) * fy) * self.bitmap.width() as f32 * sign;
        let by_y = -((c - a) * (1.0 - fx) + (d - b) * fx) * self.bitmap.height() as f32 * sign;
        let pulled = self.mapping.pull_back(Vector2::new(by_x, by_y));
        pulled.unwrap_or_else(|| central_difference(self, at))
    }

    fn mean(&self, _: &Arena<Texture>) -> Spectrum {
        // Every texel of small pictures, a regular subset of large ones.
        let (w, h) = (self.bitmap.width(), self.bitmap.height());
        let (step_x, step_y) = (w.div_ceil(256), h.div_ceil(256));
        let (mut sum, mut n) = (Spectrum::ZERO, 0.0);
        for y in (0..h).step_by(step_y) {
            for x in (0..w).step_by(step_x) {
                sum += Spectrum::from_rgb(self.texel(x as i64, y as i64));
                n += 1.0;
            }
        }
        let mean = sum / n;
        (if self.invert { Spectrum::ONE - mean } else { mean }) * self.scale
    }

    fn resolution(&self) -> Option<[u32; 2]> {
        Some([self.bitmap.width() as u32, self.bitmap.height() as u32])
    }
}
