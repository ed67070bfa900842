use std::path::Path;

use aureole_desc::{Report, SceneDesc, SceneError, Sources, Value};
use aureole_math::{Point3, Transform, Vector3};

use super::{read_with, show};
use crate::{LoadOptions, load};

/// Writes files into a folder of their own.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

/// Reads a file; an error comes with the file's name, line and column.
fn read(path: &Path) -> Result<(SceneDesc, Report), String> {
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let result = load(path, &LoadOptions::default(), &mut sources, &mut report);
    let place = |error: &SceneError| {
        let place = sources.locate(error.span()).unwrap();
        let (line, column) = place.line_column.unwrap();
        format!("{}:{line}:{column}", place.path.file_name().unwrap().to_string_lossy())
    };
    match result {
        Ok(scene) => Ok((scene, report)),
        Err(error) => Err(format!("{}: {error}", place(&error))),
    }
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nf 1/1 2/1 3/1\n";

#[test]
fn includes_carry_defaults_folders_and_ids() {
    let folder = folder(&[
        (
            "main.xml",
            "<scene version=\"3.0.0\"><default name=\"k\" value=\"2\"/><include filename=\"parts/a.xml\"/>\
            <shape type=\"ply\"><string name=\"filename\" value=\"t.ply\"/><ref id=\"other\"/></shape></scene>",
        ),
        (
            "parts/a.xml",
            "<scene version=\"3.0.0\"><path value=\"../meshes\"/><default name=\"k\" value=\"9\"/><default name=\"l\" value=\"4\"/>\
            <include filename=\"parts/b.xml\"/><alias id=\"red\" as=\"other\"/></scene>",
        ),
        (
            "parts/b.xml",
            "<bsdf type=\"plastic\" id=\"red\"><float name=\"a\" value=\"$k\"/><float name=\"b\" value=\"$l\"/></bsdf>",
        ),
        (
            "meshes/t.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        ),
    ]);
    let (scene, _) = read(&folder.path().join("main.xml")).unwrap();
    assert_eq!(show(&scene, scene.shapes[0]), "mesh(mesh=a mesh bsdf=plastic(a=2 b=4))");
}

#[test]
fn meshes_are_as_mitsuba_reads_them() {
    let shape = |inside: &str| {
        format!("<shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/>{inside}</shape>")
    };
    let flags =
        "<boolean name=\"face_normals\" value=\"true\"/><boolean name=\"flip_tex_coords\" value=\"false\"/>";
    let text = format!("<scene version=\"3.0.0\">{}{}{}</scene>", shape(""), shape(""), shape(flags));
    let folder = folder(&[("s.xml", &text), ("t.obj", TRIANGLE)]);
    let (scene, _) = read(&folder.path().join("s.xml")).unwrap();
    let mut meshes = scene
        .shapes
        .clone()
        .into_iter()
        .map(|id| scene[id].params.clone().try_mesh("mesh").unwrap().unwrap());
    let (first, same, flat) = (meshes.next().unwrap(), meshes.next().unwrap(), meshes.next().unwrap());
    assert_eq!((first.uvs[0], first.normals.len()), ([0.0, 0.75], 3), "v turned round, normals made up");
    assert!(std::sync::Arc::ptr_eq(&first, &same), "a file is read once");
    assert_eq!((flat.uvs[0], flat.normals.len()), ([0.0, 0.25], 0));
    assert!(scene[scene.shapes[2]].params.has("face_normals"));
}

#[test]
fn bitmaps_are_turned_round() {
    let text = "<scene version=\"3.0.0\"><shape type=\"disk\"><bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"bitmap\">\
        <string name=\"filename\" value=\"a.png\"/><boolean name=\"raw\" value=\"true\"/><string name=\"wrap_mode\" value=\"clamp\"/>\
        <transform name=\"to_uv\"><scale value=\"2\"/></transform></texture></bsdf></shape></scene>";
    let folder = folder(&[("s.xml", text), ("a.png", "")]);
    let (scene, _) = read(&folder.path().join("s.xml")).unwrap();
    assert_eq!(
        show(&scene, scene.shapes[0]),
        "disk(bsdf=diffuse(reflectance=bitmap(filename=a.png encoding=linear \
         to_uv=[[2.0, 0.0, 0.0, 0.0], [0.0, -2.0, 0.0, 1.0], [0.0, 0.0, 2.0, 0.0], [0.0, 0.0, 0.0, 1.0]] wrap=clamp)))"
    );
}

/// What Mitsuba's parser lets pass: a blank first line, a document type, dashes in comments, ampersands; and places stay right.
#[test]
fn xml_that_is_not_quite_well_formed_is_read() {
    let scene = |inside: &str| {
        format!(
            "\n<?xml version=\"1.0\"?>\n<!DOCTYPE scene [<!ENTITY a \"b\">]>\n<!-- a -- größer -->\
             <scene version=\"3.0.0\"><!---- & ----><bsdf type=\"plastic\" id=\"Salt & Pepper &amp; &a;\"/>\
             <shape type=\"cube\"><ref id=\"Salt &amp; Pepper & &a;\"/></shape>\n{inside}</scene>"
        )
    };
    let folder =
        folder(&[("s.xml", &scene("")), ("wrong.xml", &scene("<!-- ö -- --><shape type=\"cub\"/>"))]);
    let (scene, report) = read(&folder.path().join("s.xml")).unwrap();
    assert_eq!(show(&scene, scene.shapes[0]), "cube(bsdf=plastic())");
    assert!(report.warnings.is_empty());
    let wrong = read(&folder.path().join("wrong.xml")).unwrap_err();
    assert_eq!(wrong, "wrong.xml:5:14: unknown shape `cub`");
}

#[test]
fn files_that_are_missing_or_go_in_circles() {
    let folder = folder(&[
        ("circle.xml", "<scene version=\"3.0.0\">\n  <include filename=\"b.xml\"/></scene>"),
        ("b.xml", "<scene version=\"3.0.0\">\n\n<include filename=\"circle.xml\"/></scene>"),
        (
            "missing.xml",
            "<scene version=\"3.0.0\">\n <shape type=\"ply\">\n  <string name=\"filename\" value=\"no.ply\"/>\n </shape></scene>",
        ),
        ("lost.xml", "<scene version=\"3.0.0\"><include filename=\"nowhere.xml\"/></scene>"),
        (
            "broken.xml",
            "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/></shape></scene>",
        ),
        ("t.obj", "v 0 0 0\nf 1 2 3\n"),
    ]);
    let wrong = |name: &str| read(&folder.path().join(name)).unwrap_err();
    assert_eq!(
        wrong("circle.xml"),
        "b.xml:3:20: files include each other in a circle: circle.xml → b.xml → circle.xml"
    );
    let missing = wrong("missing.xml");
    assert!(missing.starts_with("missing.xml:3:34: cannot read") && missing.contains("no.ply"), "{missing}");
    let lost = wrong("lost.xml");
    assert!(lost.starts_with("lost.xml:1:43: cannot read"), "{lost}");
    assert!(wrong("broken.xml").ends_with("line 2: index 3 points outside of the 1 vertices"));
}

#[test]
fn edges_stay_sharp_beyond_the_smooth_angle_and_what_a_mesh_lacks_is_said() {
    let right_angle = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 -1\nv 1 0 -1\nf 1 2 3 4\nf 2 1 5 6\nf 1 2\n";
    let folder = folder(&[("t.obj", right_angle)]);
    for (angle, vertices) in [("30", 8), ("91", 6)] {
        let scene = format!(
            "<scene version=\"0.6.0\"><shape type=\"obj\"><string name=\"filename\" value=\"t.obj\"/>\
             <float name=\"maxSmoothAngle\" value=\"{angle}\"/></shape></scene>"
        );
        std::fs::write(folder.path().join("scene.xml"), scene).unwrap();
        let (scene, report) = read(&folder.path().join("scene.xml")).unwrap();
        let Some(Value::Mesh(mesh)) = scene[scene.shapes[0]].params.get("mesh") else { panic!() };
        assert_eq!((mesh.positions.len(), mesh.normals.len()), (vertices, vertices), "{angle} degrees");
        let [warning] = &report.warnings[..] else { panic!("{:?}", report.warnings) };
        assert!(warning.message.ends_with("t.obj`: line 9: a face of fewer than three corners is left out"));
    }
}

#[test]
fn definitions_of_the_user_win() {
    let text = "<scene version=\"3.0.0\"><default name=\"n\" value=\"1\"/><shape type=\"$kind\"><float name=\"radius\" value=\"$n\"/></shape></scene>";
    let define = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    let defines = vec![define("n", "7"), define("kind", "sphere"), define("other", "0")];
    let outcome = read_with(text, &LoadOptions { defines, ..LoadOptions::default() });
    let scene = outcome.result.unwrap();
    assert_eq!(show(&scene, scene.shapes[0]), "sphere(radius=7)");
    assert_eq!(outcome.report.warnings.len(), 1);
    assert!(outcome.report.warnings[0].message.contains("$other"));
}

#[test]
fn ellipsoids_are_stretched_spheres() {
    let folder = folder(&[
        (
            "main.xml",
            "<scene version=\"3.0.0\"><shape type=\"ellipsoids\"><string name=\"filename\" value=\"e.ply\"/>\
            <float name=\"extent\" value=\"2\"/><transform name=\"to_world\"><translate x=\"10\"/></transform>\
            <bsdf type=\"diffuse\"/></shape></scene>",
        ),
        (
            "e.ply",
            // The sizes are the logarithms of 1, 2 and 3; the second is turned by 90 degrees about z.
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
            property float scale_0\nproperty float scale_1\nproperty float scale_2\n\
            property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n\
            1 2 3 0 0.6931472 1.0986123 1 0 0 0\n1 2 3 0 0.6931472 1.0986123 1 0 0 1\n",
        ),
    ]);
    let (scene, report) = read(&folder.path().join("main.xml")).unwrap();
    assert!(report.warnings.iter().all(|warning| !warning.message.contains("ellipsoid")), "{report:?}");
    let places: Vec<Transform> = scene
        .shapes
        .iter()
        .map(|&id| scene[id].params.clone().transform("world_from_object").unwrap())
        .collect();
    let expected = [
        [[2.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 6.0]],
        [[0.0, 2.0, 0.0], [-4.0, 0.0, 0.0], [0.0, 0.0, 6.0]],
    ];
    for (place, columns) in places.iter().zip(expected) {
        assert!((place.point(Point3::ORIGIN) - Point3::new(11.0, 2.0, 3.0)).length() < 1e-5);
        for (axis, column) in [Vector3::X, Vector3::Y, Vector3::Z].into_iter().zip(columns) {
            assert!((place.vector(axis) - Vector3::from(column)).length() < 1e-4, "{place:?}");
        }
    }
    assert_eq!(places.len(), 2);
}
