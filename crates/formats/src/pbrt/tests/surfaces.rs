//! What surfaces and lamps look like where pbrt-v4 has rules of its own.

use aureole_desc::{Node, Report, SceneDesc, Sources, Value};

use super::{good, mistake, warnings};
use crate::{LoadOptions, load};

fn flips(desc: &SceneDesc) -> Vec<bool> {
    let flip = |node: &Node| node.params.get("flip_normals") == Some(&Value::Bool(true));
    desc.shapes.iter().map(|&id| flip(&desc[id])).collect()
}

fn word(text: &str) -> Option<Value> {
    Some(Value::String(text.into()))
}

#[test]
fn lamps_shine_where_points_of_them_are_drawn() {
    const KINDS: [&str; 6] = [
        "\"sphere\"",
        "\"disk\"",
        "\"cylinder\"",
        "\"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]",
        "\"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]",
        "\"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]",
    ];
    let shapes = KINDS.map(|kind| format!("Shape {kind} ")).concat();
    let found = |before: &str| flips(&good(&format!("WorldBegin {before} {shapes}")));
    let (lamp, mirror) = ("AreaLightSource \"diffuse\"", "Scale -1 1 1");
    // Subdivided surfaces face the other way than their triangles.
    let plain = vec![false, false, false, false, false, true];
    let reversed: Vec<bool> = plain.iter().map(|flip| !flip).collect();
    for before in ["", mirror] {
        assert_eq!(found(&format!("{before} {lamp}")), plain);
        assert_eq!(found(&format!("{before} {lamp} ReverseOrientation")), reversed);
    }
    assert_eq!(found(""), plain);
    // What does not shine is turned round with its frame, if it has one of its own.
    assert_eq!(found(mirror), [true, true, true, false, false, true]);
    assert_eq!(found(&format!("{mirror} ReverseOrientation")), [false, false, false, true, true, false]);
}

#[test]
fn triangles_without_coordinates_have_half_a_square() {
    let desc = good(
        "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]
         Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]",
    );
    for &id in &desc.shapes {
        assert_eq!(desc[id].params.get("default_uvs").cloned(), word("half_square"));
    }
}

#[test]
fn illuminance_is_what_pbrt_makes_of_it() {
    const PORTAL: &str = "\"point3 portal\" [0 0 0  0 1 0  1 1 0  1 0 0]";
    let desc = good(&format!(
        "WorldBegin LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float illuminance\" 3
         LightSource \"infinite\" \"rgb L\" [2 2 2] {PORTAL} \"float scale\" 3
         LightSource \"infinite\" \"rgb L\" [2 2 2] {PORTAL} \"float illuminance\" 12.5663706"
    ));
    let light = |i: usize| &desc[desc.lights[i]];
    assert_eq!(light(0).params.get("illuminance"), Some(&Value::Float(6.0)));
    assert_eq!(light(0).params.get("filter").cloned(), word("nearest"));
    for (i, wanted) in [(1, 6.0), (2, 2.0)] {
        assert_eq!(light(i).kind, "portal_envmap");
        let Some(Value::Spectrum(tint)) = light(i).params.get("tint") else { panic!("{:?}", light(i)) };
        let tint = tint.to_rgb(aureole_spectrum::SpectrumRole::Illuminant);
        assert!(tint.iter().all(|c| (c - wanted).abs() < 1e-4), "{i}: {tint:?}");
    }
    assert!(warnings(&format!("WorldBegin LightSource \"infinite\" \"rgb L\" [1 1 1] {PORTAL}")).is_empty());
}

#[test]
fn power_is_of_each_triangle() {
    let desc = good(
        "WorldBegin AreaLightSource \"diffuse\" \"float power\" 8
         Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] Shape \"sphere\"
         AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]",
    );
    let drawn: Vec<_> = desc.shapes.iter().map(|&id| desc[id].params.get("drawn").cloned()).collect();
    assert_eq!(drawn, [word("each_alike"), None, None]);
}

#[test]
fn pictures_wrap_in_four_ways() {
    let wrap = |wrap: &str| {
        let text = format!(
            "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"string wrap\" \"{wrap}\""
        );
        let desc = good(&text);
        desc.nodes().find_map(|(_, node)| node.params.get("wrap").cloned())
    };
    for (theirs, ours) in [("black", "black"), ("octahedralsphere", "octahedral")] {
        assert_eq!(wrap(theirs), word(ours));
    }
    let wrong = "WorldBegin\nTexture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.png\" \"string wrap\" \"mirror\"";
    assert!(mistake(wrong).0.contains("octahedralsphere"));
}

/// A PLY file of these faces over the corners of a cube.
fn scene_with(faces: &[&[u32]], before: &str) -> SceneDesc {
    let folder = tempfile::tempdir().unwrap();
    let corners: String = (0..8).map(|i| format!("{} {} {}\n", i & 1, i >> 1 & 1, i >> 2)).collect();
    let list = |face: &&[u32]| {
        let numbers: Vec<String> = face.iter().map(u32::to_string).collect();
        format!("{} {}\n", face.len(), numbers.join(" "))
    };
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n{corners}{}",
        faces.len(),
        faces.iter().map(list).collect::<String>()
    );
    std::fs::write(folder.path().join("a.ply"), ply).unwrap();
    let scene = folder.path().join("a.pbrt");
    std::fs::write(&scene, format!("WorldBegin {before} Shape \"plymesh\" \"string filename\" \"a.ply\""))
        .unwrap();
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let desc = load(&scene, &LoadOptions::default(), &mut sources, &mut report).unwrap();
    assert!(report.warnings.is_empty(), "{report:?}");
    desc
}

#[test]
fn faces_of_four_corners_are_patches() {
    let kinds =
        |desc: &SceneDesc| -> Vec<String> { desc.shapes.iter().map(|&id| desc[id].kind.clone()).collect() };
    let desc = scene_with(&[&[0, 1, 3, 2]], "");
    assert_eq!(kinds(&desc), ["bilinear_mesh"]);
    let patch = &desc[desc.shapes[0]].params;
    // Corners in the order of their parameters, not around the face.
    assert_eq!(patch.get("indices"), Some(&Value::Ints([0, 1, 2, 3].into())));
    assert!(!patch.has("mesh") && patch.has("bsdf"));

    let desc = scene_with(&[&[0, 1, 3, 2], &[0, 1, 4], &[4, 6, 7, 5], &[0, 1, 3, 7, 4]], "Scale 2 2 2");
    assert_eq!(kinds(&desc), ["mesh", "bilinear_mesh"]);
    let [triangles, patches] = [0, 1].map(|i| &desc[desc.shapes[i]].params);
    let Some(Value::Mesh(mesh)) = triangles.get("mesh") else { panic!() };
    assert_eq!(mesh.indices, [[0, 1, 4], [0, 1, 3], [0, 3, 7], [0, 7, 4]]);
    assert_eq!(patches.get("indices"), Some(&Value::Ints([0, 1, 2, 3, 4, 6, 5, 7].into())));
    assert_eq!(triangles.get("world_from_object"), patches.get("world_from_object"));

    assert_eq!(kinds(&scene_with(&[&[0, 1, 4]], "")), ["mesh"]);
}

#[test]
fn patches_are_in_the_objects_of_their_meshes() {
    let desc = scene_with(
        &[&[0, 1, 3, 2], &[0, 1, 4]],
        "ObjectBegin \"o\" Shape \"plymesh\" \"string filename\" \"a.ply\" ObjectEnd ObjectInstance \"o\"",
    );
    let group = desc.nodes().find(|(_, node)| node.kind == "group").map(|(_, node)| node).expect("is there");
    let Some(Value::Nodes(shapes)) = group.params.get("shapes") else { panic!() };
    let kinds: Vec<&str> = shapes.iter().map(|&id| desc[id].kind.as_str()).collect();
    assert_eq!(kinds, ["mesh", "bilinear_mesh"]);
}
