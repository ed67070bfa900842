use aureole_desc::{AttributeDomain, Limits, Mesh};
use aureole_math::Pcg32;

use super::{decode, decode_columns};

fn read(text: &str) -> Result<Mesh, String> {
    decode(text.as_bytes(), &Limits::default()).map_err(|error| error.to_string())
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
    assert_eq!(little.positions[2], [1.0, 1.0, -3.0]);
    assert_eq!(little.indices, [[0, 1, 2], [0, 2, 3]]);
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

#[test]
fn limits_hold() {
    let limits = Limits { max_mesh_elements: 3, ..Limits::default() };
    assert_eq!(decode(QUAD.as_bytes(), &limits).unwrap_err().to_string(), "vertices: 4 > 3");
}

#[test]
fn broken_files_never_panic() {
    let mut rng = Pcg32::new(1);
    for whole in [QUAD.as_bytes().to_vec(), binary(false), binary(true)] {
        for end in 0..whole.len() {
            let _ = decode(&whole[..end], &Limits::default());
        }
        for _ in 0..20_000 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                let i = rng.next_u32() as usize % bytes.len();
                bytes[i] ^= 1 << (rng.next_u32() % 8);
            }
            if let Ok(mesh) = decode(&bytes, &Limits::default()) {
                mesh.check().unwrap();
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
