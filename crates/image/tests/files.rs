//! Files of every format: round trips, truncation, limits, messages.

use std::path::Path;

use aureole_image::{
    Attribute, BitDepth, Bitmap, Encoding, Format, Image, ImageError, ImageLimits, Precision, ToneMapping,
    WriteOptions, decode_bitmap, decode_image, encode, metric, read_bitmap, read_image, write_atomically,
    write_image,
};
use proptest::prelude::*;

/// Smooth colours with some beyond white.
fn sample(width: usize, height: usize) -> Image {
    let pixels: Vec<_> = (0..width * height)
        .map(|i| {
            let (x, y) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
            [x * 1.2, y, 0.25 + 0.5 * x * y]
        })
        .collect();
    Image::from_rgb(width, height, &pixels).expect("as many pixels as asked for")
}

/// `sample` in every form that can be written: a name for messages, the suffix and the options.
fn every_form() -> Vec<(&'static str, Format, WriteOptions)> {
    let plain = WriteOptions::default();
    vec![
        ("exr float", Format::Exr, plain),
        ("exr half", Format::Exr, WriteOptions { precision: Precision::Half, ..plain }),
        ("png 8", Format::Png, plain),
        ("png 16", Format::Png, WriteOptions { bit_depth: BitDepth::Sixteen, ..plain }),
        ("ppm 8", Format::Ppm, plain),
        ("ppm 16", Format::Ppm, WriteOptions { bit_depth: BitDepth::Sixteen, ..plain }),
        ("jpeg", Format::Jpeg, plain),
        ("hdr", Format::Hdr, plain),
        ("pfm", Format::Pfm, plain),
    ]
}

#[test]
fn every_format_round_trips() {
    let image = sample(31, 17);
    for (name, format, options) in every_form() {
        let bytes = encode(&image, format, &options).unwrap();
        let path = Path::new("image").with_extension(format.suffix());
        let back = decode_image(&bytes, &path, &ImageLimits::default()).unwrap();
        assert_eq!((back.width(), back.height()), (31, 17), "{name}");
        // What the format's numbers can tell apart, in display values for those of whole numbers.
        let (tolerance, is_display) = match name {
            "exr float" | "pfm" => (0.0, false),
            "exr half" => (1.5 / 2048.0, false),
            "hdr" => (1.5 / 128.0, false),
            "png 8" | "ppm 8" => (0.51 / 255.0, true),
            "png 16" | "ppm 16" => (0.51 / 65535.0, true),
            _ => (6.0 / 255.0, true),
        };
        let tone = ToneMapping::default();
        for (a, b) in image.to_rgb().into_iter().zip(back.to_rgb()) {
            let (a, b) = if is_display { (tone.apply(a), tone.apply(b)) } else { (a, b) };
            let scale = if name == "hdr" { a[0].max(a[1]).max(a[2]) } else { 1.0 };
            for c in 0..3 {
                assert!((a[c] - b[c]).abs() <= tolerance * scale + 1e-6, "{name}: {a:?} became {b:?}");
            }
        }
    }
}

#[test]
fn bitmaps_agree_with_images() {
    let image = sample(9, 5);
    for (name, format, options) in every_form() {
        let bytes = encode(&image, format, &options).unwrap();
        let path = Path::new("image").with_extension(format.suffix());
        let whole = decode_image(&bytes, &path, &ImageLimits::default()).unwrap();
        let bitmap = decode_bitmap(&bytes, &path, Encoding::Auto, &ImageLimits::default()).unwrap();
        for (x, y) in [(0, 0), (8, 0), (4, 2), (8, 4)] {
            assert_eq!(bitmap.rgb(x, y), whole.rgb(x, y), "{name}");
        }
        let bits = bitmap.memory() * 8 / (9 * 5 * 3);
        let expected = if name.ends_with("16") || name.ends_with("half") {
            16
        } else if matches!(name, "exr float" | "pfm" | "hdr") {
            32
        } else {
            8
        };
        assert_eq!(bits, expected, "{name} is kept as small as its file");
    }
}

#[test]
fn png_keeps_alpha() {
    let names = ["R", "G", "B", "A"].map(str::to_owned).to_vec();
    let image = Image::from_data(1, 2, names, vec![0.2, 0.1, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0]).unwrap();
    for bit_depth in [BitDepth::Eight, BitDepth::Sixteen] {
        let options = WriteOptions { bit_depth, ..Default::default() };
        let bytes = encode(&image, Format::Png, &options).unwrap();
        let back = decode_image(&bytes, Path::new("a.png"), &ImageLimits::default()).unwrap();
        for (a, b) in image.data().iter().zip(back.data()) {
            assert!((a - b).abs() < 0.005, "{a} became {b}");
        }
        let bitmap =
            decode_bitmap(&bytes, Path::new("a.png"), Encoding::Auto, &ImageLimits::default()).unwrap();
        assert!((bitmap.texel(0, 0)[0] - 0.4).abs() < 0.005, "a bitmap's colours are beside its alpha");
    }
}

/// A cut file is an error, unless only the trailer is missing; JPEG decoders, by custom, make up grey for lost rows.
#[test]
fn truncated_files_are_errors() {
    for (name, format, options) in every_form() {
        let bytes = encode(&sample(40, 23), format, &options).unwrap();
        let path = Path::new("cut").with_extension(format.suffix());
        let whole = decode_image(&bytes, &path, &ImageLimits::default()).unwrap();
        for length in (0..bytes.len()).step_by(if bytes.len() > 20_000 { 64 } else { 16 }) {
            match decode_image(&bytes[..length], &path, &ImageLimits::default()) {
                Err(error) => assert!(!error.is_io(), "{name} cut at {length}: {error}"),
                Ok(image) => {
                    assert_eq!((image.width(), image.height()), (40, 23), "{name} cut at {length}");
                    assert!(
                        format == Format::Jpeg || image == whole,
                        "{name} cut at {length} is taken for whole"
                    );
                }
            }
        }
    }
}

#[test]
fn limits_hold_for_every_format() {
    for (name, format, options) in every_form() {
        let bytes = encode(&sample(40, 23), format, &options).unwrap();
        let path = Path::new("big").with_extension(format.suffix());
        let few_pixels = ImageLimits { max_pixels: 900, ..Default::default() };
        let error = decode_image(&bytes, &path, &few_pixels).unwrap_err();
        assert!(error.is_limit() && error.to_string().contains("900"), "{name}: {error}");
        let few_bytes = ImageLimits { max_bytes: 500, ..Default::default() };
        assert!(decode_image(&bytes, &path, &few_bytes).is_err(), "{name}");
    }
}

#[test]
fn files_are_written_whole_and_known_by_their_content() {
    let folder = tempfile::tempdir().unwrap();
    let image = sample(8, 8);
    let path = folder.path().join("image.PNG");
    write_image(&image, &path, &WriteOptions::default()).unwrap();
    // The name lies, the content does not.
    let liar = folder.path().join("image.exr");
    std::fs::rename(&path, &liar).unwrap();
    let bitmap: Bitmap = read_bitmap(&liar, Encoding::Auto, &ImageLimits::default()).unwrap();
    assert_eq!((bitmap.width(), bitmap.height(), bitmap.channels()), (8, 8, 3));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file stays behind");
}

#[test]
fn errors_tell_the_machine_from_the_content() {
    let limits = ImageLimits::default();
    let missing = read_image(Path::new("/no/such/file.png"), &limits).unwrap_err();
    assert!(missing.is_io() && missing.to_string().contains("/no/such/file.png"));

    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("text.png");
    std::fs::write(&text, "this is not a picture").unwrap();
    let wrong = read_image(&text, &limits).unwrap_err();
    assert!(matches!(wrong, ImageError::Decode { .. }) && !wrong.is_io());

    let image = sample(2, 2);
    let error = write_image(&image, &folder.path().join("out.jgp"), &WriteOptions::default()).unwrap_err();
    assert!(error.to_string().contains("did you mean `jpg`?"), "{error}");
    let error = write_image(&image, &folder.path().join("out.tga"), &WriteOptions::default()).unwrap_err();
    let listed = error.to_string().split("known:").last().unwrap_or_default().to_owned();
    assert!(listed.contains("png") && !listed.contains("tga"), "{error}");
    let nowhere = folder.path().join("no/folder/out.png");
    assert!(write_image(&image, &nowhere, &WriteOptions::default()).unwrap_err().is_io());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_io_error() {
    let bytes = encode(&sample(64, 64), Format::Png, &WriteOptions::default()).unwrap();
    let error = write_atomically(Path::new("/dev/full"), &bytes).unwrap_err();
    assert!(error.is_io(), "{error}");
}

#[test]
fn an_image_without_pixels_is_an_error() {
    for image in [Image::new(0, 0, &["R", "G", "B"]), Image::new(4, 4, &[])] {
        for (name, format, options) in every_form() {
            assert!(matches!(encode(&image, format, &options), Err(ImageError::Encode { .. })), "{name}");
        }
        assert!(metric::compare(&image, &image).is_err());
    }
}

#[test]
fn values_that_are_not_finite_are_written_without_a_panic() {
    let image =
        Image::from_rgb(2, 1, &[[f32::NAN, f32::INFINITY, -1.0], [f32::NEG_INFINITY, 1e38, 0.0]]).unwrap();
    for (name, format, options) in every_form() {
        let bytes = encode(&image, format, &options).unwrap();
        let path = Path::new("a").with_extension(format.suffix());
        assert!(decode_image(&bytes, &path, &ImageLimits::default()).is_ok(), "{name}");
    }
    assert_eq!(image.count_non_finite(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..Default::default() })]

    /// Whatever bits an image holds, EXR and PFM bring them back, and metadata with them.
    #[test]
    fn float_formats_keep_every_bit(
        width in 1_usize..40,
        height in 1_usize..40,
        bits in proptest::collection::vec(any::<u32>(), 1..64),
        note in "[ -~]{0,40}",
    ) {
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| std::array::from_fn(|c| f32::from_bits(bits[(3 * i + c) % bits.len()])))
            .collect();
        let mut image = Image::from_rgb(width, height, &pixels).expect("as many pixels as asked for");
        image.metadata.insert("note".into(), Attribute::Text(note));
        for format in [Format::Exr, Format::Pfm] {
            let bytes = encode(&image, format, &WriteOptions::default()).unwrap();
            let back = decode_image(&bytes, Path::new("a"), &ImageLimits::default()).unwrap();
            let same = image.data().iter().zip(back.data()).all(|(a, b)| a.to_bits() == b.to_bits());
            prop_assert!(same, "{:?}", format);
            prop_assert!(format != Format::Exr || back.metadata == image.metadata);
        }
    }

    /// Flipped bits give an error or an image, never a panic or a hang.
    #[test]
    fn damaged_files_do_no_harm(form in 0_usize..9, flips in proptest::collection::vec(any::<(u16, u8)>(), 1..20)) {
        let (_, format, options) = every_form()[form];
        let mut bytes = encode(&sample(24, 16), format, &options).unwrap();
        let length = bytes.len();
        for (position, value) in flips {
            bytes[usize::from(position) % length] ^= value;
        }
        let limits = ImageLimits { max_pixels: 1 << 20, max_bytes: 1 << 26 };
        let _ = decode_image(&bytes, &Path::new("a").with_extension(format.suffix()), &limits);
    }
}
