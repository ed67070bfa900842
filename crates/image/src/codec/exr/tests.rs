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

/// Parts of a file: name, corner, channel and its four samples.
fn parts(parts: &[(&str, (i32, i32), &str, FlatSamples)]) -> Image {
    let layer = |name: &str, corner: (i32, i32), channel: &str, samples: FlatSamples| {
        let attributes = LayerAttributes::named(name).with_position(Vec2(corner.0, corner.1));
        let channels = AnyChannels::sort([AnyChannel::new(channel, samples)].into_iter().collect());
        Layer::new((2, 2), attributes, Encoding::FAST_LOSSLESS, channels)
    };
    let parts = parts.iter().map(|(name, corner, channel, data)| layer(name, *corner, channel, data.clone()));
    let display = ImageAttributes::new(IntegerBounds::from_dimensions((20, 20)));
    let file = exr::image::Image::from_layers(display, exr::image::Layers::from_iter(parts));
    let mut out = std::io::Cursor::new(Vec::new());
    file.write().to_buffered(&mut out).unwrap();

    read(&out.into_inner())
}

/// The picture is as large as its own part, and others are cut to it.
#[test]
fn parts_with_other_windows_and_types_are_joined() {
    let image = parts(&[
        ("beauty", (10, 10), "Y", FlatSamples::F16(vec![f16::ONE; 4])),
        ("ids", (11, 11), "id", FlatSamples::U32(vec![7, 8, 9, 10])),
        ("depth", (9, 10), "depth.Z", FlatSamples::F32(vec![0.25, 0.5, 0.25, 0.5])),
    ]);
    assert_eq!((image.width(), image.height()), (2, 2));
    assert_eq!(image.channels(), ["Y", "depth.Z", "ids.id"]);
    assert_eq!(image.window, Some(Window { x: 10, y: 10, full_width: 20, full_height: 20 }));
    assert_eq!(image.data(), [1.0, 0.5, 0.0, 1.0, 0.0, 0.0, 1.0, 0.5, 0.0, 1.0, 0.0, 7.0]);
    assert!(image.is_grey());
}

/// A part of depths before that of the picture does not take its place, nor its names.
#[test]
fn the_picture_may_be_in_a_later_part() {
    let image = parts(&[
        ("depth", (0, 0), "Z", FlatSamples::F32(vec![9.0; 4])),
        ("beauty", (3, 3), "Y", FlatSamples::F32(vec![0.5; 4])),
    ]);
    assert_eq!(image.channels(), ["Y", "depth.Z"]);
    assert_eq!(image.data(), [0.5, 0.0, 0.5, 0.0, 0.5, 0.0, 0.5, 0.0]);
}

/// An uncompressed file of one colour, 6 by 4 pixels: luminance, and chroma with a quarter of its samples. It is put together by
/// hand, for the crate cannot write such files.
fn luminance_and_chroma(y: f32, ry: f32, by: f32, chromaticities: Option<[f32; 8]>) -> Vec<u8> {
    let words = |list: &[i32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let channel =
        |(name, step): &(&str, i32)| [name.as_bytes(), &[0], &words(&[2, 0, *step, *step])].concat();
    let mut channels: Vec<u8> = [("BY", 2), ("RY", 2), ("Y", 1)].iter().flat_map(channel).collect();
    channels.push(0);
    let window = words(&[0, 0, 5, 3]);
    let mut attributes = vec![
        ("channels", "chlist", channels),
        ("compression", "compression", vec![0]),
        ("dataWindow", "box2i", window.clone()),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", vec![0]),
        ("pixelAspectRatio", "float", floats(&[1.0])),
        ("screenWindowCenter", "v2f", floats(&[0.0, 0.0])),
        ("screenWindowWidth", "float", floats(&[1.0])),
    ];
    attributes.extend(chromaticities.map(|list| ("chromaticities", "chromaticities", floats(&list))));
    let mut out = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    for (name, kind, value) in attributes {
        out.extend([name.as_bytes(), &[0], kind.as_bytes(), &[0], &words(&[value.len() as i32])].concat());
        out.extend(value);
    }
    out.push(0);
    let lines: Vec<Vec<u8>> = (0..4)
        .map(|row| {
            let chroma = if row % 2 == 0 { [[by; 3], [ry; 3]].concat() } else { Vec::new() };
            let samples = floats(&[chroma, vec![y; 6]].concat());
            [words(&[row, samples.len() as i32]), samples].concat()
        })
        .collect();
    let mut at = out.len() + 8 * lines.len();
    for line in &lines {
        out.extend((at as u64).to_le_bytes());
        at += line.len();
    }
    out.extend(lines.concat());
    out
}

/// R = (RY + 1) Y, B = (BY + 1) Y, and Y by the file's primaries.
#[test]
fn luminance_and_chroma_become_colours() {
    let [r, g, b] = [0.5, 0.4, 0.2];
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let image = read(&luminance_and_chroma(y, r / y - 1.0, b / y - 1.0, None));
    assert_eq!((image.width(), image.height()), (6, 4));
    for found in image.to_rgb() {
        assert!((0..3).all(|i| (found[i] - [r, g, b][i]).abs() < 1e-4), "{found:?}");
    }
    // A grey of other primaries is grey still.
    let acescg = [0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767];
    let image = read(&luminance_and_chroma(0.25, 0.0, 0.0, Some(acescg)));
    assert!(image.rgb(5, 3).iter().all(|x| (x - 0.25).abs() < 1e-4), "{:?}", image.rgb(5, 3));
}

/// By the published matrix from ACEScg to Rec. 709 with Bradford's adaptation. Layers stay as they are.
#[test]
fn other_primaries_are_converted() {
    let mut image = Image::new(1, 1, &["R", "G", "B", "N.R", "N.G", "N.B"]);
    image.data_mut().copy_from_slice(&[0.45, 0.4, 0.35, 0.45, 0.4, 0.35]);
    for precision in [Precision::Float, Precision::Half] {
        let plain = encode(&image, &WriteOptions { precision, ..Default::default() }).unwrap();
        // The attribute is put in front of the others.
        let mut record = b"chromaticities\0chromaticities\0\x20\0\0\0".to_vec();
        let acescg: [f32; 8] = [0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767];
        record.extend(acescg.iter().flat_map(|x| x.to_le_bytes()));
        let mut bytes = plain.clone();
        bytes.splice(8..8, record.iter().copied());
        // What follows the header moves, and the table of its blocks with it.
        let table = bytes.len() - (plain.len() - table_of(&plain));
        let offset = u64::from_le_bytes(bytes[table..table + 8].try_into().unwrap());
        bytes[table..table + 8].copy_from_slice(&(offset + record.len() as u64).to_le_bytes());
        let back = read(&bytes);
        let pixel = back.pixel(0, 0);
        let place = |name| back.channel(name).unwrap();
        for (name, expected) in [("R", 0.4894), ("G", 0.3940), ("B", 0.3411), ("N.R", 0.45), ("N.B", 0.35)] {
            assert!((pixel[place(name)] - expected).abs() < 2e-3, "{name}: {pixel:?}");
        }
    }
}

/// Where the table of blocks of a file of one block starts: it holds the place of what follows it.
fn table_of(file: &[u8]) -> usize {
    (0..file.len() - 8).find(|&i| file[i..i + 8] == (i as u64 + 8).to_le_bytes()).unwrap()
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
