//! Directives, parameters and mistakes.

mod cameras;
mod semantics;
mod surfaces;

use aureole_desc::{Report, SceneDesc, SceneError, Sources, Value};
use aureole_math::{Point3, Transform, Vector3};

use crate::{LoadOptions, load, load_text};

struct Read {
    result: Result<SceneDesc, SceneError>,
    report: Report,
    sources: Sources,
}

fn read(text: &str) -> Read {
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let result = load_text("pbrt", "scene.pbrt", text, &LoadOptions::default(), &mut sources, &mut report);
    Read { result, report, sources }
}

fn good(text: &str) -> SceneDesc {
    let read = read(text);
    read.result.unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// The message and place of what is wrong.
fn mistake(text: &str) -> (String, (usize, usize)) {
    let read = read(text);
    let error = read.result.expect_err(text);
    let place = read.sources.locate(error.span()).and_then(|location| location.line_column);
    (error.to_string(), place.unwrap_or_else(|| panic!("no place for {error}")))
}

/// All warnings of a text that is read.
fn warnings(text: &str) -> Vec<String> {
    let read = read(text);
    assert!(read.result.is_ok(), "{text}: {:?}", read.result);
    read.report.warnings.into_iter().map(|warning| warning.message).collect()
}

fn transform_of(text: &str) -> Transform {
    let desc = good(&format!("WorldBegin\n{text}\nShape \"sphere\""));
    match desc[desc.shapes[0]].params.get("world_from_object") {
        Some(Value::Transform(t)) => *t,
        other => panic!("{other:?}"),
    }
}

#[test]
fn transforms_compose_in_order() {
    let p = |t: &str| transform_of(t).point(Point3::new(1.0, 0.0, 0.0));
    assert_eq!(p("Translate 1 2 3 Scale 2 2 2"), Point3::new(3.0, 2.0, 3.0));
    assert_eq!(p("Scale 2 2 2 Translate 1 2 3"), Point3::new(4.0, 4.0, 6.0));
    assert!(p("Rotate 90 0 0 1").distance(Point3::new(0.0, 1.0, 0.0)) < 1e-6);
    assert_eq!(p("Translate 5 5 5 Identity"), Point3::new(1.0, 0.0, 0.0));
    assert_eq!(p("Transform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1]"), Point3::new(8.0, 8.0, 9.0));
    assert_eq!(
        p("Translate 1 0 0 ConcatTransform [2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1]"),
        Point3::new(3.0, 0.0, 0.0)
    );
    assert_eq!(
        p("CoordinateSystem \"a\" Translate 9 9 9 CoordSysTransform \"a\""),
        Point3::new(1.0, 0.0, 0.0)
    );
    assert_eq!(p("AttributeBegin Translate 9 9 9 AttributeEnd"), Point3::new(1.0, 0.0, 0.0));
    assert_eq!(p("TransformBegin Translate 9 9 9 TransformEnd"), Point3::new(1.0, 0.0, 0.0));
    assert_eq!(
        p("ActiveTransform EndTime ActiveTransform All TransformTimes 0 1"),
        Point3::new(1.0, 0.0, 0.0)
    );
}

#[test]
fn the_camera_is_mirrored_into_a_right_handed_space() {
    let desc = good("LookAt 0 0 5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 60 WorldBegin");
    let camera = &desc[desc.cameras[0]];
    let Some(Value::Transform(t)) = camera.params.get("world_from_camera") else { panic!() };
    assert!(t.point(Point3::ORIGIN).distance(Point3::new(0.0, 0.0, 5.0)) < 1e-5);
    // The right of pbrt's image is up × forward; Aureole's images have −X on the right.
    assert!((t.vector(-Vector3::X) - Vector3::Y.cross(-Vector3::Z)).length() < 1e-5);
}

#[test]
fn what_a_file_leaves_out_is_what_pbrt_takes() {
    let desc = good("Camera \"perspective\" WorldBegin");
    let [filter, sampler, integrator] =
        [desc.filter, desc.sampler, desc.integrator].map(|id| &desc[id.unwrap()]);
    assert_eq!(
        (filter.kind.as_str(), filter.params.get("radius")),
        ("gaussian", Some(&Value::Vec2([1.5; 2])))
    );
    assert_eq!((sampler.kind.as_str(), sampler.params.get("sample_count")), ("sobol", Some(&Value::Int(16))));
    assert_eq!(
        (integrator.kind.as_str(), integrator.params.get("max_depth")),
        ("path", Some(&Value::Int(6)))
    );
}

#[test]
fn films_see_light_while_the_shutter_is_open() {
    let gain = |camera: &str, film: &str| {
        let desc = good(&format!("Film \"rgb\" {film} Camera \"perspective\" {camera} WorldBegin"));
        desc[desc.film.unwrap()].params.get("gain").cloned()
    };
    assert_eq!(gain("", ""), None);
    assert_eq!(gain("", "\"float iso\" 200"), Some(Value::Float(2.0)));
    let shutter = "\"float shutteropen\" 0.5 \"float shutterclose\" 0.75";
    assert_eq!(gain(shutter, "\"float iso\" 800"), Some(Value::Float(2.0)));
    assert!(mistake("Camera \"perspective\" \"float shutterclose\" 0 WorldBegin").0.contains("shutter"));
}

#[test]
fn parameters_of_every_type() {
    let desc = good(
        "WorldBegin Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3] Shape \"sphere\" \"float radius\" 2
         Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" [400 1 700 2] \"bool remaproughness\" false
         LightSource \"point\" \"blackbody I\" 5500 \"point3 from\" [1 2 3] \"float scale\" [ 3 ]
         LightSource \"distant\" \"spectrum L\" [ 300 1 800 1 ] \"point from\" [0 0 1]
         Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [1 0 0]
         Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"disk\" \"bool unused\" true",
    );
    assert_eq!((desc.shapes.len(), desc.lights.len()), (2, 2));
    // Light spectra are scaled to luminance one, then by `scale`.
    let light = &desc[desc.lights[0]].params;
    let Some(Value::Spectrum(intensity)) = light.get("intensity") else { panic!() };
    let luminance = aureole_spectrum::luminance(intensity.to_rgb(aureole_spectrum::SpectrumRole::Illuminant));
    assert!((luminance - 3.0).abs() < 1e-3, "{luminance}");
}

#[test]
fn attributes_set_defaults() {
    let desc = good(
        "WorldBegin AttributeBegin Attribute \"shape\" \"float radius\" 3 Shape \"sphere\" AttributeEnd Shape \"sphere\"",
    );
    let radius = |i: usize| desc[desc.shapes[i]].params.get("radius").cloned();
    assert_eq!((radius(0), radius(1)), (Some(Value::Float(3.0)), None));
}

#[test]
fn objects_become_groups_and_instances() {
    let desc = good(
        "WorldBegin ObjectBegin \"a\" Shape \"sphere\" Shape \"disk\" ObjectEnd Translate 1 0 0 ObjectInstance \"a\"",
    );
    assert!(desc.shapes.is_empty());
    let [instance] = desc.instances[..] else { panic!("{:?}", desc.instances) };
    assert_eq!(
        (desc[instance.group].kind.as_str(), instance.world_from_object[0]),
        ("group", [1.0, 0.0, 0.0, 1.0])
    );
}

#[test]
fn curves_and_subdivision_surfaces_are_read() {
    let desc = good(
        "WorldBegin Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer degree\" 2 \"float width\" 0.1 \"float width1\" 0.2 \
         Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]",
    );
    let [curve, surface] = [0, 1].map(|i| &desc[desc.shapes[i]]);
    let width = |name| curve.params.get(name).cloned();
    assert_eq!(curve.kind, "curve");
    let Some(Value::Floats(points)) = curve.params.get("points") else { panic!("{curve:?}") };
    assert_eq!(points.len(), 12);
    assert_ne!(width("width0"), width("width1"));
    let Some(Value::Mesh(mesh)) = surface.params.get("mesh") else { panic!("{surface:?}") };
    assert_eq!(mesh.indices.len(), 1);
    assert_eq!(surface.params.get("levels"), Some(&Value::Int(1)));
}

#[test]
fn path_lengths_are_converted() {
    let desc = good("Integrator \"path\" \"integer maxdepth\" 7 WorldBegin");
    assert_eq!(desc[desc.integrator.unwrap()].params.get("max_depth"), Some(&Value::Int(8)));
}

#[test]
fn lights_and_textures_know_their_space() {
    let desc = good(
        "WorldBegin Translate 1 2 3 Texture \"n\" \"float\" \"fbm\" \"integer octaves\" 3
         Texture \"p\" \"spectrum\" \"dots\" \"string mapping\" \"planar\" \"vector3 v1\" [0 0 2] \"float udelta\" 0.5
         LightSource \"infinite\" \"string filename\" \"sky.exr\" \"point3 portal\" [0 0 0  0 1 0  1 1 0  1 0 0]
         LightSource \"projection\" \"string filename\" \"slide.png\" \"float power\" 9 \"float scale\" 2",
    );
    let texture = |name: &str| {
        let found = desc.nodes().find(|(_, node)| node.name.as_deref() == Some(name));
        let mut params = found.map(|(_, node)| node.params.clone()).unwrap_or_default();
        params.transform("texture_from_world").unwrap()
    };
    assert_eq!(texture("n").point(Point3::new(1.0, 2.0, 3.0)), Point3::ORIGIN);
    // s = p·v1 + udelta in the space of the transform.
    assert_eq!(texture("p").point(Point3::new(1.0, 2.0, 4.0)).x, 2.5);
    let kinds: Vec<&str> = desc.lights.iter().map(|&id| desc[id].kind.as_str()).collect();
    assert_eq!(kinds, ["portal_envmap", "projector"]);
    let power = desc[desc.lights[1]].params.get("power");
    assert_eq!(power, Some(&Value::Float(18.0)));
}

#[test]
fn bodies_scatter_by_name_or_by_numbers() {
    let desc = good(
        "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"subsurface\" \"string name\" \"Skin1\" \"float scale\" 10
         MakeNamedMaterial \"b\" \"string type\" \"subsurface\" \"rgb reflectance\" [0.6 0.4 0.2] \"float mfp\" 2
             \"float eta\" 1.5 \"float g\" 0.3 \"float roughness\" 0.25 \"bool remaproughness\" true",
    );
    let of = |name: &str| {
        desc.nodes()
            .find(|(_, node)| node.name.as_deref() == Some(name))
            .map(|(_, node)| node.clone())
            .unwrap()
    };
    assert_eq!(of("a").kind, "subsurface");
    assert_eq!(of("a").params.get("name"), Some(&Value::String("Skin1".into())));
    assert_eq!(of("a").params.get("scale"), Some(&Value::Float(10.0)));
    assert_eq!(of("a").params.get("int_ior"), Some(&Value::Float(1.33)));
    assert_eq!(of("b").params.get("alpha_u"), Some(&Value::Float(0.5)));
    assert!(of("b").params.has("reflectance") && of("b").params.has("mfp") && !of("b").params.has("name"));
}

#[test]
fn what_is_not_rendered_is_named() {
    for (text, word) in [
        ("LightSource \"goniometric\"", "goniometric"),
        ("Texture \"a\" \"float\" \"ptex\"", "ptex"),
        ("MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"", "media"),
        ("MediumInterface \"fog\" \"\"", "media"),
        ("ActiveTransform EndTime Translate 1 0 0 LightSource \"point\"", "move"),
        ("AreaLightSource \"diffuse\" ActiveTransform EndTime Translate 1 0 0 Shape \"sphere\"", "moves"),
        ("Shape \"sphere\" \"float radios\" 2", "radios"),
    ] {
        let read = read(&format!("WorldBegin\n{text}"));
        assert!(read.result.is_ok(), "{text}");
        let warning = read.report.warnings.iter().find(|w| w.message.contains(word));
        let warning = warning.unwrap_or_else(|| panic!("{text}: {:?}", read.report.warnings));
        assert_eq!(read.sources.locate(warning.at).unwrap().line_column.unwrap().0, 2, "{text}");
    }
}

#[test]
fn mistakes_have_places() {
    for (text, place, words) in [
        ("WorldBegin\nShap \"sphere\"", (2, 1), "did you mean `Shape`"),
        ("WorldBegin\n Shape \"spere\"", (2, 2), "spere"),
        ("WorldBegin Shape \"sphere\"\n\"float radius\" \"big\"", (2, 1), "radius"),
        ("WorldBegin Shape \"sphere\" \"flaot radius\" 1", (1, 27), "flaot"),
        ("WorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [1 2", (2, 20), "closing bracket"),
        ("WorldBegin\nShape \"sphere", (2, 7), "closing quote"),
        ("WorldBegin\nNamedMaterial \"gold\"", (2, 15), "gold"),
        ("WorldBegin\nAttributeEnd", (2, 1), "ends nothing"),
        ("WorldBegin\nAttributeBegin", (2, 1), "not ended"),
        ("Translate 1 2", (1, 1), "3 numbers"),
        ("Translate 1 2 x", (1, 15), "`x`"),
        ("Scale 0 1 1", (1, 1), "inverted"),
        ("LookAt 0 0 0 0 0 0 0 1 0", (1, 1), "inverted"),
        ("WorldBegin\nInclude \"nowhere.pbrt\"", (2, 9), "nowhere.pbrt"),
        ("WorldBegin\nObjectInstance \"a\"", (2, 1), "unknown object"),
        (
            "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]",
            (2, 1),
            "out of range",
        ),
        ("WorldBegin Material \"diffuse\" \"texture reflectance\" \"t\"", (1, 31), "unknown texture"),
    ] {
        let (message, found) = mistake(text);
        assert_eq!(found, place, "{text}: {message}");
        assert!(message.contains(words), "{text}: {message}");
    }
}

#[test]
fn deep_nesting_is_limited() {
    let (message, _) = mistake(&"AttributeBegin ".repeat(10_000));
    assert!(message.contains("nested blocks"), "{message}");
}

#[test]
fn includes_that_include_themselves_are_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.pbrt"), "WorldBegin\nInclude \"b.pbrt\"").unwrap();
    std::fs::write(folder.path().join("b.pbrt"), "Include \"a.pbrt\"").unwrap();
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let path = folder.path().join("a.pbrt");
    let error = load(&path, &LoadOptions::default(), &mut sources, &mut report).unwrap_err();
    assert!(error.to_string().contains("includes itself"));
    assert!(sources.locate(error.span()).unwrap().path.ends_with("b.pbrt"));
}

const EVERYTHING: &str = include_str!("../../../tests/data/everything.pbrt");

#[test]
fn a_scene_of_everything_is_read() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/everything.pbrt");
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let desc = load(path.as_ref(), &LoadOptions::default(), &mut sources, &mut report).unwrap();
    assert!(desc.shapes.len() >= 15 && desc.lights.len() == 6);
    assert!(report.warnings.iter().all(|w| !w.message.contains("not used")), "{:?}", report.warnings);
}

#[test]
fn a_cut_file_is_an_error_or_a_shorter_scene_but_never_a_panic() {
    for end in (0..EVERYTHING.len()).filter(|&end| EVERYTHING.is_char_boundary(end)) {
        let _ = read(&EVERYTHING[..end]).result;
    }
}

#[test]
fn scenes_of_others_are_read() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/pbrt");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return;
    }
    for name in ["veach-ajar/veach-ajar.pbrt", "cornell/cornell.pbrt", "cornell/cornell_sphere.pbrt"] {
        let (mut sources, mut report) = (Sources::default(), Report::default());
        let desc = load(&folder.join(name), &LoadOptions::default(), &mut sources, &mut report).unwrap();
        assert!(!desc.shapes.is_empty() && desc.cameras.len() == 1, "{name}");
    }
}
