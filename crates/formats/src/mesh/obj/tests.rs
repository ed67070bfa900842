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
    assert_eq!(second.mesh.normals, [[0.0, 0.0, 1.0]; 6], "missing normals are made up");
}

#[test]
fn the_whole_is_one_mesh() {
    let file = parse(CORNERS, Split::Nothing).unwrap();
    assert_eq!(file.parts.len(), 1);
    assert_eq!(file.parts[0].mesh.indices.len(), 4);
    file.parts[0].mesh.check().unwrap();
}

#[test]
fn lines_may_continue() {
    let file = parse("v 0 0 0\nv 1 \\\n0 0\nv 0 1 0\nf 1 2\\\r\n 3\n", Split::Nothing).unwrap();
    assert_eq!(file.parts[0].mesh.indices, [[0, 1, 2]]);
}

#[test]
fn errors_name_the_line() {
    let wrong = |text: &str| parse(text, Split::Nothing).unwrap_err();
    assert_eq!(wrong("v 0 0 0\nv 1 x 0\n"), "line 2: 3 numbers expected, found `x 0`");
    assert_eq!(wrong("v 0 0 0\nf 1 1 2\n"), "line 2: index 2 points outside of the 1 vertices so far");
    assert_eq!(wrong("v 0 0 0\nf 1 1 -2\n"), "line 2: index -2 points outside of the 1 vertices so far");
    assert_eq!(
        wrong("v 0 0 0\nf 1/1 1 1\n"),
        "line 2: index 1 points outside of the 0 texture coordinates so far"
    );
    assert_eq!(wrong("v 0 0 0\nf 1 1 0\n"), "line 2: index 0 points outside of the 1 vertices so far");
    assert_eq!(wrong("v 0 0 0\nf 1 1 one\n"), "line 2: cannot understand `one` in a face");
    assert_eq!(wrong("v 0 0 0\nf 1 1\n"), "line 2: a face needs three corners, this one has 2");
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
