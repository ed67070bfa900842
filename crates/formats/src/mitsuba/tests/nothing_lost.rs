//! Whatever stands in a file and is not used is warned about: in every plugin, by its name.

use super::super::{bsdf, emitter, film, integrator, sensor, shape, texture};
use super::read;

/// A property and a child that no plugin knows. The first may also become a parameter, which the element itself warns about.
const STRAY: &str = r#"<float name="zzz" value="1"/><phase type="hg" name="yyy"/>"#;

/// What plugins need inside.
fn needed(plugin: &str) -> &'static str {
    match plugin {
        "twosided" | "mask" => r#"<bsdf type="diffuse"/>"#,
        "blendbsdf" => r#"<bsdf type="diffuse"/><bsdf type="diffuse"/>"#,
        "bumpmap" | "normalmap" => r#"<texture type="checkerboard"/><bsdf type="diffuse"/>"#,
        "bitmap" | "envmap" => r#"<string name="filename" value="a.exr"/>"#,
        "mesh_attribute" => r#"<string name="name" value="vertex_color"/>"#,
        "blackbody" => r#"<float name="temperature" value="5000"/>"#,
        "irregular" => r#"<string name="wavelengths" value="400, 700"/><string name="values" value="1, 2"/>"#,
        "regular" => {
            r#"<float name="wavelength_min" value="400"/><float name="wavelength_max" value="700"/><string name="values" value="1, 2"/>"#
        }
        "thinlens" => r#"<float name="aperture_radius" value="1"/>"#,
        "batch" => r#"<sensor type="perspective"/>"#,
        "moment" | "stokes" => r#"<integrator type="path"/>"#,
        "aov" => r#"<string name="aovs" value="d:depth"/>"#,
        "merge" | "shapegroup" => r#"<shape type="cube"/>"#,
        "instance" => r#"<shape type="shapegroup"><shape type="cube"/></shape>"#,
        _ => "",
    }
}

/// Plugins that are nothing without files of their own.
const OF_FILES: [&str; 15] = [
    "obj",
    "ply",
    "serialized",
    "sdfgrid",
    "heightfield",
    "bsplinecurve",
    "linearcurve",
    "ellipsoids",
    "ellipsoidsmesh",
    "measured",
    "measured_polarized",
    "hair_file",
    "gridvolume",
    "volume",
    "shapegroup",
];

fn check(plugins: &[(&str, &str)], scene: impl Fn(&str, &str) -> String) {
    for (plugin, _) in plugins.iter().filter(|(plugin, _)| !OF_FILES.contains(plugin)) {
        let (scene, warnings) = read(&scene(plugin, &format!("{}{STRAY}", needed(plugin))));
        let is_parameter = scene.nodes().any(|(_, node)| node.params.has("zzz"));
        let told = |word: &str| warnings.iter().any(|warning| warning.contains(word));
        assert!(is_parameter || told("`zzz`"), "{plugin}: {warnings:?}");
        assert!(told("<phase>"), "{plugin}: {warnings:?}");
    }
}

#[test]
fn in_no_plugin() {
    check(bsdf::KINDS, |plugin, inside| {
        format!(r#"<shape type="disk"><bsdf type="{plugin}">{inside}</bsdf></shape>"#)
    });
    check(shape::KINDS, |plugin, inside| format!(r#"<shape type="{plugin}">{inside}</shape>"#));
    check(texture::KINDS, |plugin, inside| {
        format!(
            r#"<shape type="disk"><bsdf type="diffuse"><texture type="{plugin}" name="reflectance">{inside}</texture></bsdf></shape>"#
        )
    });
    let lights: Vec<_> = emitter::KINDS.iter().copied().filter(|(plugin, _)| *plugin != "area").collect();
    check(&lights, |plugin, inside| format!(r#"<emitter type="{plugin}">{inside}</emitter>"#));
    check(&[("area", "")], |plugin, inside| {
        format!(r#"<shape type="disk"><emitter type="{plugin}">{inside}</emitter></shape>"#)
    });
    check(integrator::KINDS, |plugin, inside| {
        format!(r#"<integrator type="{plugin}">{inside}</integrator>"#)
    });
    let meters: Vec<_> =
        sensor::KINDS.iter().copied().filter(|(plugin, _)| *plugin != "irradiancemeter").collect();
    check(&meters, |plugin, inside| format!(r#"<sensor type="{plugin}">{inside}</sensor>"#));
    let in_sensor = |inside: String| format!(r#"<sensor type="perspective">{inside}</sensor>"#);
    check(film::FILMS, |plugin, inside| in_sensor(format!(r#"<film type="{plugin}">{inside}</film>"#)));
    check(film::SAMPLERS, |plugin, inside| {
        in_sensor(format!(r#"<sampler type="{plugin}">{inside}</sampler>"#))
    });
    check(film::FILTERS, |plugin, inside| {
        in_sensor(format!(r#"<film type="hdrfilm"><rfilter type="{plugin}">{inside}</rfilter></film>"#))
    });
}

#[test]
fn between_plugins() {
    for (scene, word) in [
        (r#"<float name="zzz" value="1"/>"#, "`zzz`"),
        (r#"<film type="hdrfilm"/>"#, "<film>"),
        (r#"<sampler type="independent"/>"#, "<sampler>"),
        (r#"<integrator type="path"/><integrator type="direct"/>"#, "one integrator"),
        (r#"<shape type="cube" zzz="1"/>"#, "`zzz`"),
        (
            r#"<shape type="cube"><boolean name="flip_normals" value="true"><zzz/></boolean></shape>"#,
            "inside of <boolean>",
        ),
        (
            r#"<shape type="cube"><transform name="to_world"><translate x="1">zzz</translate></transform></shape>"#,
            "inside of <translate>",
        ),
        (r#"<sensor type="perspective"/><sensor type="perspective"><film type="hdrfilm"/></sensor>"#, ""),
        (
            r#"<sensor type="perspective"><film type="hdrfilm"/></sensor><sensor type="perspective"><film type="hdrfilm"><integer name="width" value="9"/></film></sensor>"#,
            "first sensor",
        ),
    ] {
        let (_, warnings) = read(scene);
        assert!(
            word.is_empty() || warnings.iter().any(|warning| warning.contains(word)),
            "{scene}: {warnings:?}"
        );
    }
}
