//! What the samples of a TIFF file mean.

use std::io::{BufRead, Seek};

use ::tiff::decoder::Decoder;
use ::tiff::decoder::ifd::Value;
use ::tiff::tags::{CompressionMethod, Tag};

use super::samples::Layout;
use crate::error::Fault;
use crate::raster::Texels;

/// The tags that say how pixels are made of samples.
pub(super) struct Tags {
    photometric: u16,
    pub(super) samples: u16,
    pub(super) is_planar: bool,
    /// Whether the first sample after the colours is an opacity.
    has_alpha: bool,
}

impl Tags {
    pub(super) fn read<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Result<Self, Fault> {
        let photometric = decoder.get_tag_unsigned(Tag::PhotometricInterpretation).map_err(Fault::content)?;
        let mut find = |tag| decoder.find_tag_unsigned::<u16>(tag).map_err(Fault::content);
        let samples = find(Tag::SamplesPerPixel)?.unwrap_or(1);
        let is_planar = find(Tag::PlanarConfiguration)? == Some(2) && samples > 1;
        let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).map_err(Fault::content)?;
        // Old files have a fourth sample of which they say nothing.
        let has_alpha = extra.map_or(photometric == 2, |kinds| matches!(kinds.first(), Some(1 | 2)));
        Ok(Self { photometric, samples, is_planar, has_alpha })
    }
}

/// Rationals for luminance of red, green and blue; and for zero and full of each sample. The crate has no names for them.
const COEFFICIENTS: Tag = Tag::Unknown(529);
const REFERENCE_BLACK_WHITE: Tag = Tag::Unknown(532);
/// Full chroma is 127 of 255 codes, and twice that is the difference between a colour and its luminance.
const CHROMA: f32 = 2.0 * 127.0 / 255.0;

/// How samples become grey or red, green and blue.
pub(super) struct Color {
    kind: Kind,
    has_alpha: bool,
}

enum Kind {
    Grey,
    /// Grey where zero is white.
    Inverted,
    Rgb,
    Palette(Vec<[u16; 3]>),
    Cmyk,
    YCbCr {
        /// Luminance of red, green and blue.
        luma: [f32; 3],
        /// What stands for zero and for full, of each sample.
        range: [[f32; 2]; 3],
    },
}

impl Color {
    pub(super) fn new<R: BufRead + Seek>(
        tags: &Tags,
        bits: u32,
        decoder: &mut Decoder<R>,
    ) -> Result<Self, Fault> {
        let (kind, needed) = match tags.photometric {
            0 => (Kind::Inverted, 1),
            1 | 4 => (Kind::Grey, 1),
            2 => (Kind::Rgb, 3),
            3 => (Kind::Palette(palette(decoder)?), 1),
            5 => (Kind::Cmyk, 4),
            6 => (ycbcr(decoder, bits)?, 3),
            8..=10 => return Err(Fault::content("colours of CIE L*a*b* are not supported")),
            other => return Err(Fault::content(format!("photometric interpretation {other} is not known"))),
        };
        if tags.samples < needed {
            return Err(Fault::content(format!(
                "{} samples a pixel are too few for its colours",
                tags.samples
            )));
        }
        Ok(Self { kind, has_alpha: tags.has_alpha && tags.samples > needed })
    }

    /// The number of channels and the picture.
    pub(super) fn apply(self, texels: Texels, layout: &Layout) -> (usize, Texels) {
        let stride = layout.samples;
        let texels = match &self.kind {
            Kind::Palette(_) => texels,
            _ => texels.widened(layout.bits),
        };
        let alpha = |colors: usize| if self.has_alpha { vec![colors] } else { Vec::new() };
        match self.kind {
            Kind::Grey => {
                let kept = [vec![0], alpha(1)].concat();
                (kept.len(), texels.pick(stride, &kept))
            }
            Kind::Rgb => {
                let kept = [vec![0, 1, 2], alpha(3)].concat();
                (kept.len(), texels.pick(stride, &kept))
            }
            Kind::Inverted => {
                let kept = [vec![0], alpha(1)].concat();
                let picked = texels.pick(stride, &kept);
                (kept.len(), picked.map_pixels(kept.len(), |pixel| pixel[0] = 1.0 - pixel[0]))
            }
            Kind::Palette(colors) => {
                let index: Vec<usize> = match texels.pick(stride, &[0]) {
                    Texels::Bytes(data) => data.into_iter().map(usize::from).collect(),
                    Texels::Words(data) => data.into_iter().map(usize::from).collect(),
                    _ => Vec::new(),
                };
                let color = |i: usize| colors.get(i).copied().unwrap_or_default();
                (3, Texels::Words(index.into_iter().flat_map(color).collect()))
            }
            Kind::Cmyk => {
                let kept = [vec![0, 1, 2], alpha(4)].concat();
                let mixed = texels.map_pixels(stride, |pixel| {
                    let key = 1.0 - pixel[3];
                    pixel[..3].iter_mut().for_each(|ink| *ink = (1.0 - *ink) * key);
                });
                (kept.len(), mixed.pick(stride, &kept))
            }
            Kind::YCbCr { luma, range } => {
                let kept = [vec![0, 1, 2], alpha(3)].concat();
                let mixed = texels.map_pixels(stride, |pixel| {
                    let [y, cb, cr] = std::array::from_fn(|i| {
                        let [zero, full] = range[i];
                        (pixel[i] - zero) / (full - zero)
                    });
                    let red = y + cr * CHROMA * (1.0 - luma[0]);
                    let blue = y + cb * CHROMA * (1.0 - luma[2]);
                    let green = (y - luma[0] * red - luma[2] * blue) / luma[1];
                    pixel[..3].copy_from_slice(&[red, green, blue]);
                });
                (kept.len(), mixed.pick(stride, &kept))
            }
        }
    }
}

/// Colours of sixteen bits: first all reds, then all greens, then all blues.
fn palette<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Result<Vec<[u16; 3]>, Fault> {
    let map = decoder.find_tag_unsigned_vec::<u16>(Tag::ColorMap).map_err(Fault::content)?;
    let map = map.ok_or_else(|| Fault::content("it has no palette"))?;
    let n = map.len() / 3;
    Ok((0..n).map(|i| [map[i], map[n + i], map[2 * n + i]]).collect())
}

fn ycbcr<R: BufRead + Seek>(decoder: &mut Decoder<R>, bits: u32) -> Result<Kind, Fault> {
    if bits != 8 && bits != 16 {
        return Err(Fault::content(format!("luminance and chroma of {bits} bits are not supported")));
    }
    let method = decoder.find_tag_unsigned::<u16>(Tag::Compression).map_err(Fault::content)?;
    let steps = decoder.find_tag_unsigned_vec::<u16>(Tag::ChromaSubsampling).map_err(Fault::content)?;
    // JPEG brings all its channels to full size.
    let is_jpeg = method.map(CompressionMethod::from_u16_exhaustive) == Some(CompressionMethod::ModernJPEG);
    if !is_jpeg && steps.as_deref() != Some(&[1, 1]) {
        return Err(Fault::content(
            "chroma of lower resolution is only supported with the compression of JPEG",
        ));
    }
    let is_positive = |list: &[f32; 3]| list.iter().all(|x| x.is_finite() && *x > 0.0);
    let luma: Option<[f32; 3]> = fractions(decoder, COEFFICIENTS).try_into().ok();
    let luma = luma.filter(is_positive).unwrap_or([0.299, 0.587, 0.114]);
    let full = ((1_u32 << bits) - 1) as f32;
    let middle = (full + 1.0) / 2.0;
    let range: Option<[f32; 6]> = fractions(decoder, REFERENCE_BLACK_WHITE).try_into().ok();
    let range = range.unwrap_or([0.0, full, middle, full, middle, full]).map(|code| code / full);
    let range = [[range[0], range[1]], [range[2], range[3]], [range[4], range[5]]];
    if range.iter().any(|[zero, full]| !(full - zero).is_normal()) {
        return Err(Fault::content("what stands for black and white in it is the same"));
    }
    Ok(Kind::YCbCr { luma, range })
}

/// A tag's rational numbers; none where it is missing or something else.
fn fractions<R: BufRead + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> Vec<f32> {
    let Ok(Some(Value::List(list))) = decoder.find_tag(tag) else { return Vec::new() };
    let number = |value| match value {
        Value::Rational(above, below) => Some(above as f32 / below as f32),
        Value::Float(x) => Some(x),
        _ => None,
    };
    list.into_iter().map_while(number).collect()
}
