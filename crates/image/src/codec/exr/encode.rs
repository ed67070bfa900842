//! Writing EXR: one part with all channels, ZIP-compressed blocks of sixteen lines.

use std::io::Cursor;

use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::meta::attribute::{IntegerBounds, LineOrder, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{Compression, Vec2, f16};

use super::attributes;
use crate::Image;
use crate::codec::{Precision, WriteOptions};

pub(in super::super) fn encode(image: &Image, options: &WriteOptions) -> Result<Vec<u8>, String> {
    let channels = image.channels().iter().enumerate().map(|(i, name)| {
        if name.is_empty() || name.contains('\0') {
            return Err(format!("{name:?} cannot be a channel's name"));
        }
        let is_half = options.precision == Precision::Half && is_color(name);
        let samples = if is_half {
            FlatSamples::F16(image.plane(i).map(to_half).collect())
        } else {
            FlatSamples::F32(image.plane(i).collect())
        };
        Ok(AnyChannel::new(Text::from_slice_unchecked(name.as_bytes()), samples))
    });
    let channels = AnyChannels::sort(channels.collect::<Result<_, String>>()?);

    let size = Vec2(image.width(), image.height());
    let mut layer_attributes = LayerAttributes::default();
    let mut display = IntegerBounds::from_dimensions(size);
    if let Some(window) = image.window {
        layer_attributes.layer_position = Vec2(window.x, window.y);
        display = IntegerBounds::from_dimensions(Vec2(window.full_width, window.full_height));
    }
    layer_attributes.other.extend(attributes::write(&image.metadata));
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        // Any other order would depend on which thread is first.
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(size, layer_attributes, encoding, channels);
    let file = exr::image::Image::new(ImageAttributes::new(display), layer);

    let mut out = Cursor::new(Vec::new());
    // The checks would refuse standard attributes such as `worldToCamera` among the free ones.
    file.write().skip_compatibility_checks().to_buffered(&mut out).map_err(|error| error.to_string())?;
    let mut bytes = out.into_inner();
    attributes::sort(&mut bytes);
    Ok(bytes)
}

/// Whether a channel is seen rather than measured, so that eleven bits of it are enough.
fn is_color(name: &str) -> bool {
    let (layer, component) = name.rsplit_once('.').unwrap_or(("", name));
    // Cryptomatte keeps hashes in channels named like colours.
    matches!(component, "R" | "G" | "B" | "A" | "Y") && !layer.starts_with("Crypto")
}

/// Rounds to half precision; what is too large becomes the largest, for an infinity would spoil every filter over it.
fn to_half(x: f32) -> f16 {
    if x.is_finite() {
        f16::from_f32(x.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
    } else {
        f16::from_f32(x)
    }
}
