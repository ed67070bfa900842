use aureole_desc::{AttributeDomain, Limits, Mesh};
use aureole_math::Pcg32;

use super::{PlyFile, decode, decode_columns};

fn read_file(text: &str) -> Result<PlyFile, String> {
    decode(text.as_bytes(), &Limits::default()).map_err(|error| error.to_string())
}

fn read(text: &str) -> Result<Mesh, String> {
    read_file(text).map(|file| file.mesh)
}

const QUAD: &str = "ply\nformat ascii 1.0\ncomment a square\n\
    element face 1\nproperty list uchar int vertex_indices\nproperty float heat_0\n\
    element vertex 4\nproperty float x\nproperty float confidence\nproperty float y\nproperty float z\n\
    property float s\nproperty float t\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n\
    4 0 1 2 3 0.5\n\
    0 9 0 0 0 0 255 0 0\n1 9 0 0 1 0 255 0 51\n1 9 1 0 1 1 0 0 0\n0 9 1 0.25 0 1 0 0 0\n";

/// The square as bytes, of either order.
fn binary(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty double x\nproperty float y\nproperty short z\n\
         property list uint8 uint16 extra\nelement face 2\nproperty list uint8 uint vertex_index\nend_header\n"
    )
    .into_bytes();
    let mut put = |le: &[u8]| {
        let mut le = le.to_vec();
        if big {
            le.reverse();
        }
        bytes.extend(le);
    };
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0_f32]] {
        put(&f64::from(x).to_le_bytes());
        put(&y.to_le_bytes());
        put(&(-3i16).to_le_bytes());
        put(&[1]);
        put(&7u16.to_le_bytes());
    }
    for face in [[0u32, 1, 2], [0, 2, 3]] {
        put(&[3]);
        face.iter().for_each(|i| put(&i.to_le_bytes()));
    }
    bytes
}

#[test]
fn elements_in_any_order_with_polygons_and_attributes() {
    let mesh = read(QUAD).unwrap();
    assert_eq!(mesh.positions[3], [0.0, 1.0, 0.25]);
    assert_eq!(mesh.indices, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.uvs[2], [1.0, 1.0]);
    assert!(mesh.normals.is_empty());
    let [heat, color] = &mesh.attributes[..] else { panic!("{:?}", mesh.attributes) };
    assert_eq!((heat.name.as_str(), heat.domain, heat.channels), ("face_heat", AttributeDomain::Face, 1));
    assert_eq!(heat.data, [0.5, 0.5], "one value a triangle");
    assert_eq!((color.name.as_str(), color.channels), ("vertex_color", 3));
    assert_eq!(color.data[3..6], [1.0, 0.0, 0.2]);
}

#[test]
fn both_byte_orders_read_alike() {
    let little = decode(&binary(false), &Limits::default()).unwrap();
    assert_eq!(little, decode(&binary(true), &Limits::default()).unwrap());
    assert_eq!(little.mesh.positions[2], [1.0, 1.0, -3.0]);
    assert_eq!(little.mesh.indices, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn errors_say_what_and_where() {
    let wrong = |from: &str, to: &str| read(&QUAD.replacen(from, to, 1)).unwrap_err();
    assert_eq!(wrong("ply", "obj"), "not a PLY file: it does not start with `ply`");
    assert_eq!(wrong("format ascii", "format morse"), "line 2: unknown encoding `morse`");
    assert_eq!(wrong("float heat_0", "quad heat_0"), "line 6: cannot understand property `quad heat_0`");
    assert_eq!(wrong("end_header", ""), "line 18: cannot understand `4 0 1 2 3 0.5` in the header");
    assert_eq!(
        wrong("1 9 0 0 1 0", "1 9 nought 0 1 0"),
        "line 20: a number of a vertex is missing or unreadable"
    );
    assert_eq!(wrong("4 0 1 2 3", "4 0 1 2 9"), "vertex index 9 is out of range: the mesh has 4 vertices");
    assert_eq!(wrong("4 0 1 2 3", "4 0 1 2 -3"), "line 18: -3 is no index of a vertex");
    assert!(wrong("vertex 4", "vertex 4000000000").contains("cannot fit"));
    assert!(wrong("4 0 1 2 3", "2 0 1").contains("no faces"));
}

/// A square whose halves show different pictures.
const SCAN: &str = "ply\nformat ascii 1.0\ncomment TextureFile left half.png\ncomment texturefile right.png\n\
    element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty ushort red\nproperty ushort green\n\
    property ushort blue\nelement face 3\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\n\
    property int texnumber\nend_header\n0 0 0 65535 0 0\n1 0 0 0 13107 0\n1 1 0 0 0 0\n0 1 0 0 0 0\n\
    6 0 0 1 0 1 1 3 0 1 2 0\n6 0.5 0 1 1 0 1 3 0 2 3 1\n0 2 0 1 0\n";

#[test]
fn faces_have_texture_coordinates_and_pictures() {
    let file = read_file(SCAN).unwrap();
    assert_eq!(file.pictures, ["left half.png", "right.png"]);
    assert_eq!(file.picture_of, [0, 1]);
    let mesh = &file.mesh;
    assert_eq!(mesh.indices, [[0, 1, 2], [4, 2, 3]], "the first corner is one of two, the third agrees");
    assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0]]);
    assert_eq!(mesh.positions[4], mesh.positions[0]);
    assert_eq!(mesh.attributes[0].data[3 * 4..], [1.0, 0.0, 0.0]);
    assert_eq!(file.notes, ["a face of fewer than three corners is left out"]);

    let [(left, a), (right, b)] = &file.into_parts()[..] else { panic!() };
    assert_eq!((a.as_deref(), b.as_deref()), (Some("left half.png"), Some("right.png")));
    assert_eq!(left.positions, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!((right.indices.as_slice(), right.uvs[0]), (&[[0, 1, 2]][..], [0.5, 0.0]));
    assert_eq!(left.attributes[0].data, [1.0, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn faces_without_their_texture_coordinates_take_those_of_vertices() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float u\nproperty float v\nelement face 2\nproperty list uchar int vertex_index\n\
        property list uchar float texcoord\nend_header\n0 0 0 0.1 0.2\n1 0 0 0.3 0.4\n0 1 0 0.5 0.6\n3 0 1 2 0\n\
        3 0 2 1 4 9 9 9 9\n";
    let file = read_file(text).unwrap();
    assert_eq!(file.mesh.uvs, [[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]);
    assert_eq!(file.notes, ["a face has not two texture coordinates for each of its corners: it has none"]);
}

const STRIPS: &str = "ply\nformat ascii 1.0\nelement tristrips 2\nproperty list int int vertex_indices\nelement vertex 6\n\
    property float x\nproperty float y\nproperty float z\nelement edge 1\nproperty int a\nend_header\n\
    10 0 1 2 3 -1 3 3 4 5 -1\n3 5 4 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n7\n";

#[test]
fn strips_alternate_and_begin_anew() {
    let file = read_file(STRIPS).unwrap();
    // The second strip begins with a triangle without area, so that its second triangle is turned round.
    assert_eq!(file.mesh.indices, [[0, 1, 2], [2, 1, 3], [4, 3, 5], [5, 4, 0]]);
    assert!(file.notes[0].contains("`edge`"), "{:?}", file.notes);
    let unsigned = STRIPS.replace("list int int", "list int uint").replace("-1", "4294967295");
    assert_eq!(read(&unsigned).unwrap(), file.mesh);
    assert_eq!(
        read(&STRIPS.replace("5 4 0", "5 4 8")).unwrap_err(),
        "vertex index 8 is out of range: the mesh has 6 vertices"
    );
}

#[test]
fn colours_span_their_type() {
    let color = |ty: &str, values: &str| {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property {ty} red\nproperty {ty} green\nproperty {ty} blue\nelement face 1\n\
             property list uchar int vertex_index\nend_header\n0 0 0 {values}\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n"
        );
        let data = read(&text).unwrap().attributes[0].data.clone();
        [data[0], data[1], data[2]].map(|x| (x * 1000.0).round() / 1000.0)
    };
    let wanted = [1.0, 0.2, 0.0];
    for (ty, values) in [
        ("uchar", "255 51 0"),
        ("char", "127 25.4 0"),
        ("ushort", "65535 13107 0"),
        ("int16", "32767 6553.4 0"),
        ("int", "255 51 0"),
        ("uint", "65535 13107 0"),
        ("int32", "2147483647 429496729 0"),
        ("uint32", "4294967295 858993459 0"),
        ("float", "1 0.2 0"),
        ("double", "1 0.2 0"),
    ] {
        assert_eq!(color(ty, values), wanted, "{ty}");
    }
    assert_eq!(color("ushort", "255 51 0"), [0.004, 0.001, 0.0], "not so bright");
}

#[test]
fn headers_may_end_their_lines_in_any_way() {
    let quad = read(QUAD).unwrap();
    for end in ["\r", "\r\n"] {
        let text = format!("\u{feff}{}", QUAD.replace('\n', end));
        assert_eq!(read(&text).unwrap(), quad, "{end:?}");
        let wrong = text.replace("0 9 1 0.25", "0 9 one 0.25");
        assert_eq!(read(&wrong).unwrap_err(), "line 22: a number of a vertex is missing or unreadable");
    }
    // The first byte of the body looks like the second half of a line's end.
    let mut bytes =
        b"ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\rproperty uchar y\r\
        property uchar z\relement face 1\rproperty list uchar uchar vertex_index\rend_header\r"
            .to_vec();
    bytes.extend([10, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2]);
    assert_eq!(decode(&bytes, &Limits::default()).unwrap().mesh.positions[0], [10.0, 0.0, 0.0]);
}

#[test]
fn limits_hold() {
    let limits = Limits { max_mesh_elements: 3, ..Limits::default() };
    assert_eq!(decode(QUAD.as_bytes(), &limits).unwrap_err().to_string(), "vertices: 4 > 3");
}

#[test]
fn broken_files_never_panic() {
    let mut rng = Pcg32::new(1);
    let texts = [QUAD, SCAN, STRIPS].map(|text| text.as_bytes().to_vec());
    for whole in texts.into_iter().chain([binary(false), binary(true)]) {
        for end in 0..whole.len() {
            let _ = decode(&whole[..end], &Limits::default());
        }
        for _ in 0..20_000 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                let i = rng.next_u32() as usize % bytes.len();
                bytes[i] ^= 1 << (rng.next_u32() % 8);
            }
            if let Ok(file) = decode(&bytes, &Limits::default()) {
                file.mesh.check().unwrap();
                assert!(file.into_parts().iter().all(|(mesh, _)| mesh.check().is_ok()));
            }
        }
    }
}

#[test]
fn columns_are_found_by_name() {
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty list uchar int f\nproperty float y\nend_header\n1 2 8 9 3\n4 0 5\n";
    let columns = |names: &[&str]| decode_columns(text.as_bytes(), names, &Limits::default());
    assert_eq!(columns(&["y", "x"]).unwrap(), [3.0, 1.0, 5.0, 4.0]);
    assert!(columns(&["z"]).is_err());
    for length in 0..text.len() - 2 {
        assert!(decode_columns(&text.as_bytes()[..length], &["y"], &Limits::default()).is_err(), "{length}");
    }
}
