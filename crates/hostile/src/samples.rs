//! Good files of every format, small and made here: what damage starts from.

use std::io::{Cursor, Write};

use aureole::formats::GALLERY;
use aureole::image::{BitDepth, Format, Image, Precision, WriteOptions, encode};
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use image::{DynamicImage, ImageFormat};

use crate::film;

/// A file: its name and content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// What tells it from the others, fit for a file name.
    pub name: String,
    /// The content.
    pub bytes: Vec<u8>,
}

/// Samples for the target of that name; none for a name without a target.
pub fn of(target: &str) -> Vec<Sample> {
    match target {
        "pbrt" | "pbrt_render" => {
            let everything = without_files(include_str!("../../formats/tests/data/everything.pbrt"));
            let features = include_str!("../samples/features.pbrt");
            texts(&gallery("pbrt"), &[("features", features), ("everything", &everything)])
        }
        "mitsuba" | "mitsuba_render" => {
            let features = include_str!("../samples/features.xml");
            let elements = include_str!("../samples/elements.xml");
            texts(&gallery("mitsuba"), &[("features", features), ("elements", elements)])
        }
        "ply" => vec![
            sample("ascii", include_bytes!("../samples/quad.ply")),
            sample("scan", include_bytes!("../samples/scan.ply")),
            sample("little", &ply("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes)),
            sample("big", &ply("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes)),
        ],
        "obj" => vec![
            sample("parts", include_bytes!("../samples/parts.obj")),
            sample("words", include_bytes!("../samples/words.obj")),
        ],
        "mtl" => vec![
            sample("library", include_bytes!("../samples/library.mtl")),
            sample("words", include_bytes!("../samples/words.mtl")),
        ],
        "serialized" => vec![sample("version-3", &serialized(3)), sample("version-4", &serialized(4))],
        "vol" => vec![sample("ball", &vol())],
        "brdf" => vec![sample("rgl", &rgl()), sample("merl", &merl())],
        "ies" => vec![
            sample("half", include_bytes!("../samples/half.ies")),
            sample("tilted", include_bytes!("../samples/tilted.ies")),
        ],
        "curves" => vec![sample("two", include_bytes!("../samples/two.curves"))],
        "spectrum" => vec![sample("lamp", include_bytes!("../samples/lamp.spd"))],
        "film" => film::samples(),
        "gzip" => {
            vec![sample("scene", &gzip(GALLERY[0].text.as_bytes())), sample("plain", b"no gzip at all")]
        }
        "image" => images(),
        "wild" => (0..16u8).map(|i| sample(&format!("seed-{i}"), &wild_seed(i))).collect(),
        _ => Vec::new(),
    }
}

pub(crate) fn sample(name: &str, bytes: &[u8]) -> Sample {
    Sample { name: name.to_owned(), bytes: bytes.to_vec() }
}

fn texts(lists: &[(&str, &str)], more: &[(&str, &str)]) -> Vec<Sample> {
    lists.iter().chain(more).map(|(name, text)| sample(name, text.as_bytes())).collect()
}

/// A pbrt scene without the lines that ask for files which must be there.
fn without_files(text: &str) -> String {
    let asks = |line: &&str| [".pbrt\"", ".ply\"", ".ies\""].iter().any(|suffix| line.contains(suffix));
    text.lines().filter(|line| !asks(line)).flat_map(|line| [line, "\n"]).collect()
}

fn gallery(format: &str) -> Vec<(&'static str, &'static str)> {
    GALLERY.iter().filter(|scene| scene.format == format).map(|scene| (scene.name, scene.text)).collect()
}

/// Bytes from which `wild` draws its choices.
fn wild_seed(i: u8) -> Vec<u8> {
    (0..192u8).map(|k| k.wrapping_mul(37).wrapping_add(i.wrapping_mul(91)) ^ k >> 3).collect()
}

/// A file as gzip packs it.
pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    packed(encoder.write_all(bytes).and_then(|()| encoder.finish()))
}

/// Writing to memory does not fail.
fn packed(result: std::io::Result<Vec<u8>>) -> Vec<u8> {
    result.unwrap_or_default()
}

/// A quadrilateral and a triangle with normals, texture coordinates and colours.
fn ply(encoding: &str, float: fn(f32) -> [u8; 4], int: fn(i32) -> [u8; 4]) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat {encoding} 1.0\ncomment a quadrilateral and a triangle\nelement vertex 5\n\
         property float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.5]] {
        file.extend([x, y, 0.0, 0.0, 0.0, 1.0, x, y].into_iter().flat_map(float));
        file.extend([200, 100, 50]);
    }
    for face in [&[0, 1, 2, 3][..], &[1, 4, 2]] {
        file.push(face.len() as u8);
        file.extend(face.iter().flat_map(|&i| int(i)));
    }
    file
}

/// Two meshes, the second in double precision (see `formats::mesh::serialized`).
fn serialized(version: u16) -> Vec<u8> {
    const MAGIC: u16 = 0x041C;
    let (mut file, mut offsets) = (Vec::new(), Vec::new());
    for (flags, name) in [(0x1003u32, "first"), (0x2018, "second")] {
        let mut body = flags.to_le_bytes().to_vec();
        if version == 4 {
            body.extend(name.bytes().chain([0]));
        }
        body.extend([3u64, 1].iter().flat_map(|n| n.to_le_bytes()));
        let has_normals = flags & 1 != 0;
        let numbers = if has_normals { 3 * (3 + 3 + 2) } else { 3 * (3 + 3) };
        for i in 0..numbers {
            let value = f64::from(i * i % 7) / 8.0;
            match flags & 0x2000 {
                0 => body.extend((value as f32).to_le_bytes()),
                _ => body.extend(value.to_le_bytes()),
            }
        }
        body.extend([0u32, 2, 1].iter().flat_map(|n| n.to_le_bytes()));
        offsets.push(file.len());
        file.extend(MAGIC.to_le_bytes().iter().chain(&version.to_le_bytes()));
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        file.extend(packed(encoder.write_all(&body).and_then(|()| encoder.finish())));
    }
    for offset in &offsets {
        match version {
            4 => file.extend((*offset as u64).to_le_bytes()),
            _ => file.extend((*offset as u32).to_le_bytes()),
        }
    }
    file.extend((offsets.len() as u32).to_le_bytes());
    file
}

/// Signed distances from a ball on a grid of 4 × 4 × 4 points.
fn vol() -> Vec<u8> {
    let mut file = b"VOL\x03".to_vec();
    file.extend([1i32, 4, 4, 4, 1].iter().flat_map(|n| n.to_le_bytes()));
    file.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().flat_map(|x| x.to_le_bytes()));
    for i in 0..64 {
        let [x, y, z] = [i % 4, i / 4 % 4, i / 16].map(|k| k as f32 / 3.0 - 0.5);
        file.extend(((x * x + y * y + z * z).sqrt() - 0.4).to_le_bytes());
    }
    file
}

/// A measured reflectance as RGL writes it: fields of floats in a tensor file.
fn rgl() -> Vec<u8> {
    const FIELDS: [(&str, &[u64]); 7] = [
        ("phi_i", &[1]),
        ("theta_i", &[2]),
        ("ndf", &[2, 2]),
        ("sigma", &[2, 2]),
        ("vndf", &[1, 2, 2, 2]),
        ("luminance", &[1, 2, 2, 2]),
        ("rgb", &[1, 2, 3, 2, 2]),
    ];
    let header_size = |(name, shape): &(&str, &[u64])| 2 + name.len() + 2 + 1 + 8 + 8 * shape.len();
    let mut file = b"tensor_file\0\x01\0".to_vec();
    file.extend((FIELDS.len() as u32).to_le_bytes());
    let mut offset = file.len() + FIELDS.iter().map(header_size).sum::<usize>();
    let mut data: Vec<u8> = Vec::new();
    for (name, shape) in FIELDS {
        file.extend((name.len() as u16).to_le_bytes());
        file.extend(name.bytes());
        file.extend((shape.len() as u16).to_le_bytes());
        file.push(10); // 32-bit floats
        file.extend((offset as u64).to_le_bytes());
        file.extend(shape.iter().flat_map(|n| n.to_le_bytes()));
        let count = shape.iter().product::<u64>() as usize;
        data.extend((0..count).flat_map(|i| (0.2 + 0.7 * i as f32 / count as f32).to_le_bytes()));
        offset += 4 * count;
    }
    file.extend(data);
    file
}

/// A measured reflectance as MERL writes it, with two steps of each angle.
fn merl() -> Vec<u8> {
    let size = [2i32; 3].iter().flat_map(|n| n.to_le_bytes());
    size.chain((0..24).flat_map(|i| f64::from(100 + i).to_le_bytes())).collect()
}

/// A picture in every format that can be read.
fn images() -> Vec<Sample> {
    let (width, height) = (19, 13);
    let pixels: Vec<_> = (0..width * height).map(|i| [i as f32 / 247.0, 0.5, (i % 7) as f32 / 6.0]).collect();
    let mut files = Vec::new();
    let plain = WriteOptions::default();
    for (name, format, options) in [
        ("exr", Format::Exr, plain),
        ("exr-half", Format::Exr, WriteOptions { precision: Precision::Half, ..plain }),
        ("png", Format::Png, plain),
        ("png-16", Format::Png, WriteOptions { bit_depth: BitDepth::Sixteen, ..plain }),
        ("jpeg", Format::Jpeg, plain),
        ("hdr", Format::Hdr, plain),
        ("pfm", Format::Pfm, plain),
        ("ppm", Format::Ppm, plain),
    ] {
        let picture = Image::from_rgb(width, height, &pixels);
        files.extend(
            picture.and_then(|p| encode(&p, format, &options).ok()).map(|bytes| sample(name, &bytes)),
        );
    }
    let bytes: Vec<u8> = pixels.iter().flatten().map(|x| (x * 255.0) as u8).collect();
    let picture = image::RgbImage::from_raw(width as u32, height as u32, bytes).map(DynamicImage::ImageRgb8);
    for (name, format) in [
        ("bmp", ImageFormat::Bmp),
        ("tiff", ImageFormat::Tiff),
        ("webp", ImageFormat::WebP),
        ("tga", ImageFormat::Tga),
    ] {
        let mut file = Cursor::new(Vec::new());
        if picture.as_ref().is_some_and(|p| p.write_to(&mut file, format).is_ok()) {
            files.push(sample(name, &file.into_inner()));
        }
    }
    files
}

#[cfg(test)]
mod tests {
    use aureole::desc::{Report, Sources};
    use aureole::formats::load_text;

    use crate::targets;

    /// Damage to a scene that is refused anyway would show nothing.
    #[test]
    fn sample_scenes_are_read_without_an_error() {
        for (target, format) in [("pbrt", "pbrt"), ("mitsuba", "mitsuba")] {
            for sample in super::of(target) {
                let text = String::from_utf8(sample.bytes).unwrap();
                let (mut sources, mut report) = (Sources::default(), Report::default());
                let read = load_text(format, "scene", &text, &Default::default(), &mut sources, &mut report);
                assert!(read.is_ok() && report.errors.is_empty(), "{}: {read:?} {report:?}", sample.name);
            }
        }
    }

    #[test]
    fn every_target_has_samples_and_every_image_format_is_among_them() {
        for target in targets::ALL {
            assert!(!super::of(target.name).is_empty(), "{}", target.name);
        }
        assert_eq!(super::of("image").len(), 12);
    }
}
