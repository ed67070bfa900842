//! The formats that the `image` crate reads and writes: PNG, JPEG, PNM, HDR, TGA, BMP, TIFF, WebP.

use std::io::{Cursor, Seek, Write};
use std::path::Path;

use image::codecs::hdr::HdrEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageReader, Limits, Rgb};

use crate::{Bitmap, Encoding, Format, Image, ImageError, ImageLimits, ToneMapping};

const JPEG_QUALITY: u8 = 95;

pub(super) fn write(
    image: &Image,
    format: Format,
    tone: &ToneMapping,
    out: &mut (impl Write + Seek),
) -> Result<(), ImageError> {
    let fail = |error: image::ImageError| ImageError::Encode { message: error.to_string() };
    let size = |n: usize| {
        u32::try_from(n).map_err(|_| ImageError::Encode { message: format!("{n} pixels are too many") })
    };
    let (width, height) = (size(image.width())?, size(image.height())?);
    match format {
        Format::Hdr => {
            let gain = tone.exposure.exp2();
            let pixels: Vec<Rgb<f32>> =
                image.to_rgb().iter().map(|rgb| Rgb(rgb.map(|x| (x * gain).max(0.0)))).collect();
            HdrEncoder::new(out).encode(&pixels, image.width(), image.height()).map_err(fail)
        }
        Format::Jpeg => JpegEncoder::new_with_quality(out, JPEG_QUALITY)
            .write_image(&tone.to_bytes(image), width, height, ExtendedColorType::Rgb8)
            .map_err(fail),
        _ => {
            let format =
                if format == Format::Ppm { image::ImageFormat::Pnm } else { image::ImageFormat::Png };
            image::write_buffer_with_format(
                out,
                &tone.to_bytes(image),
                width,
                height,
                ExtendedColorType::Rgb8,
                format,
            )
            .map_err(fail)
        }
    }
}

pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    encoding: Encoding,
    limits: &ImageLimits,
) -> Result<Bitmap, ImageError> {
    let bad = |message: String| ImageError::Decode { path: path.to_owned(), message };
    let open = || -> Result<_, ImageError> {
        let mut reader =
            ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| bad(e.to_string()))?;
        if reader.format().is_none()
            && let Ok(format) = image::ImageFormat::from_path(path)
        {
            reader.set_format(format); // TGA has no magic number
        }
        Ok(reader)
    };
    let (width, height) = open()?.into_dimensions().map_err(|e| bad(e.to_string()))?;
    limits.check(width.into(), height.into())?;
    let mut reader = open()?;
    let mut allowed = Limits::default();
    allowed.max_alloc = Some(limits.max_pixels.saturating_mul(16));
    reader.limits(allowed);
    let decoded = reader.decode().map_err(|e| bad(e.to_string()))?;
    to_bitmap(decoded, encoding).ok_or_else(|| bad("it has no pixels".into()))
}

fn to_bitmap(decoded: DynamicImage, encoding: Encoding) -> Option<Bitmap> {
    let (width, height) = (decoded.width() as usize, decoded.height() as usize);
    let channels = usize::from(decoded.color().channel_count());
    let sixteen = |data: Vec<u16>| data.into_iter().map(|x| f32::from(x) / 65535.0).collect();
    match decoded {
        DynamicImage::ImageLuma8(b) => Bitmap::from_bytes(width, height, channels, b.into_raw(), encoding),
        DynamicImage::ImageLumaA8(b) => Bitmap::from_bytes(width, height, channels, b.into_raw(), encoding),
        DynamicImage::ImageRgb8(b) => Bitmap::from_bytes(width, height, channels, b.into_raw(), encoding),
        DynamicImage::ImageRgba8(b) => Bitmap::from_bytes(width, height, channels, b.into_raw(), encoding),
        DynamicImage::ImageLuma16(b) => {
            Bitmap::from_floats(width, height, channels, sixteen(b.into_raw()), encoding, true)
        }
        DynamicImage::ImageLumaA16(b) => {
            Bitmap::from_floats(width, height, channels, sixteen(b.into_raw()), encoding, true)
        }
        DynamicImage::ImageRgb16(b) => {
            Bitmap::from_floats(width, height, channels, sixteen(b.into_raw()), encoding, true)
        }
        DynamicImage::ImageRgba16(b) => {
            Bitmap::from_floats(width, height, channels, sixteen(b.into_raw()), encoding, true)
        }
        DynamicImage::ImageRgb32F(b) => {
            Bitmap::from_floats(width, height, channels, b.into_raw(), encoding, false)
        }
        DynamicImage::ImageRgba32F(b) => {
            Bitmap::from_floats(width, height, channels, b.into_raw(), encoding, false)
        }
        other => Bitmap::from_bytes(width, height, 4, other.into_rgba8().into_raw(), encoding),
    }
}

pub(super) fn to_image(bitmap: &Bitmap) -> Image {
    let has_alpha = bitmap.channels().is_multiple_of(2);
    let names: &[&str] = if has_alpha { &["R", "G", "B", "A"] } else { &["R", "G", "B"] };
    let mut image = Image::new(bitmap.width(), bitmap.height(), names);
    for y in 0..bitmap.height() {
        for x in 0..bitmap.width() {
            let pixel = image.pixel_mut(x, y);
            pixel[..3].copy_from_slice(&bitmap.rgb(x, y));
            if has_alpha {
                pixel[3] = bitmap.alpha(x, y);
            }
        }
    }
    image
}
