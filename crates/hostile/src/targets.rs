//! One function a reader: whatever bytes it is given, it returns.
//!
//! A target panics where a reader breaks its promise: where it panics itself, where an error says no place, or where what
//! it delivers contradicts itself. Hangs and memory are for the driver to notice.

use std::path::Path;

use aureole::desc::{
    Family, Limits, Mesh, Node, Params, Report, SceneDesc, SceneError, Sources, Span, Value,
};
use aureole::formats::mesh::{MeshError, curves, ies, obj, ply, serialized, vol};
use aureole::formats::{LoadOptions, brdf, file, load_text, spectrum_file};
use aureole::image::{Encoding, ImageLimits, decode_bitmap, decode_image};
use aureole::render::{RenderOptions, Silent, render};
use aureole::scene::{CompileOptions, Scene, compile};

use crate::{film, wild};

/// A reader under test.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name, which is also that of its fuzz target and of its [`samples`](crate::samples::of).
    pub name: &'static str,
    run: fn(&[u8]),
}

impl Target {
    /// Gives the reader these bytes.
    ///
    /// # Panics
    /// Where the reader breaks its promise.
    pub fn check(&self, bytes: &[u8]) {
        (self.run)(bytes);
    }
}

/// All targets.
pub const ALL: &[Target] = &[
    Target { name: "pbrt", run: |bytes| drop(read("pbrt", bytes)) },
    Target { name: "mitsuba", run: |bytes| drop(read("mitsuba", bytes)) },
    Target { name: "ply", run: |bytes| check_mesh(ply::decode(bytes, &LIMITS).map(|file| file.mesh)) },
    Target { name: "obj", run: check_obj },
    Target { name: "mtl", run: |bytes| drop(obj::parse_materials(&String::from_utf8_lossy(bytes))) },
    Target { name: "serialized", run: check_serialized },
    Target { name: "vol", run: check_vol },
    Target { name: "brdf", run: check_brdf },
    Target { name: "ies", run: check_ies },
    Target { name: "curves", run: check_curves },
    Target { name: "spectrum", run: check_spectrum },
    Target { name: "film", run: film::check },
    Target { name: "gzip", run: check_gzip },
    Target { name: "image", run: check_image },
    Target { name: "pbrt_render", run: |bytes| check_scene("pbrt", bytes) },
    Target { name: "mitsuba_render", run: |bytes| check_scene("mitsuba", bytes) },
    Target { name: "wild", run: |bytes| first_samples(wild::describe(bytes)) },
];

/// The target of that name.
pub fn find(name: &str) -> Option<&'static Target> {
    ALL.iter().find(|target| target.name == name)
}

/// Small, so that a fuzzer does not spend its time on filling memory.
const LIMITS: Limits = Limits {
    max_file_bytes: 1 << 24,
    max_files: 16,
    max_include_depth: 4,
    max_nesting: 64,
    max_params: 64,
    max_evaluations: 1 << 10,
    max_mesh_elements: 1 << 16,
    max_pixels: 1 << 18,
    max_unpack_ratio: 100,
};

/// Reads a scene. Text that a file gives is never invalid UTF-8: the door of all files mends it.
fn read(format: &str, bytes: &[u8]) -> Option<SceneDesc> {
    let text = String::from_utf8_lossy(bytes);
    let options = LoadOptions { limits: LIMITS, ..LoadOptions::default() };
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let result = load_text(format, "nowhere/scene", &text, &options, &mut sources, &mut report);
    report.errors.iter().for_each(check_place);
    match result {
        Ok(desc) => report.errors.is_empty().then_some(desc),
        Err(error) => {
            check_place(&error);
            None
        }
    }
}

/// Every error about a file says where it is, or at least which file it is about.
fn check_place(error: &SceneError) {
    let names_a_file = matches!(error, SceneError::Read { .. } | SceneError::Asset { .. });
    assert!(names_a_file || !error.span().is_none(), "no place: {error}");
}

fn check_scene(format: &str, bytes: &[u8]) {
    if let Some(desc) = read(format, bytes) {
        first_samples(desc);
    }
}

/// Compiles a scene and draws a sample for each of a few pixels.
fn first_samples(mut desc: SceneDesc) {
    for (path, value) in [("film.width", "4"), ("film.height", "4")] {
        let set = desc.set(path, value);
        assert!(set.is_ok(), "the film can always be set: {set:?}");
    }
    if let Some(film) = desc.film {
        for name in ["crop_x", "crop_y", "crop_width", "crop_height"] {
            desc[film].params.remove(name);
        }
    }
    let mut report = Report::default();
    let options = CompileOptions { limits: LIMITS, ..CompileOptions::default() };
    let Ok(scene) = compile(&desc, &options, &mut report) else { return };
    draw(&scene);
}

fn draw(scene: &Scene) {
    let options = RenderOptions { spp: Some(1), threads: 1, ..RenderOptions::default() };
    if let Ok(rendered) = render(scene, &options, &Silent) {
        let values = rendered.image.data();
        assert!(values.iter().all(|x| x.is_finite()), "what is not finite is left out of the image");
    }
}

fn check_mesh(mesh: Result<Mesh, MeshError>) {
    if let Ok(mesh) = mesh {
        // Readers may leave the last check of indices to the mesh itself; it must not panic either.
        let _ = mesh.check();
    }
}

fn check_obj(bytes: &[u8]) {
    for split in [obj::Split::Nothing, obj::Split::Parts] {
        if let Ok(file) = obj::ObjFile::parse(bytes, split, &LIMITS) {
            for part in file.parts {
                let checked = part.mesh.check();
                assert!(checked.is_ok(), "{checked:?}");
            }
        }
    }
}

fn check_serialized(bytes: &[u8]) {
    for index in 0..2 {
        if let Ok(read) = serialized::decode(bytes, index, &LIMITS) {
            let checked = read.mesh.check();
            assert!(checked.is_ok(), "{checked:?}");
        }
    }
}

fn check_vol(bytes: &[u8]) {
    if let Ok(grid) = vol::decode(bytes, &LIMITS) {
        assert_eq!(grid.values.len(), grid.resolution.iter().product::<usize>() * grid.channels);
    }
}

/// A measured reflectance must also survive being rendered.
fn check_brdf(bytes: &[u8]) {
    let Ok((kind, params)) = brdf::decode(bytes, &LIMITS) else { return };
    let mut desc = SceneDesc::default();
    let bsdf = desc.add(Node::new(Family::Bsdf, kind, params, Span::NONE));
    let params = Params::new().with("bsdf", Value::Node(bsdf));
    let ball = desc.add(Node::new(Family::Shape, "sphere", params, Span::NONE));
    let sky = desc.add(Node::new(Family::Light, "constant", Params::new(), Span::NONE));
    desc.shapes.push(ball);
    desc.lights.push(sky);
    first_samples(desc);
}

/// A lamp's profile must also make a lamp.
fn check_ies(bytes: &[u8]) {
    let Ok(profile) = ies::decode(&String::from_utf8_lossy(bytes), &LIMITS) else { return };
    assert_eq!(profile.candela.len(), profile.vertical.len() * profile.horizontal.len());
    assert!(profile.candela.iter().all(|c| c.is_finite()), "{:?}", profile.candela);
    let params = Params::new()
        .with("vertical", Value::Floats(profile.vertical.into()))
        .with("horizontal", Value::Floats(profile.horizontal.into()))
        .with("candela", Value::Floats(profile.candela.into()));
    let mut desc = SceneDesc::default();
    let ball = desc.add(Node::new(Family::Shape, "sphere", Params::new(), Span::NONE));
    let lamp = desc.add(Node::new(Family::Light, "goniometric", params, Span::NONE));
    desc.shapes.push(ball);
    desc.lights.push(lamp);
    first_samples(desc);
}

/// Curves must also be met by rays.
fn check_curves(bytes: &[u8]) {
    let Ok(read) = curves::decode(bytes, 2, &LIMITS) else { return };
    assert_eq!(read.points.len() as i64, 4 * read.counts.iter().map(|&n| i64::from(n)).sum::<i64>());
    let params = Params::new()
        .with("points", Value::Floats(read.points))
        .with("counts", Value::Ints(read.counts))
        .with("basis", Value::String("linear".to_owned()));
    let mut desc = SceneDesc::default();
    let tube = desc.add(Node::new(Family::Shape, "tube", params, Span::NONE));
    let sky = desc.add(Node::new(Family::Light, "constant", Params::new(), Span::NONE));
    desc.shapes.push(tube);
    desc.lights.push(sky);
    first_samples(desc);
}

fn check_spectrum(bytes: &[u8]) {
    if let Ok(table) = spectrum_file::decode(&String::from_utf8_lossy(bytes)) {
        assert_eq!(table.lambda.len(), table.values.len());
        assert!(table.lambda.iter().chain(&table.values).all(|x| x.is_finite()), "{table:?}");
    }
}

fn check_gzip(bytes: &[u8]) {
    if let Ok(unpacked) = file::unpack(Path::new("packed.gz"), bytes.to_vec(), &LIMITS, Span::NONE) {
        assert!(unpacked.len() as u64 <= LIMITS.max_file_bytes);
    }
}

/// The first bytes choose the decoder; TGA, which has no mark, is tried by its suffix.
fn check_image(bytes: &[u8]) {
    let limits = ImageLimits { max_pixels: LIMITS.max_pixels, max_bytes: 1 << 26 };
    let path = Path::new("picture.tga");
    if let Ok(image) = decode_image(bytes, path, &limits) {
        assert_eq!(image.data().len(), image.width() * image.height() * image.channels().len());
        assert!((image.width() * image.height()) as u64 <= limits.max_pixels);
    }
    if let Ok(bitmap) = decode_bitmap(bytes, path, Encoding::Auto, &limits) {
        let corner = bitmap.texel(bitmap.width() - 1, bitmap.height() - 1);
        assert!(corner.iter().all(|x| x.is_finite()), "{corner:?}");
    }
}
