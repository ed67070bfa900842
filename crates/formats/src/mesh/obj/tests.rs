use aureole_desc::Limits;
use aureole_math::Pcg32;

use super::{ObjFile, Split};

const CORNERS: &str = "# a square and a triangle\nmtllib my lib.mtl\no first\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\n\
    vt 0 0\nvt 1 0 0\nvt 1\nvt 0 1\nvn 0 0 1\nusemtl red\nf 1/1/1 2/2/1 3/3/1 4/4/1\n\
    g second\nusemtl blue\nf -4//-1 -3//1 -2//1 # with a comment\nf 1/1 2/2 3/4\n";

fn parse(text: &str, split: Split) -> Result<ObjFile, String> {
    ObjFile::parse(text.as_bytes(), split, &Limits::default()).map_err(|error| error.to_string())
}

#[test]
fn parts_with_their_materials() {
    let file = parse(CORNERS, Split::Parts).unwrap();
    assert_eq!(file.libraries, ["my lib.mtl"]);
    let [first, second] = &file.parts[..] else { panic!("{:?}", file.parts) };
    assert_eq!((first.name.as_str(), first.material.as_deref()), ("first", Some("red")));
    assert_eq!(first.mesh.indices, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(first.mesh.positions.len(), 4, "corners that agree are one vertex");
    assert_eq!(first.mesh.uvs[2], [1.0, 0.0]);
    assert_eq!(first.mesh.normals, [[0.0, 0.0, 1.0]; 4]);
    assert_eq!((second.name.as_str(), second.material.as_deref()), ("second", Some("blue")));
    assert_eq!(second.mesh.positions.len(), 6, "with and without a normal are two vertices");
    assert_eq!(second.mesh.normals, [[0.0, 0.0, 1.0]; 6], "missing normals are those of the face");
    assert!(file.notes.is_empty(), "{:?}", file.notes);
}

#[test]
fn the_whole_is_one_mesh() {
    let file = parse(CORNERS, Split::Nothing).unwrap();
    assert_eq!(file.parts.len(), 1);
    assert_eq!(file.parts[0].mesh.indices.len(), 4);
    file.parts[0].mesh.check().unwrap();
}

#[test]
fn lines_may_end_and_continue_in_many_ways() {
    let text = "\u{feff}v 0 0 0\nv 1 \\\n0 0\n# C:\\models\\\nv 0 1 0\nf 1 2\\\n 3\n";
    for end in ["\n", "\r\n", "\r"] {
        let file = parse(&text.replace('\n', end), Split::Nothing).unwrap();
        assert_eq!(file.parts[0].mesh.indices, [[0, 1, 2]], "{end:?}");
        assert_eq!(file.parts[0].mesh.positions[1], [1.0, 0.0, 0.0]);
        let wrong = text.replace("\nf", "\nv x\nf").replace('\n', end);
        assert_eq!(parse(&wrong, Split::Nothing).unwrap_err(), "line 6: 3 numbers expected, found `x`");
    }
}

#[test]
fn errors_name_the_line() {
    let wrong = |text: &str| parse(text, Split::Nothing).unwrap_err();
    assert_eq!(wrong("v 0 0 0\nv 1 x 0\n"), "line 2: 3 numbers expected, found `x 0`");
    assert_eq!(wrong("v 0 0 0\nf 1 1 2\nf 1 1 1\n"), "line 2: index 2 points outside of the 1 vertices");
    assert_eq!(wrong("v 0 0 0\nf 1 1 -2\n"), "line 2: index -2 points outside of the 1 vertices");
    assert_eq!(wrong("v 0 0 0\nf 1 1 0\n"), "line 2: index 0 points outside of the 1 vertices");
    assert_eq!(
        wrong("v 0 0 0\nf 1 1 99999999999999999999\n"),
        "line 2: index 9223372036854775807 points outside of the 1 vertices"
    );
    assert_eq!(wrong("v 0 0 0\nf 1 1 one\n"), "line 2: cannot understand `one` in a face");
}

#[test]
fn indices_may_run_ahead() {
    let file = parse("f 1//1 2//1 3//1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 0\n", Split::Nothing).unwrap();
    assert_eq!(file.parts[0].mesh.normals, [[0.0, 1.0, 0.0]; 3]);
    assert!(file.notes.is_empty());
}

#[test]
fn what_is_left_out_is_said() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1.#IND 0 0\nvt 0.5\n\
        f 1/1/0 2/1/1 3/7/1\nf 1 2\nf 2 3\nf 1\np 1 2\nl 1 2 3\n\
        cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 1\nparm u 0 1\nend\nlod 0\nbevel on\nfoo\n";
    let file = parse(text, Split::Parts).unwrap();
    assert_eq!(file.parts[0].mesh.indices, [[0, 1, 2]]);
    assert_eq!(file.parts[0].mesh.uvs, [[0.5, 0.0], [0.5, 0.0], [0.0; 2]]);
    let notes = [
        "line 4: 3 numbers expected, found `#IND 0 0`: zeros are taken",
        "line 6: an index points to no normal: that corner has none",
        "line 7: a face of fewer than three corners is left out (and 2 more)",
        "line 10: points (`p`) are left out",
        "line 11: lines (`l`) are left out",
        "line 14: free-form geometry (`surf`) is left out: only faces are read",
        "line 18: `bevel` is left out: only faces, their materials and groups are read",
        "line 19: `foo` is left out: only faces, their materials and groups are read",
        "line 6: index 7 points outside of the 1 texture coordinates: corners like this have none",
    ];
    assert_eq!(file.notes, notes);
    let only = parse("v 0 0 0\nsurf 0 1 0 1 1 1 1 1\n", Split::Parts).unwrap();
    assert!(only.no_faces().to_string().contains("(`surf`)"), "{}", only.no_faces());
}

/// Two squares that meet at a right angle along x.
const ANGLE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 -1\nv 1 0 -1\n";

#[test]
fn smoothing_groups_join_their_faces_alone() {
    let normals = |faces: &str, split| {
        let mesh = parse(&format!("{ANGLE}{faces}"), split).unwrap().parts.remove(0).mesh;
        mesh.check().unwrap();
        let normal =
            |triangle: usize| mesh.normals[mesh.indices[triangle][0] as usize].map(|x| (x * 100.0).round());
        (!mesh.normals.is_empty()).then(|| [normal(0), normal(2)])
    };
    let (up, front, between) = ([0.0, 0.0, 100.0], [0.0, -100.0, 0.0], [0.0, -71.0, 71.0]);
    assert_eq!(normals("s 1\nf 1 2 3 4\nf 2 1 5 6\n", Split::Parts), Some([between; 2]));
    assert_eq!(normals("s 1\nf 1 2 3 4\ns 2\nf 2 1 5 6\n", Split::Parts), Some([up, front]));
    assert_eq!(normals("s 1\nf 1 2 3 4\ns off\nf 2 1 5 6\n", Split::Parts), Some([up, front]));
    assert_eq!(normals("f 1 2 3 4\nf 2 1 5 6\n", Split::Parts), None, "flat");
    assert_eq!(normals("s 1\nf 1 2 3 4\nf 2 1 5 6\n", Split::Nothing), None, "not looked at");
    let written = "vn 1 0 0\ns 1\nf 1//1 2//1 3//1 4//1\ns off\nf 2 1 5 6\n";
    assert_eq!(normals(written, Split::Parts), Some([[100.0, 0.0, 0.0], front]));
}

#[test]
fn broken_files_never_panic() {
    let mut rng = Pcg32::new(2);
    for _ in 0..30_000 {
        let mut bytes = CORNERS.as_bytes().to_vec();
        for _ in 0..4 {
            let i = rng.next_u32() as usize % bytes.len();
            bytes[i] ^= 1 << (rng.next_u32() % 8);
        }
        bytes.truncate(rng.next_u32() as usize % (2 * bytes.len()));
        if let Ok(file) = ObjFile::parse(&bytes, Split::Parts, &Limits::default()) {
            file.parts.iter().for_each(|part| part.mesh.check().unwrap());
        }
    }
}

#[test]
fn colours_behind_positions_are_an_attribute() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0\nv 0 1 0 0 0 1\nf 1 2 3 4\n";
    let file = parse(text, Split::Nothing).unwrap();
    let mesh = &file.parts[0].mesh;
    assert_eq!(mesh.polygons, [4]);
    assert_eq!(mesh.attributes[0].name, "vertex_color");
    assert_eq!(mesh.attributes[0].data, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0]);
    assert!(parse(CORNERS, Split::Nothing).unwrap().parts[0].mesh.attributes.is_empty());
}

#[test]
fn colours_are_understood_in_all_their_ranges() {
    let colors = |lines: [&str; 3]| {
        let [a, b, c] = lines;
        let file =
            parse(&format!("v 0 0 0 {a}\nv 1 0 0 {b}\nv 0 1 0 {c}\nf 1 2 3\n"), Split::Nothing).unwrap();
        (file.parts[0].mesh.attributes.first().map(|a| a.data.clone()), file.notes.len())
    };
    let wanted = Some(vec![1.0, 0.0, 0.2, 0.0, 0.6, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!(colors(["1 0 0.2", "0 0.6 0", ""]), (wanted.clone(), 0));
    assert_eq!(colors(["255 0 51", "0 153 0", "255 255 255"]), (wanted.clone(), 0), "bytes");
    assert_eq!(colors(["65535 0 13107", "0 39321 0", ""]), (wanted.clone(), 0), "16 bits");
    assert_eq!(colors(["1 1 0 0.2", "1 0 0.6 0", "1 1 1 1"]), (wanted.clone(), 0), "weights before them");
    assert_eq!(colors(["1 0 0.2 1", "0 0.6 0 1", "1 1 1 1"]), (wanted.clone(), 0), "opacities behind them");
    assert_eq!(
        colors(["1 0 0.2 0.5", "0 0.6 0 1", "1 1 1 1"]),
        (wanted.clone(), 1),
        "which are said where they count"
    );
    assert_eq!(colors(["1", "0.5", "2"]), (None, 0), "weights alone");
    assert_eq!(colors(["1 0", "", ""]), (None, 1));
    assert_eq!(colors(["", "", "\n#MRGB ffff0033ff009900\n#MRGB ffffffff"]), (wanted, 0), "painted");
}
