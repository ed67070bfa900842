use exr::block::samples::Sample;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, SpecificChannels};
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{Vec2, f16};

use super::{decode, encode};
use crate::codec::{Precision, WriteOptions};
use crate::image::Window;
use crate::raster::Texels;
use crate::{Attribute, Image, ImageLimits};

fn sample() -> Image {
    let mut image = Image::new(19, 37, &["R", "G", "B", "A", "albedo.R", "Z", "CryptoObject00.R"]);
    for (i, x) in image.data_mut().iter_mut().enumerate() {
        *x = (i as f32 * 0.37).sin() * 3.0;
    }
    image.metadata.insert("seed".into(), Attribute::Int(7));
    image.metadata.insert("software".into(), "Aureole".into());
    image.metadata.insert("exposure of this".into(), 0.5.into());
    image.metadata.insert("note".into(), "größer".into());
    image.metadata.insert("worldToCamera".into(), std::array::from_fn(|i| i as f32).into());
    image
}

fn read(bytes: &[u8]) -> Image {
    decode(bytes, &ImageLimits::default()).unwrap().into_image().unwrap()
}

/// The same image with its channels in the order of another.
fn assert_same(image: &Image, back: &Image, tolerance: impl Fn(&str) -> f32) {
    assert_eq!((image.width(), image.height()), (back.width(), back.height()));
    assert_eq!(image.channels().len(), back.channels().len());
    for (i, name) in image.channels().iter().enumerate() {
        let j = back.channel(name).unwrap_or_else(|| panic!("{name} is lost"));
        for (a, b) in image.plane(i).zip(back.plane(j)) {
            assert!((a - b).abs() <= tolerance(name) * a.abs(), "{name}: {a} became {b}");
        }
    }
    assert_eq!(image.metadata, back.metadata);
    assert_eq!(image.window, back.window);
}

#[test]
fn floats_come_back_exactly_with_layers_and_facts() {
    let image = sample();
    let bytes = encode(&image, &WriteOptions::default()).unwrap();
    let back = read(&bytes);
    assert_same(&image, &back, |_| 0.0);
    assert_eq!(back.channels()[..4], ["R", "G", "B", "A"]);
}

#[test]
fn halves_are_for_colours_only() {
    let image = sample();
    let options = WriteOptions { precision: Precision::Half, ..Default::default() };
    let back = read(&encode(&image, &options).unwrap());
    let is_color = |name: &str| matches!(name, "R" | "G" | "B" | "A" | "albedo.R");
    assert_same(&image, &back, |name| if is_color(name) { 1.0 / 2048.0 } else { 0.0 });
}

#[test]
fn half_files_stay_half_in_memory_and_do_not_overflow() {
    let image = Image::from_rgb(1, 1, &[[1e6, -1e6, 0.5]]).unwrap();
    let options = WriteOptions { precision: Precision::Half, ..Default::default() };
    let raster = decode(&encode(&image, &options).unwrap(), &ImageLimits::default()).unwrap();
    let largest = f16::MAX;
    assert_eq!(raster.texels, Texels::Halves(vec![largest, -largest, f16::from_f32(0.5)]));
}

#[test]
fn one_image_gives_one_file() {
    let image = sample();
    let bytes = encode(&image, &WriteOptions::default()).unwrap();
    for _ in 0..10 {
        assert!(encode(&image, &WriteOptions::default()).unwrap() == bytes);
    }
}

#[test]
fn crop_windows_survive() {
    let mut image = sample();
    image.window = Some(Window { x: 5, y: -3, full_width: 640, full_height: 480 });
    assert_same(&image, &read(&encode(&image, &WriteOptions::default()).unwrap()), |_| 0.0);
}

#[test]
fn parts_with_other_windows_and_types_are_joined() {
    let layer = |name: &str, corner: (i32, i32), channel: &str, samples: FlatSamples| {
        let attributes = LayerAttributes::named(name).with_position(Vec2(corner.0, corner.1));
        let channels = AnyChannels::sort([AnyChannel::new(channel, samples)].into_iter().collect());
        Layer::new((2, 2), attributes, Encoding::FAST_LOSSLESS, channels)
    };
    let parts = [
        layer("beauty", (10, 10), "Y", FlatSamples::F16(vec![f16::ONE; 4])),
        layer("ids", (11, 11), "id", FlatSamples::U32(vec![7, 8, 9, 10])),
        layer("depth", (10, 10), "depth.Z", FlatSamples::F32(vec![0.25; 4])),
    ];
    let display = ImageAttributes::new(IntegerBounds::from_dimensions((20, 20)));
    let file = exr::image::Image::from_layers(display, exr::image::Layers::from_iter(parts));
    let mut out = std::io::Cursor::new(Vec::new());
    file.write().to_buffered(&mut out).unwrap();

    let image = read(&out.into_inner());
    assert_eq!((image.width(), image.height()), (3, 3));
    assert_eq!(image.channels(), ["Y", "depth.Z", "ids.id"]);
    assert_eq!(image.window, Some(Window { x: 10, y: 10, full_width: 20, full_height: 20 }));
    assert_eq!(image.pixel(0, 0), [1.0, 0.25, 0.0]);
    assert_eq!(image.pixel(1, 1), [1.0, 0.25, 7.0]);
    assert_eq!(image.pixel(2, 2), [0.0, 0.0, 10.0]);
    assert!(image.is_grey());
}

#[test]
fn tiles_and_every_lossless_compression_are_read() {
    use exr::image::Blocks::{ScanLines, Tiles};
    use exr::prelude::{Compression::*, LineOrder};
    let value = |x: usize, y: usize| (x as f32 * 0.1, y as f32, (x * y) as f32);
    for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ] {
        for blocks in [ScanLines, Tiles(Vec2(16, 8))] {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Decreasing };
            let channels = SpecificChannels::rgb(|at: Vec2<usize>| value(at.0, at.1));
            let layer = Layer::new((45, 70), LayerAttributes::default(), encoding, channels);
            let mut out = std::io::Cursor::new(Vec::new());
            exr::image::Image::from_layer(layer).write().to_buffered(&mut out).unwrap();
            let image = read(&out.into_inner());
            for (x, y) in [(0, 0), (44, 69), (17, 3), (16, 64)] {
                assert_eq!(image.rgb(x, y), <[f32; 3]>::from(value(x, y)), "{compression:?} {blocks:?}");
            }
        }
    }
    assert_eq!(Sample::default().to_f32(), 0.0);
}

#[test]
fn names_that_a_file_cannot_hold_are_errors() {
    for name in ["", "a\0b"] {
        let image = Image::new(1, 1, &[name]);
        assert!(encode(&image, &WriteOptions::default()).is_err());
    }
}
