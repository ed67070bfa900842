//! What parameters and directives mean where it is easily got wrong, as pbrt-v4 reads them.

use aureole_desc::{Node, SceneDesc, Sources, Value};
use aureole_spectrum::{SpectrumRole, SpectrumSource};

use super::{good, mistake, read, warnings};
use crate::{LoadOptions, load};

fn shape(desc: &SceneDesc, i: usize) -> &Node {
    &desc[desc.shapes[i]]
}

fn light(desc: &SceneDesc, i: usize) -> &Node {
    &desc[desc.lights[i]]
}

fn named<'a>(desc: &'a SceneDesc, name: &str) -> Vec<&'a Node> {
    desc.nodes().map(|(_, node)| node).filter(|node| node.name.as_deref() == Some(name)).collect()
}

fn rgb(value: Option<&Value>) -> [f32; 3] {
    match value {
        Some(Value::Spectrum(spectrum)) => spectrum.to_rgb(SpectrumRole::Unbounded),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_last_of_several_parameters_counts() {
    let desc = good(
        "WorldBegin Shape \"sphere\" \"float radius\" 2 \"float radius\" 3
         Attribute \"shape\" \"float radius\" 4 Attribute \"shape\" \"float radius\" 5 \"float zmax\" 1
         Shape \"sphere\" Shape \"sphere\" \"float radius\" 6",
    );
    let radius = |i| shape(&desc, i).params.get("radius").cloned();
    assert_eq!([radius(0), radius(1), radius(2)], [3.0, 5.0, 6.0].map(|r| Some(Value::Float(r))));
    assert!(mistake("WorldBegin\nAttribute \"shapes\" \"float radius\" 4").0.contains("target"));
}

#[test]
fn a_named_coordinate_system_sets_both_transforms() {
    let text = "WorldBegin CoordinateSystem \"a\" ActiveTransform EndTime Translate 1 0 0 CoordSysTransform \"a\" Shape \"sphere\"";
    assert!(warnings(text).iter().all(|warning| !warning.contains("move")), "{:?}", warnings(text));
    let unknown = warnings("WorldBegin CoordSysTransform \"b\" Shape \"sphere\"");
    assert!(unknown[0].contains("unknown coordinate system"), "{unknown:?}");
}

/// The first sign of version 3 says how such scenes are converted; a kind that version 4 does not know ends the reading.
#[test]
fn scenes_of_version_3_are_named_as_such() {
    let signs = [
        "Film \"image\" \"integer xresolution\" 8 WorldBegin",
        "Sampler \"02sequence\" WorldBegin",
        "PixelFilter \"box\" \"float xwidth\" 1 WorldBegin",
        "WorldBegin LightSource \"infinite\" \"string mapname\" \"a.exr\"",
    ];
    for text in signs {
        let found = read(text).report.warnings;
        let about: Vec<_> = found.iter().filter(|w| w.message.contains("version 3")).collect();
        assert_eq!(about.len(), 1, "{text}: {found:?}");
        assert!(about[0].help.as_ref().is_some_and(|help| help.contains("pbrt --upgrade")), "{text}");
    }
    for text in [
        "WorldBegin\nMaterial \"matte\" \"rgb Kd\" [1 1 1] Material \"plastic\"",
        "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"uber\"",
        "WorldBegin\nShape \"cone\"",
    ] {
        let (message, (line, _)) = mistake(text);
        assert!(message.contains("version 3") && message.contains("--upgrade") && line == 2, "{message}");
    }
    assert!(!mistake("WorldBegin Material \"difuse\"").0.contains("version 3"));
    assert!(warnings("Film \"rgb\" PixelFilter \"box\" \"float xradius\" 1 WorldBegin WorldEnd").is_empty());
}

#[test]
fn spectra_are_zero_beyond_their_tables() {
    let desc =
        good("WorldBegin Material \"diffuse\" \"spectrum reflectance\" [500 1 600 1] Shape \"sphere\"");
    let diffuse = desc.nodes().map(|(_, node)| node).find(|node| node.kind == "diffuse").unwrap();
    let [r, g, b] = rgb(diffuse.params.get("reflectance"));
    assert!(g > 0.8 && r < 0.4 && b < 0.2, "{r} {g} {b}");
}

#[test]
fn dots_show_what_is_called_outside() {
    let desc = good("WorldBegin Texture \"d\" \"float\" \"dots\" \"float inside\" 2 \"float outside\" 3");
    let dots = &named(&desc, "d")[0].params;
    let value = |name| dots.get(name).cloned();
    assert_eq!(
        [value("inside"), value("outside")],
        [3.0, 2.0].map(|x| Some(Value::Spectrum(SpectrumSource::Uniform(x))))
    );
}

/// pbrt reads these through a library that knows no other curve.
#[test]
fn some_pictures_are_always_srgb() {
    for (name, encoding) in [("a.png", "linear"), ("a.jpg", "auto"), ("a.TGA", "auto"), ("a.bmp", "auto")] {
        let text = format!(
            "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"{name}\" \"string encoding\" \"linear\""
        );
        let desc = good(&text);
        let found = named(&desc, "t")[0].params.get("encoding").cloned();
        assert_eq!(found, Some(Value::String(encoding.into())), "{name}");
        assert_eq!(warnings(&text).len(), usize::from(encoding == "auto"), "{name}");
    }
}

/// Whatever a directive does not use is warned about by its name.
#[test]
fn parameters_that_nobody_knows_are_told() {
    let before = [
        "Camera \"perspective\"",
        "Film \"rgb\"",
        "Sampler \"halton\"",
        "PixelFilter \"box\"",
        "Accelerator \"bvh\"",
    ];
    let also =
        ["Integrator \"path\"", "Camera \"orthographic\"", "Camera \"spherical\"", "Sampler \"stratified\""];
    for directive in before.into_iter().chain(also) {
        let found = warnings(&format!("{directive} \"float zzz\" 1 WorldBegin"));
        assert!(found.iter().any(|warning| warning.contains("`zzz`")), "{directive}: {found:?}");
    }
    let shapes = ["sphere", "disk", "cylinder"].map(|kind| format!("Shape \"{kind}\""));
    let lights = ["point", "spot", "distant", "infinite"].map(|kind| format!("LightSource \"{kind}\""));
    let materials =
        ["diffuse", "conductor", "dielectric", "thindielectric", "coateddiffuse", "coatedconductor"]
            .map(|kind| format!("Material \"{kind}\""));
    let textures =
        ["constant", "scale", "mix", "bilerp", "checkerboard", "dots", "fbm", "wrinkled", "marble"]
            .map(|kind| format!("Texture \"t\" \"float\" \"{kind}\""));
    for directive in shapes.iter().chain(&lights).chain(&materials).chain(&textures) {
        let found = warnings(&format!("WorldBegin {directive} \"float zzz\" 1"));
        assert!(found.iter().any(|warning| warning.contains("`zzz`")), "{directive}: {found:?}");
    }
}

/// Millions of them must fit into memory.
#[test]
fn instances_take_few_bytes() {
    assert!(size_of::<aureole_desc::Instance>() <= 128);
    let desc = good(
        "WorldBegin ObjectBegin \"o\" Shape \"sphere\" ObjectEnd Translate 1 2 3 ObjectInstance \"o\" ObjectInstance \"o\"",
    );
    assert_eq!((desc.instances.len(), desc.shapes.len()), (2, 0));
    let place = desc.instances[1].transform().unwrap();
    assert_eq!(place.point(aureole_math::Point3::ORIGIN).to_array(), [1.0, 2.0, 3.0]);
}

#[test]
fn a_transform_block_saves_everything() {
    let desc = good(
        "WorldBegin TransformBegin Material \"conductor\" ReverseOrientation TransformEnd Shape \"sphere\"
         TransformBegin AttributeEnd",
    );
    assert_eq!(shape(&desc, 0).params.get("flip_normals"), Some(&Value::Bool(false)));
    let Some(Value::Node(material)) = shape(&desc, 0).params.get("bsdf") else { panic!() };
    let Some(Value::Node(inner)) = desc[*material].params.get("bsdf") else { panic!() };
    assert_eq!(desc[*inner].kind, "diffuse");
}

#[test]
fn what_an_import_changes_ends_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.pbrt", "WorldBegin Import \"b.pbrt\" Shape \"sphere\" Include \"b.pbrt\" Shape \"sphere\"");
    write("b.pbrt", "ReverseOrientation Shape \"disk\"");
    write("c.pbrt", "WorldBegin AttributeBegin Import \"d.pbrt\"");
    write("d.pbrt", "AttributeEnd");
    let open = |name: &str| {
        let (mut sources, mut report) = (Sources::default(), Default::default());
        load(&folder.path().join(name), &LoadOptions::default(), &mut sources, &mut report)
    };
    let desc = open("a.pbrt").unwrap();
    let flips = [0, 1, 2, 3].map(|i| shape(&desc, i).params.get("flip_normals").cloned());
    assert_eq!(flips, [true, false, true, true].map(|flip| Some(Value::Bool(flip))));
    assert!(open("c.pbrt").unwrap_err().to_string().contains("ends nothing"));
}

#[test]
fn options_are_a_name_and_a_value() {
    let text = "Option \"seed\" 3 Option \"disable-pixel-jitter\" false Option \"bool disabletexturefiltering\" true
        Option \"rendercoordsys\" \"world\" Option \"displacementedgescale\" 2.5 WorldBegin
        Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"h.png\" \"string filter\" \"ewa\"
        Shape \"plymesh\" \"string filename\" \"a.ply\" \"texture displacement\" \"h\" \"float edgelength\" 2";
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/pyramid.ply"),
        folder.path().join("a.ply"),
    )
    .unwrap();
    std::fs::write(folder.path().join("a.pbrt"), text).unwrap();
    let (mut sources, mut report) = (Sources::default(), aureole_desc::Report::default());
    let path = folder.path().join("a.pbrt");
    let desc = load(&path, &LoadOptions::default(), &mut sources, &mut report).unwrap();
    let messages: Vec<&str> = report.warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert_eq!(messages, ["option `seed` has no effect here"]);
    assert_eq!(shape(&desc, 0).params.get("edge_length"), Some(&Value::Float(5.0)));
    assert_eq!(named(&desc, "h")[0].params.get("filter"), Some(&Value::String("bilinear".into())));
    assert!(mistake("Option \"speed\" 3").0.contains("option"));
    assert!(mistake("Option \"wavefront\"").0.contains("value"));
}

#[test]
fn colours_are_of_the_current_space() {
    let desc = good(
        "ColorSpace \"Rec2020\" WorldBegin Texture \"a\" \"spectrum\" \"constant\" \"rgb value\" [0.5 0.5 0.5]
         Texture \"b\" \"spectrum\" \"constant\" \"rgb value\" [0.1 0.5 0.1] Attribute \"light\" \"rgb I\" [0.1 0.5 0.1]
         AttributeBegin ColorSpace \"srgb\" LightSource \"point\" LightSource \"point\" \"rgb I\" [0.1 0.5 0.1] AttributeEnd
         ColorSpace \"aces2065-1\" LightSource \"distant\"",
    );
    let [grey, green] = ["a", "b"].map(|name| rgb(named(&desc, name)[0].params.get("value")));
    assert!(grey.iter().all(|c| (c - 0.5).abs() < 1e-3), "{grey:?}");
    assert!(green[0] == 0.0 && green[1] > 0.54 && green[2] < 0.08, "{green:?}");
    // `Attribute` keeps the space in which it was given.
    assert_eq!(rgb(light(&desc, 0).params.get("intensity")), green);
    assert_eq!(rgb(light(&desc, 1).params.get("intensity")), [0.1, 0.5, 0.1]);
    let white = rgb(light(&desc, 2).params.get("irradiance"));
    assert!(white[0] > 1.01 && white[2] < 0.95, "{white:?}");
    assert!(mistake("ColorSpace \"adobe\"").0.contains("colour space"));
}

#[test]
fn numbers_and_colours_have_textures_of_the_same_name() {
    let desc = good(
        "WorldBegin Texture \"t\" \"float\" \"constant\" \"float value\" 0.25
         Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [1 0 0]
         MakeNamedMaterial \"m\" \"string type\" \"coateddiffuse\" \"texture reflectance\" \"t\" \"texture thickness\" \"t\"
         Texture \"u\" \"float\" \"scale\" \"texture tex\" \"t\" Texture \"u\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"texture scale\" \"t\"",
    );
    let value = |node: &Node, name: &str| match node.params.get(name) {
        Some(Value::Node(texture)) => rgb(desc[*texture].params.get("value")),
        other => panic!("{other:?}"),
    };
    let material = named(&desc, "m")[0];
    assert_eq!(value(material, "reflectance"), [1.0, 0.0, 0.0]);
    assert_eq!(value(material, "thickness"), [0.25; 3]);
    let [float, spectrum] = named(&desc, "u")[..] else { panic!() };
    assert_eq!(value(float, "texture"), [0.25; 3]);
    assert_eq!((value(spectrum, "texture"), value(spectrum, "scale")), ([1.0, 0.0, 0.0], [0.25; 3]));
}

#[test]
fn films_are_cropped_and_limited() {
    let film = |text: &str| {
        let desc =
            good(&format!("Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 50 {text}"));
        let film = &desc[desc.film.unwrap()].params;
        let crop = ["crop_x", "crop_width", "crop_y", "crop_height"].map(|name| match film.get(name) {
            Some(Value::Int(n)) => *n,
            _ => -1,
        });
        (crop, film.get("max_component").cloned())
    };
    assert_eq!(film("\"float maxcomponentvalue\" 10"), ([-1; 4], Some(Value::Float(10.0))));
    assert_eq!(film("\"float cropwindow\" [0.5 0.25 0 0.5]").0, [25, 25, 0, 25]);
    assert_eq!(film("\"integer pixelbounds\" [10 200 -5 20]").0, [10, 90, 0, 20]);
    assert_eq!(film("\"integer pixelbounds\" [0 1 0 1] \"float cropwindow\" [0 0.5 0 1]").0, [0, 50, 0, 50]);
    assert!(mistake("Film \"rgb\" \"integer pixelbounds\" [5 5 0 1]").0.contains("crop"));
    for (text, word) in
        [("\"float whitebalance\" 5000", "balanced"), ("\"string sensor\" \"canon_eos_100d\"", "canon")]
    {
        assert!(
            warnings(&format!("Film \"rgb\" {text} WorldBegin")).iter().any(|w| w.contains(word)),
            "{text}"
        );
    }
}

#[test]
fn what_is_not_given_is_as_in_pbrt() {
    let desc = good("Sampler \"independent\" WorldBegin");
    assert_eq!(desc[desc.sampler.unwrap()].params.get("sample_count"), Some(&Value::Int(4)));
    // A camera at the origin, of 90 degrees along the shorter side.
    let camera = &desc[desc.cameras[0]];
    assert_eq!(camera.kind, "perspective");
    let Some(Value::Floats(window)) = camera.params.get("screen_window") else { panic!("{camera:?}") };
    assert!((window[3] - 1.0).abs() < 1e-6 && (window[1] - 1280.0 / 720.0).abs() < 1e-6, "{window:?}");
}

#[test]
fn materials_say_their_colour_in_one_way() {
    for (text, word) in [
        ("\"conductor\" \"rgb reflectance\" [1 1 1] \"float eta\" 2", "`reflectance` and `eta`"),
        ("\"subsurface\" \"rgb sigma_a\" [1 1 1]", "sigma_s"),
    ] {
        let (message, _) = mistake(&format!("WorldBegin\nMaterial {text}"));
        assert!(message.contains(word), "{message}");
    }
    let desc = good(
        "WorldBegin MakeNamedMaterial \"hair\" \"string type\" \"hair\" \"rgb color\" [1 0 0] \"rgb reflectance\" [0 1 0]
         MakeNamedMaterial \"air\" \"string type\" \"dielectric\" \"float eta\" 0",
    );
    assert_eq!(rgb(named(&desc, "hair")[0].params.get("reflectance")), [0.0, 1.0, 0.0]);
    assert_eq!(named(&desc, "air")[0].params.get("int_ior"), Some(&Value::Float(1.0)));
}

#[test]
fn lights_are_what_they_say() {
    for text in [
        "LightSource \"infinite\" \"string filename\" \"a.exr\" \"rgb L\" [1 1 1]",
        "AreaLightSource \"diffuse\" \"string filename\" \"a.exr\" \"rgb L\" [1 1 1] Shape \"sphere\"",
    ] {
        assert!(mistake(&format!("WorldBegin\n{text}")).0.contains("both"), "{text}");
    }
    let found = warnings("WorldBegin Material \"interface\" AreaLightSource \"diffuse\" Shape \"sphere\"");
    assert!(found[0].contains("interface"), "{found:?}");
    let desc = good(
        "WorldBegin LightSource \"point\" \"spectrum I\" \"stdillum-A\" \"float power\" 8
         LightSource \"infinite\" \"float illuminance\" 3.14159265 \"float scale\" 2
         LightSource \"distant\" \"float illuminance\" 3 \"float scale\" 2 \"point3 from\" [0 1 0] \"point3 to\" [0 0 0]
         LightSource \"spot\"",
    );
    let luminance = |rgb: [f32; 3]| aureole_spectrum::luminance(rgb);
    let found = [("intensity", 0), ("radiance", 1), ("irradiance", 2)]
        .map(|(name, i)| luminance(rgb(light(&desc, i).params.get(name))));
    let wanted = [8.0 / (4.0 * std::f32::consts::PI), 2.0, 6.0];
    assert!((0..3).all(|i| (found[i] - wanted[i]).abs() < 1e-3 * wanted[i]), "{found:?}");
    let spot = &light(&desc, 3).params;
    assert_eq!(spot.get("cutoff_angle"), Some(&Value::Float(30.0)));
    assert_eq!(spot.get("beam_width"), Some(&Value::Float(25.0)));
    assert_eq!(spot.get("intensity"), Some(&Value::Spectrum(SpectrumSource::Rgb([1.0; 3]))));
}

#[test]
fn what_stands_in_for_others_is_warned_about_once() {
    for text in [
        "Integrator \"bdpt\" \"bool visualizestrategies\" true \"integer maxdepth\" 3",
        "Camera \"fisheye\" \"float fov\" 30",
        "Sampler \"stratified\" \"bool jitter\" false",
    ] {
        assert_eq!(warnings(&format!("{text} WorldBegin")).len(), 1, "{text}");
    }
    assert!(warnings("Camera \"spherical\" \"float lensradius\" 1 Sampler \"halton\" \"string randomization\" \"none\" WorldBegin").is_empty());
}

#[test]
fn shapes_objects_and_cameras_move() {
    let desc = good(
        "TransformTimes 1 3 ActiveTransform EndTime Translate 0 0 -1 ActiveTransform All
         Camera \"perspective\" \"float shutteropen\" 1.5 \"float shutterclose\" 2.5 WorldBegin
         ObjectBegin \"o\" Shape \"disk\" ObjectEnd Shape \"sphere\"
         AttributeBegin ActiveTransform EndTime Translate 1 0 0 ActiveTransform All Scale 2 2 2
         Shape \"sphere\" ObjectInstance \"o\" AttributeEnd Shape \"cylinder\"",
    );
    let kinds: Vec<&str> = desc.shapes.iter().map(|&id| desc[id].kind.as_str()).collect();
    assert_eq!(kinds, ["sphere", "instance", "instance", "cylinder"]);
    for i in [1, 2] {
        let mut params = shape(&desc, i).params.clone();
        let [start, end] =
            ["world_from_object", "world_from_object_end"].map(|name| params.transform(name).unwrap());
        let p = aureole_math::Point3::new(1.0, 0.0, 0.0);
        assert_eq!([start.point(p).x, end.point(p).x], [2.0, 3.0]);
    }
    let mut camera = desc[desc.cameras[0]].params.clone();
    let [start, end] =
        ["world_from_camera", "world_from_camera_end"].map(|name| camera.transform(name).unwrap());
    let origin = aureole_math::Point3::ORIGIN;
    assert_eq!([start.point(origin).z, end.point(origin).z], [0.0, 1.0]);
    assert_eq!(["shutter_open", "shutter_close"].map(|name| camera.float(name, -1.0).unwrap()), [0.25, 0.75]);
    // What does not move is described as ever.
    let still = good("Camera \"perspective\" WorldBegin Shape \"sphere\"");
    assert!(!still[still.cameras[0]].params.has("shutter_close") && still.shapes.len() == 1);
    assert!(mistake("TransformTimes 1 1").0.contains("later"));
}

/// Bumps bend what is two-sided, not the other way round; of a normal map and a displacement the former counts.
#[test]
fn bumps_are_outside_and_normal_maps_come_first() {
    let text = "WorldBegin Texture \"h\" \"float\" \"fbm\"
        Material \"diffuse\" \"texture displacement\" \"h\" Shape \"sphere\"";
    let desc = good(text);
    let Some(Value::Node(material)) = shape(&desc, 0).params.get("bsdf") else { panic!() };
    let bump = &desc[*material];
    assert_eq!(bump.kind, "bump");
    assert_eq!(bump.params.get("keep_sides"), Some(&Value::Bool(false)));
    let Some(Value::Node(inner)) = bump.params.get("bsdf") else { panic!() };
    assert_eq!(desc[*inner].kind, "two_sided");
}

#[test]
fn integrators_and_options_reach_the_path() {
    let path = |text: &str| {
        let desc = good(&format!("{text} WorldBegin"));
        let params = &desc[desc.integrator.expect("there is always one")].params;
        ["regularize", "force_diffuse"].map(|name| params.get(name).cloned())
    };
    let yes = Some(Value::Bool(true));
    assert_eq!(path("Integrator \"volpath\""), [None, None]);
    assert_eq!(path("Integrator \"path\" \"bool regularize\" true"), [yes.clone(), None]);
    assert_eq!(path("Option \"bool forcediffuse\" true Integrator \"path\""), [None, yes]);
}
