use std::path::Path;

use aureole_desc::{Report, SceneDesc, SceneError, Sources, Value};
use aureole_math::{Point3, Transform};

use crate::{LoadOptions, load, load_text};

const TRIANGLE: &str = "v 10 0 0\nv 12 0 0\nv 11 2 0\nvt 0 0\nf 1/1 2/1 3/1\n";

fn read(format: &str, text: &str) -> Result<(SceneDesc, Report), SceneError> {
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let name = format!("model.{format}");
    let scene = load_text(format, &name, text, &LoadOptions::default(), &mut sources, &mut report)?;
    Ok((scene, report))
}

#[test]
fn the_camera_looks_at_the_object_from_outside() {
    let (scene, _) = read("obj", TRIANGLE).unwrap();
    let camera = &scene[scene.cameras[0]];
    let Some(&Value::Transform(world_from_camera)) = camera.params.get("world_from_camera") else { panic!() };
    let camera_from_world: Transform = world_from_camera.inverse();
    let Some(&Value::Float(fov)) = camera.params.get("fov") else { panic!() };
    for p in [[10.0, 0.0, 0.0], [12.0, 0.0, 0.0], [11.0, 2.0, 0.0]] {
        let q = camera_from_world.point(Point3::from(p));
        let slope = (fov as f32 / 2.0).to_radians().tan();
        assert!(q.z > 1.0 && q.x.abs() < slope * q.z && q.y.abs() < slope * q.z, "{q:?}");
    }
    // The top of the object is up in the picture.
    assert!(camera_from_world.point(Point3::new(11.0, 2.0, 0.0)).y > 0.0);
    assert_eq!(scene.shapes.len(), 3, "key light, ground, object");
    assert_eq!(scene.lights.len(), 1);
}

#[test]
fn materials_come_from_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(
        at("a.obj"),
        format!("mtllib a.mtl\nusemtl glass\n{TRIANGLE}usemtl lamp\nf 1 2 3\nusemtl none\nf 3 2 1\n"),
    )
    .unwrap();
    std::fs::write(
        at("a.mtl"),
        "newmtl glass\nillum 7\nNi 1.4\nnewmtl lamp\nKe 3 2 1\nKs 1 1 1\nNs 6\nmap_d holes.png\n",
    )
    .unwrap();
    std::fs::write(at("holes.png"), "").unwrap();
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let scene = load(&at("a.obj"), &LoadOptions::default(), &mut sources, &mut report).unwrap();
    let kinds: Vec<&str> = scene.nodes().map(|(_, node)| node.kind.as_str()).collect();
    for kind in ["dielectric", "rough_plastic", "mask", "bitmap"] {
        assert!(kinds.contains(&kind), "{kind} in {kinds:?}");
    }
    let lamp = scene.shapes.iter().map(|&id| &scene[id]).filter(|node| node.params.has("emission")).count();
    assert_eq!(lamp, 2, "the lamp and the key light");
    let warnings: Vec<_> = report.warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert_eq!(warnings, ["no library has the material `none`: the default is used"]);
    assert_eq!(sources.path(report.warnings[0].at), Some(Path::new(&at("a.obj"))));
}

#[test]
fn colours_of_vertices_are_shown() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float r\nproperty float g\nproperty float b\nelement face 1\nproperty list uchar int vertex_index\n\
        end_header\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n";
    let (scene, _) = read("ply", text).unwrap();
    assert!(scene.nodes().any(|(_, node)| node.kind == "mesh_attribute"));
}

#[test]
fn what_cannot_be_framed_is_an_error() {
    assert!(read("obj", "v nan 0 0\nf 1 1 1\n").is_err());
    assert!(read("obj", "v 1 2 3\n").unwrap_err().to_string().contains("no faces"));
    assert!(read("obj", "v 1 2 3\nf 1 1 1\n").is_ok(), "a point is framed somehow");
}
