//! `bitmap`: a picture.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `filename` | path | | PNG, JPEG, EXR, HDR, TGA, ... |
//! | `filter` | string | bilinear | `bilinear`, `nearest`; by what a pixel covers: `trilinear`, `ewa` |
//! | `max_anisotropy` | float | 8 | of `ewa`: how much longer than wide its ellipse may be |
//! | `wrap` | string | repeat | beyond the unit square: `repeat`, `mirror`, `clamp`, `black`, `octahedral` |
//! | `encoding` | string | auto | `auto` (by file type), `srgb`, `linear` (raw data), `gamma` |
//! | `gamma` | float | 2.2 | for `encoding` = `gamma` |
//! | `channel` | string | color | what is read: `color`; `alpha`; the `first` of the colours; their `mean`; or a `number`: alpha, by the encoding of colours, where the picture has holes, else the mean |
//! | `mapping` | string | uv | from the surface (`uv`) or from where it is: `spherical`, `cylindrical`, `planar` |
//! | `texture_from_world` | transform | identity | into the texture's space, for the latter |
//! | `to_uv` | transform | identity | applied to the mapped coordinates |
//! | `scale` | float | 1 | factor |
//! | `invert` | bool | false | 1 - value, after `scale`, where that is positive |
//!
//! v = 0 is the bottom of the picture.
//!
//! `trilinear` and `ewa` read smaller versions of the picture where a pixel of the camera covers more than a texel: the former
//! by the pixel's longest step, the latter by a Gaussian over its ellipse. What a pixel covers is known from the camera alone,
//! as if it saw each place directly, also in mirrors; where a texel covers more than a pixel, `trilinear` is `bilinear`, and the
//! Gaussian is one texel wide, as in pbrt.
//!
//! References: [Williams 1983] "Pyramidal Parametrics"; [Heckbert 1989] "Fundamentals of Texture Mapping and Image Warping".

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
    Trilinear,
    Ewa,
}

/// What is read of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Color,
    Alpha,
    First,
    Mean,
    Number,
}

impl Channel {
    /// The part of a picture that it is.
    fn of(self, bitmap: Arc<Bitmap>) -> Arc<Bitmap> {
        let has_holes = || {
            let mut places = (0..bitmap.height()).flat_map(|y| (0..bitmap.width()).map(move |x| (x, y)));
            bitmap.has_alpha() && places.any(|(x, y)| bitmap.alpha(x, y) != 1.0)
        };
        match self {
            Self::Color => bitmap,
            Self::Alpha => Arc::new(bitmap.map_to_grey(|texel| texel[3])),
            Self::Number if has_holes() => Arc::new(bitmap.plane(bitmap.channels() - 1)),
            Self::First | Self::Mean | Self::Number if bitmap.channels() == 1 => bitmap,
            Self::First => Arc::new(bitmap.plane(0)),
            Self::Mean | Self::Number => {
                Arc::new(bitmap.map_to_grey(|[r, g, b, _]| (r + g + b) * (1.0 / 3.0)))
            }
        }
    }
}

/// A picture as a texture.
#[derive(Clone, Debug)]
pub struct BitmapTexture {
    bitmap: Arc<Bitmap>,
    filter: Filter,
    max_anisotropy: f32,
    wrap: Wrap,
    mapping: Mapping,
    scale: f32,
    invert: bool,
}

impl BitmapTexture {
    #[inline]
    fn texel(&self, x: i64, y: i64) -> [f32; 3] {
        self.texel_of(&self.bitmap, x, y)
    }

    #[inline]
    fn texel_of(&self, b: &Bitmap, x: i64, y: i64) -> [f32; 3] {
        match self.wrap.texel([x, y], [b.width() as i64, b.height() as i64]) {
            Some([x, y]) => b.rgb(x, y),
            None => [0.0; 3],
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
            Filter::Bilinear => self.bilinear(&self.bitmap, p),
            Filter::Trilinear | Filter::Ewa => self.filtered(at, p),
        };
        value.map(|x| if self.invert { (1.0 - x * self.scale).max(0.0) } else { x * self.scale })
    }
}

/// Filtering by footprints.
impl BitmapTexture {
    /// Between the four nearest texels of a level; `p` counts its texels.
    #[inline]
    fn bilinear(&self, level: &Bitmap, p: Vector2) -> [f32; 3] {
        let (x, y) = (p.x - 0.5, p.y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let (x0, y0) = (x0 as i64, y0 as i64);
        let [a, b, c, d] =
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.texel_of(level, x0 + i, y0 + j));
        std::array::from_fn(|i| {
            let top = a[i] + (b[i] - a[i]) * fx;
            let bottom = c[i] + (d[i] - c[i]) * fx;
            top + (bottom - top) * fy
        })
    }

    /// The mean over what a pixel covers; `p` counts texels of the whole picture.
    fn filtered(&self, at: &TextureContext<'_>, p: Vector2) -> [f32; 3] {
        let (width, height) = (self.bitmap.width() as f32, self.bitmap.height() as f32);
        let steps =
            self.mapping.footprint(at).map(|steps| steps.map(|s| Vector2::new(s.x * width, -s.y * height)));
        let Some([mut long, mut short]) = steps else { return self.bilinear(&self.bitmap, p) };
        if long.length() < short.length() {
            std::mem::swap(&mut long, &mut short);
        }
        let (length, mut breadth) = (long.length(), short.length());
        let is_close = length <= 1.0 && (self.filter == Filter::Trilinear || breadth == 0.0);
        if is_close || !length.is_finite() {
            return self.bilinear(&self.bitmap, p);
        }
        if self.filter == Filter::Trilinear {
            return self.between_levels(length, |level| {
                let b = self.bitmap.level(level);
                self.bilinear(
                    b,
                    Vector2::new(p.x * b.width() as f32 / width, p.y * b.height() as f32 / height),
                )
            });
        }
        // An ellipse that is too thin would ask for too many texels.
        if breadth * self.max_anisotropy < length {
            let least = length / self.max_anisotropy;
            let across = Vector2::new(-long.y, long.x) / length;
            short = if breadth > 0.0 { short * (least / breadth) } else { across * least };
            breadth = least;
        }
        // What covers the whole picture sees its mean; an ellipse over many copies of it would cost as many texels.
        let top = self.bitmap.level_count() - 1;
        if breadth >= (1_u64 << top) as f32 {
            return self.bilinear(self.bitmap.level(top), Vector2::new(0.5, 0.5));
        }
        self.between_levels(breadth.max(1.0), |level| self.ellipse(level, p, [long, short]))
    }

    /// Blends what two levels give, so that a texel of them covers `size` texels of the whole picture.
    fn between_levels(&self, size: f32, at_level: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        let top = (self.bitmap.level_count() - 1) as f32;
        let level = size.log2().clamp(0.0, top);
        let below = level.floor();
        let (a, blend) = (at_level(below as usize), level - below);
        if blend == 0.0 {
            return a;
        }
        let b = at_level(below as usize + 1);
        std::array::from_fn(|i| a[i] + (b[i] - a[i]) * blend)
    }

    /// The mean under a Gaussian over an ellipse, cut off at two standard deviations [Heckbert 1989, section 3.5.8].
    fn ellipse(&self, level: usize, p: Vector2, steps: [Vector2; 2]) -> [f32; 3] {
        let b = self.bitmap.level(level);
        let scale_x = b.width() as f32 / self.bitmap.width() as f32;
        let scale_y = b.height() as f32 / self.bitmap.height() as f32;
        let center = Vector2::new(p.x * scale_x - 0.5, p.y * scale_y - 0.5);
        let [s, t] = steps.map(|d| Vector2::new(d.x * scale_x, d.y * scale_y));
        // a x² + b x y + c y² < 1 inside; one texel is added to either axis, so that none falls between.
        let (a, c) = (s.y * s.y + t.y * t.y + 1.0, s.x * s.x + t.x * t.x + 1.0);
        let mixed = -2.0 * (s.x * s.y + t.x * t.y);
        let f = a * c - 0.25 * mixed * mixed;
        let (reach_x, reach_y) = (c.sqrt(), a.sqrt());
        let (a, mixed, c) = (a / f, mixed / f, c / f);
        let range = |x: f32, reach: f32| (x - reach).ceil() as i64..=(x + reach).floor() as i64;
        let (mut sum, mut total) = ([0.0_f32; 3], 0.0);
        for y in range(center.y, reach_y) {
            let dy = y as f32 - center.y;
            for x in range(center.x, reach_x) {
                let dx = x as f32 - center.x;
                let r2 = a * dx * dx + mixed * dx * dy + c * dy * dy;
                if r2 < 1.0 {
                    let weight = (-2.0 * r2).exp() - (-2.0_f32).exp();
                    let texel = self.texel_of(b, x, y);
                    sum.iter_mut().zip(texel).for_each(|(sum, t)| *sum += weight * t);
                    total += weight;
                }
            }
        }
        if total > 0.0 { sum.map(|x| x / total) } else { self.bilinear(b, center + Vector2::new(0.5, 0.5)) }
    }
}

impl Element for BitmapTexture {
    const SUMMARY: &'static str = "A picture.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "filename", ty: "path", default: "", doc: "PNG, JPEG, EXR, HDR, TGA, ..." },
        ParamDoc {
            name: "filter",
            ty: "string",
            default: "bilinear",
            doc: "`bilinear`, `nearest`; by what a pixel covers: `trilinear`, `ewa`",
        },
        ParamDoc {
            name: "max_anisotropy",
            ty: "float",
            default: "8",
            doc: "of `ewa`: how much longer than wide its ellipse may be",
        },
        ParamDoc {
            name: "wrap",
            ty: "string",
            default: "repeat",
            doc: "`repeat`, `mirror`, `clamp`, `black` or `octahedral`",
        },
        ParamDoc {
            name: "encoding",
            ty: "string",
            default: "auto",
            doc: "`auto`, `srgb`, `linear` or `gamma`",
        },
        ParamDoc { name: "gamma", ty: "float", default: "2.2", doc: "for `encoding` = `gamma`" },
        ParamDoc {
            name: "channel",
            ty: "string",
            default: "color",
            doc: "`color`, `alpha`, `first`, `mean`, or `number`: alpha where the picture has holes, else the mean",
        },
        MAPPING,
        TEXTURE_FROM_WORLD,
        TO_UV,
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor" },
        ParamDoc { name: "invert", ty: "bool", default: "false", doc: "1 - value, after `scale`" },
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
        let bitmap = resolver.bitmap(&path, encoding, at)?;
        let channel = params.one_of(
            "channel",
            &[
                ("color", Channel::Color),
                ("alpha", Channel::Alpha),
                ("first", Channel::First),
                ("mean", Channel::Mean),
                ("number", Channel::Number),
            ],
        )?;
        Ok(Self {
            bitmap: channel.of(bitmap),
            filter: params.one_of(
                "filter",
                &[
                    ("bilinear", Filter::Bilinear),
                    ("nearest", Filter::Nearest),
                    ("trilinear", Filter::Trilinear),
                    ("ewa", Filter::Ewa),
                ],
            )?,
            max_anisotropy: params.float_in("max_anisotropy", 8.0, 1.0, 64.0)?,
            wrap: params.one_of(
                "wrap",
                &[
                    ("repeat", Wrap::Repeat),
                    ("mirror", Wrap::Mirror),
                    ("clamp", Wrap::Clamp),
                    ("black", Wrap::Black),
                    ("octahedral", Wrap::Octahedral),
                ],
            )?,
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
        if self.invert { Spectrum::ONE - mean * self.scale } else { mean * self.scale }
    }

    fn resolution(&self) -> Option<[u32; 2]> {
        Some([self.bitmap.width() as u32, self.bitmap.height() as u32])
    }

    fn is_filtered(&self) -> bool {
        matches!(self.filter, Filter::Trilinear | Filter::Ewa)
    }
}

#[cfg(test)]
mod tests {
    use aureole_math::Point2;
    use aureole_spectrum::Wavelengths;

    use super::*;
    use crate::texture::{Footprint, UvMap};

    /// Black and white squares of one texel.
    fn checker(filter: Filter) -> BitmapTexture {
        const N: usize = 64;
        let data = (0..N * N).map(|i| if (i % N + i / N).is_multiple_of(2) { 0 } else { 255 }).collect();
        let bitmap = Bitmap::from_bytes(N, N, 1, data, Encoding::Linear).expect("is as long as it must be");
        BitmapTexture {
            bitmap: Arc::new(bitmap),
            filter,
            max_anisotropy: 8.0,
            wrap: Wrap::Repeat,
            mapping: Mapping::default(),
            scale: 1.0,
            invert: false,
        }
    }

    fn value(texture: &BitmapTexture, uv: Point2, steps: Option<[Vector2; 2]>) -> f32 {
        let textures = Arena::new();
        let footprint = steps.map(|duv| Footprint { dp: [aureole_math::Vector3::ZERO; 2], duv });
        let at = TextureContext { footprint, ..TextureContext::at_uv(&textures, Wavelengths::RGB, uv) };
        texture.eval_float(&at)
    }

    #[test]
    fn far_away_a_checkerboard_is_its_mean() {
        for filter in [Filter::Trilinear, Filter::Ewa] {
            let texture = checker(filter);
            for (i, step) in [(0, 4.0), (1, 9.0), (2, 100.0), (3, 1e6)] {
                let uv = Point2::new(0.17 * i as f32, 0.31);
                let s = step / 64.0;
                let steps = [Vector2::new(s, 0.3 * s), Vector2::new(-0.4 * s, 1.1 * s)];
                let found = value(&texture, uv, Some(steps));
                assert!((found - 0.5).abs() < 0.03, "{filter:?} {step}: {found}");
            }
        }
    }

    #[test]
    fn up_close_trilinear_is_bilinear() {
        let [plain, texture] = [Filter::Bilinear, Filter::Trilinear].map(checker);
        for i in 0..200 {
            let uv = Point2::new(0.013 * i as f32, 0.029 * i as f32);
            let s = 0.9 / 64.0;
            let steps = [Vector2::new(s, 0.0), Vector2::new(0.0, 0.5 * s)];
            assert_eq!(value(&texture, uv, Some(steps)), value(&plain, uv, None));
            assert_eq!(value(&texture, uv, None), value(&plain, uv, None));
        }
    }

    /// In the limit the Gaussian has a radius of one texel around each place: in the middle of a texel that texel alone has
    /// weight, halfway to the next both have the same, and a third of the way their weights are those of the formula.
    #[test]
    fn up_close_an_ellipse_is_a_texel_wide() {
        let texture = checker(Filter::Ewa);
        let steps = [Vector2::new(1e-5, 0.0), Vector2::new(0.0, 1e-5)];
        let at = |x: f32| value(&texture, Point2::new(x / 64.0, 1.0 - 0.5 / 64.0), Some(steps));
        let weight = |r: f32| (-2.0 * r * r).exp() - (-2.0_f32).exp();
        let third = weight(1.0 / 3.0) / (weight(1.0 / 3.0) + weight(2.0 / 3.0));
        for (x, expected) in [(0.5, 0.0), (1.5, 1.0), (1.0, 0.5), (1.5 + 1.0 / 3.0, third)] {
            assert!((at(x) - expected).abs() < 1e-3, "{x}: {}, expected {expected}", at(x));
        }
    }

    /// Long across stripes is blurred, long along them is not: that is what an ellipse can do and a square cannot.
    #[test]
    fn ellipses_keep_what_lies_across_them() {
        const N: usize = 64;
        let data = (0..N * N).map(|i| if i % N < N / 2 { 0 } else { 255 }).collect();
        let bitmap =
            Arc::new(Bitmap::from_bytes(N, N, 1, data, Encoding::Linear).expect("is as long as it must be"));
        let [ewa, trilinear] =
            [Filter::Ewa, Filter::Trilinear].map(|f| BitmapTexture { bitmap: bitmap.clone(), ..checker(f) });
        let uv = Point2::new(0.47, 0.5);
        let along = Some([Vector2::new(0.0, 0.12), Vector2::new(1.0 / 64.0, 0.0)]);
        let across = Some([Vector2::new(0.25, 0.0), Vector2::new(0.0, 1.0 / 64.0)]);
        assert!(value(&ewa, uv, along) < 0.01);
        assert!(value(&trilinear, uv, along) > 0.02);
        assert!(value(&ewa, uv, across) > 0.05);
    }

    /// A number of a coloured picture is the mean of its channels, or its opacity where it is not opaque everywhere.
    #[test]
    fn numbers_are_means_or_holes() {
        let number = |bytes: Vec<u8>, channels: usize, invert: bool| {
            let bitmap = Bitmap::from_bytes(1, 1, channels, bytes, Encoding::Linear)
                .expect("is as long as it must be");
            let texture = BitmapTexture {
                bitmap: Channel::Number.of(Arc::new(bitmap)),
                scale: 0.5,
                invert,
                ..checker(Filter::Bilinear)
            };
            value(&texture, Point2::new(0.5, 0.5), None)
        };
        let near = |a: f32, b: f32| (a - b).abs() < 1e-6;
        assert!(near(number(vec![255, 0, 51], 3, false), 0.2));
        assert!(near(number(vec![255, 0, 51, 255], 4, false), 0.2));
        assert!(near(number(vec![255, 0, 51, 102], 4, false), 0.2));
        assert!(near(number(vec![0, 0, 0, 204], 4, false), 0.4));
        // The scale comes first.
        assert!(near(number(vec![255, 0, 51], 3, true), 0.8));
    }

    /// What is read of a picture is decoded as its colours are, but for `alpha`, which is what it says.
    #[test]
    fn channels_are_read_by_their_encoding() {
        let byte = 188; // sRGB's one half
        let picture = Bitmap::from_bytes(1, 1, 4, vec![byte, 255, 0, byte], Encoding::Srgb);
        let picture = Arc::new(picture.expect("is as long as it must be"));
        let read = |channel: Channel| channel.of(picture.clone()).rgb(0, 0);
        let near = |a: [f32; 3], b: f32| a.iter().all(|a| (a - b).abs() < 4e-3);
        assert!(near(read(Channel::Alpha), 188.0 / 255.0));
        assert!(near(read(Channel::Number), 0.503));
        assert!(near(read(Channel::First), 0.503));
        assert!(near(read(Channel::Mean), 0.501));
        assert!((read(Channel::Color)[1] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn mapped_footprints_follow_the_map() {
        let map = UvMap::new(&aureole_math::Transform::scale(aureole_math::Vector3::new(3.0, 2.0, 1.0)));
        let d = map.linear(Vector2::new(0.1, -0.2));
        assert!((d - Vector2::new(0.3, -0.4)).length() < 1e-6);
    }
}
