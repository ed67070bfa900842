use std::path::Path;

use aureole_desc::{Node, Report, SceneDesc, SceneError, Sources, Value};
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

/// Writes files into a folder and reads the first.
fn read_files(files: &[(&str, &str)]) -> (SceneDesc, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let path = folder.path().join(files[0].0);
    let scene = load(&path, &LoadOptions::default(), &mut sources, &mut report).unwrap();
    (scene, report.warnings.into_iter().map(|warning| warning.message).collect())
}

/// The file names of all pictures.
fn pictures(scene: &SceneDesc) -> Vec<String> {
    let file = |node: &Node| match node.params.get("filename") {
        Some(Value::Path(path)) => path.file_name().map(|name| name.to_string_lossy().into_owned()),
        _ => None,
    };
    scene.nodes().filter_map(|(_, node)| file(node)).collect()
}

#[test]
fn colours_of_obj_vertices_are_shown_unless_a_picture_is() {
    let shown = |mtl: &str| {
        let obj = "mtllib a.mtl\nusemtl a\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
        let (scene, _) = read_files(&[("a.obj", obj), ("a.mtl", mtl)]);
        let kinds: Vec<_> = scene.nodes().map(|(_, node)| node.kind.clone()).collect();
        let diffuse =
            scene.nodes().filter(|(_, node)| node.kind == "rough_plastic" || node.kind == "diffuse").last();
        let reflectance =
            ["reflectance", "diffuse_reflectance"].map(|name| diffuse.unwrap().1.params.get(name));
        let Some(Value::Node(texture)) = reflectance.into_iter().flatten().next() else {
            return kinds.join(" ");
        };
        scene[*texture].kind.clone()
    };
    assert_eq!(shown("newmtl b\n"), "mesh_attribute", "without a material");
    assert_eq!(shown("newmtl a\nKd 1 1 1\nKs 1 1 1\n"), "mesh_attribute");
    assert_eq!(shown("newmtl a\nmap_Kd a.png\n"), "bitmap");
}

#[test]
fn a_picture_that_is_missing_is_seen_unless_it_is_no_colour() {
    let mtl = "newmtl a\nmap_Kd gone.png\nmap_Bump bump.png\nmap_d holes.png\n";
    let (scene, warnings) =
        read_files(&[("a.obj", &format!("mtllib a.mtl\nusemtl a\n{TRIANGLE}")), ("a.mtl", mtl)]);
    assert_eq!(
        pictures(&scene),
        ["gone.png"],
        "the renderer puts a placeholder in its place, with a warning"
    );
    assert!(warnings.len() == 2 && warnings.iter().all(|w| w.contains("left out")), "{warnings:?}");
}

const QUAD: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\n\
    property float t\nelement face 2\nproperty list uchar int vertex_index\nproperty int texnumber\nend_header\n\
    0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2 0\n3 0 2 1 1\n";

#[test]
fn ply_files_are_flat_and_show_their_pictures() {
    let ply = |comments: &str| format!("ply\nformat ascii 1.0\n{comments}{QUAD}");
    let two = ply("comment TextureFile C:\\scans\\A.PNG\ncomment TextureFile b.png\n");
    let (scene, warnings) = read_files(&[("a.ply", &two), ("a.png", "")]);
    assert_eq!(pictures(&scene), ["a.png", "b.png"]);
    assert!(warnings.is_empty(), "{warnings:?}");
    let meshes = scene.shapes.iter().filter_map(|&id| match scene[id].params.get("mesh") {
        Some(Value::Mesh(mesh)) => Some((mesh.indices.len(), scene[id].params.get("face_normals"))),
        _ => None,
    });
    assert_eq!(meshes.collect::<Vec<_>>(), [(1, Some(&Value::Bool(true))); 2]);

    let without = ply("comment TextureFile a.png\n").replace("float s", "float q");
    let (scene, warnings) = read_files(&[("a.ply", &without), ("a.png", "")]);
    assert!(pictures(&scene).is_empty() && warnings[0].contains("no texture coordinates"), "{warnings:?}");
}

#[test]
fn libraries_are_read_once_and_the_first_material_of_a_name_counts() {
    let obj = format!(
        "mtllib a.mtl b.mtl\nmtllib A.mtl\nmtllib gone.mtl\nusemtl paint\n{TRIANGLE}usemtl Pant\nf 1 2 3\n"
    );
    let (a, b) = ("\u{feff}newmtl paint\nillum 7\n", "newmtl paint\nKd 1 0 0\nPc 1\n");
    let (scene, warnings) = read_files(&[("a.obj", &obj), ("a.mtl", a), ("b.mtl", b)]);
    assert!(scene.nodes().any(|(_, node)| node.kind == "dielectric"));
    let [pc, gone, pant] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(pc.contains("`Pc`") && gone.contains("gone.mtl") && pant.contains("`Pant`"), "{warnings:?}");
}

#[test]
fn what_cannot_be_framed_is_an_error() {
    assert!(read("obj", "v nan 0 0\nf 1 1 1\n").is_err());
    assert!(read("obj", "v 1 2 3\n").unwrap_err().to_string().contains("no faces"));
    assert!(read("obj", "v 1 2 3\nf 1 1 1\n").is_ok(), "a point is framed somehow");
}
