//! The formats that the `image` crate knows.

use std::io::Cursor;

use ::image::codecs::{hdr::HdrEncoder, jpeg::JpegEncoder, png::PngEncoder};
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader, Rgb};

use super::{BitDepth, WriteOptions};
use crate::error::Fault;
use crate::raster::{Raster, Texels};
use crate::tone::Alpha;
use crate::{Image, ImageLimits};

/// A file of some size cannot hold more pixels than the best of the compressions (deflate, 1032 to one, of single bits) allows.
const MAX_PIXELS_PER_BYTE: u64 = 1032 * 8;

fn decode(bytes: &[u8], limits: &ImageLimits, format: ImageFormat) -> Result<Raster, Fault> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut inner = ::image::Limits::default();
    inner.max_alloc = Some(limits.max_bytes);
    reader.limits(inner);
    let decoder = reader.into_decoder().map_err(Fault::content)?;
    let (width, height) = decoder.dimensions();
    let bytes_per_pixel = u64::from(decoder.color_type().bytes_per_pixel());
    limits.check(width.into(), height.into(), 1, bytes_per_pixel)?;
    let most = MAX_PIXELS_PER_BYTE.saturating_mul(bytes.len() as u64);
    // WebP can paint a whole picture with a few bits.
    if format != ImageFormat::WebP && u64::from(width) * u64::from(height) > most {
        return Err(Fault::content(format!("{} bytes cannot hold {width} x {height} pixels", bytes.len())));
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(Fault::content)?;
    let channels = usize::from(picture.color().channel_count());
    let texels = match picture {
        DynamicImage::ImageLuma8(buffer) => Texels::Bytes(buffer.into_raw()),
        DynamicImage::ImageLumaA8(buffer) => Texels::Bytes(buffer.into_raw()),
        DynamicImage::ImageRgb8(buffer) => Texels::Bytes(buffer.into_raw()),
        DynamicImage::ImageRgba8(buffer) => Texels::Bytes(buffer.into_raw()),
        DynamicImage::ImageLuma16(buffer) => Texels::Words(buffer.into_raw()),
        DynamicImage::ImageLumaA16(buffer) => Texels::Words(buffer.into_raw()),
        DynamicImage::ImageRgb16(buffer) => Texels::Words(buffer.into_raw()),
        DynamicImage::ImageRgba16(buffer) => Texels::Words(buffer.into_raw()),
        DynamicImage::ImageRgb32F(buffer) => Texels::Floats(buffer.into_raw()),
        DynamicImage::ImageRgba32F(buffer) => Texels::Floats(buffer.into_raw()),
        other => return Err(Fault::content(format!("pixels of type {:?} are not supported", other.color()))),
    };
    Ok(Raster::picture(width as usize, height as usize, channels, texels))
}

/// Makes the decoder of one of the crate's formats.
macro_rules! decoders {
    ($($name:ident: $format:ident),* $(,)?) => {
        $(pub(super) fn $name(bytes: &[u8], limits: &ImageLimits) -> Result<Raster, Fault> {
            decode(bytes, limits, ImageFormat::$format)
        })*
    };
}

decoders! {
    decode_png: Png, decode_jpeg: Jpeg, decode_pnm: Pnm,
    decode_bmp: Bmp, decode_webp: WebP, decode_tga: Tga,
}

/// An image's size as the formats of the past count it.
fn size(image: &Image) -> Result<(u32, u32), String> {
    let narrow = |n: usize| u32::try_from(n).map_err(|_| format!("{n} pixels are too many for the format"));
    Ok((narrow(image.width())?, narrow(image.height())?))
}

/// PNG, with alpha if the image has it, 8 or 16 bits a value.
pub(super) fn encode_png(image: &Image, options: &WriteOptions) -> Result<Vec<u8>, String> {
    let (width, height) = size(image)?;
    let has_alpha = image.channel("A").is_some();
    let (bytes, color) = match options.bit_depth {
        BitDepth::Eight => {
            let bytes = options.tone.quantise(image, Alpha::Keep, 255.0, |x| x as u8);
            (bytes, if has_alpha { ExtendedColorType::Rgba8 } else { ExtendedColorType::Rgb8 })
        }
        BitDepth::Sixteen => {
            let words = options.tone.quantise(image, Alpha::Keep, 65535.0, |x| x as u16);
            let bytes = words.into_iter().flat_map(u16::to_ne_bytes).collect();
            (bytes, if has_alpha { ExtendedColorType::Rgba16 } else { ExtendedColorType::Rgb16 })
        }
    };
    let mut out = Vec::new();
    PngEncoder::new(&mut out).write_image(&bytes, width, height, color).map_err(|e| e.to_string())?;
    Ok(out)
}

/// JPEG; alpha is dropped, the picture lies over black.
pub(super) fn encode_jpeg(image: &Image, options: &WriteOptions) -> Result<Vec<u8>, String> {
    let (width, height) = size(image)?;
    let bytes = options.tone.to_bytes(image);
    let mut out = Vec::new();
    JpegEncoder::new_with_quality(&mut out, options.quality.clamp(1, 100))
        .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| e.to_string())?;
    Ok(out)
}

/// Radiance's shared exponent; negative and non-finite values, which it cannot hold, become zero.
pub(super) fn encode_hdr(image: &Image, _: &WriteOptions) -> Result<Vec<u8>, String> {
    size(image)?;
    let clean = |x: f32| if x.is_finite() { x.max(0.0) } else { 0.0 };
    let pixels: Vec<Rgb<f32>> = image.to_rgb().into_iter().map(|rgb| Rgb(rgb.map(clean))).collect();
    let mut out = Vec::new();
    HdrEncoder::new(&mut out).encode(&pixels, image.width(), image.height()).map_err(|e| e.to_string())?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{Bitmap, Encoding, Format, decode_bitmap};

    /// Gradients in the type that `picture` starts with, as a file of a format.
    fn file(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        picture.write_to(&mut out, format).unwrap();
        out.into_inner()
    }

    fn read(bytes: &[u8], format: Format) -> Bitmap {
        let path = Path::new("a").with_extension(format.suffix());
        decode_bitmap(bytes, &path, Encoding::Linear, &ImageLimits::default()).unwrap()
    }

    #[test]
    fn formats_that_are_only_read_are_read() {
        let mut rgba = ::image::RgbaImage::new(13, 7);
        for (x, y, pixel) in rgba.enumerate_pixels_mut() {
            *pixel = ::image::Rgba([x as u8 * 19, y as u8 * 36, (x * y) as u8, 255 - x as u8]);
        }
        let picture = DynamicImage::ImageRgba8(rgba.clone());
        for (theirs, ours) in [
            (ImageFormat::Bmp, Format::Bmp),
            (ImageFormat::Tga, Format::Tga),
            (ImageFormat::Tiff, Format::Tiff),
            (ImageFormat::WebP, Format::WebP),
        ] {
            let bitmap = read(&file(&picture, theirs), ours);
            assert_eq!((bitmap.width(), bitmap.height(), bitmap.channels()), (13, 7, 4), "{ours:?}");
            for (x, y, pixel) in rgba.enumerate_pixels() {
                let expected = pixel.0.map(|value| f32::from(value) / 255.0);
                let texel = bitmap.texel(x as usize, y as usize);
                assert!(expected.iter().zip(texel).all(|(a, b)| (a - b).abs() < 1e-6), "{ours:?}");
            }
        }
    }

    #[test]
    fn grey_and_deep_files_keep_their_kind() {
        let picture =
            DynamicImage::ImageLumaA16(::image::ImageBuffer::from_pixel(3, 2, ::image::LumaA([40_000, 9])));
        let bitmap = read(&file(&picture, ImageFormat::Png), Format::Png);
        assert_eq!((bitmap.channels(), bitmap.memory()), (2, 3 * 2 * 2 * 2));
        let [r, g, _, a] = bitmap.texel(2, 1);
        assert!(r == g && (r - 40_000.0 / 65_535.0).abs() < 1e-6 && (a - 9.0 / 65_535.0).abs() < 1e-8);

        let picture = DynamicImage::ImageLuma8(::image::ImageBuffer::from_pixel(5, 4, ::image::Luma([51])));
        for (theirs, ours) in [(ImageFormat::Png, Format::Png), (ImageFormat::Pnm, Format::Ppm)] {
            let bitmap = read(&file(&picture, theirs), ours);
            assert!(bitmap.is_grey() && (bitmap.rgb(0, 0)[2] - 0.2).abs() < 1e-6, "{ours:?}");
        }
    }

    #[test]
    fn a_size_that_the_file_cannot_fill_is_refused() {
        let mut bytes = file(&DynamicImage::new_rgb8(2, 2), ImageFormat::Bmp);
        bytes[18..22].copy_from_slice(&15_000_i32.to_le_bytes());
        bytes[22..26].copy_from_slice(&15_000_i32.to_le_bytes());
        let error = decode(&bytes, &ImageLimits::default(), ImageFormat::Bmp).unwrap_err();
        assert!(matches!(error, Fault::Content(message) if message.contains("cannot hold")));
    }
}
