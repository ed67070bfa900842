//! Scenes that no file could describe: any kinds of elements, with any values of any type, naming each other at will.

use std::sync::Arc;

use aureole::desc::{Family, Mesh, Node, NodeId, ParamDoc, Params, SceneDesc, Span, Value};
use aureole::elements::{Camera, Filter, Light, Manual, Material, Sampler, Shape, Texture};
use aureole::math::{Transform, Vector3};
use aureole::scene::manual;
use aureole::spectrum::SpectrumSource;

/// Numbers worth trying wherever a number goes; ordinary ones are many, so that scenes often work.
const NUMBERS: &[f64] = &[
    0.5,
    1.0,
    0.1,
    2.0,
    0.0,
    -1.0,
    10.0,
    45.0,
    0.25,
    1.5,
    1e-30,
    1e30,
    -0.0,
    1e-6,
    90.0,
    180.0,
    360.0,
    1e9,
    f64::NAN,
    f64::INFINITY,
];
const INTEGERS: &[i64] = &[1, 2, 0, 3, 4, -1, 8, 16, 5, 100, i64::MAX, i64::MIN, 1 << 31, 1 << 20, 12, 1000];
/// Words that mean something to some element.
const WORDS: &[&str] = &[
    "ggx",
    "beckmann",
    "Au",
    "none",
    "bk7",
    "repeat",
    "clamp",
    "nearest",
    "srgb",
    "x",
    "diagonal",
    "smooth",
    "nonsense",
    "none",
    "loop",
    "catmull_clark",
    "flat",
    "ribbon",
    "cylinder",
    "bezier",
    "bspline",
    "linear",
];

/// Reads choices from bytes; where they end, every choice is the first one.
struct Choices<'a> {
    bytes: std::slice::Iter<'a, u8>,
}

impl Choices<'_> {
    fn below(&mut self, n: usize) -> usize {
        usize::from(self.bytes.next().copied().unwrap_or(0)) % n.max(1)
    }

    fn of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    fn number(&mut self) -> f64 {
        self.of(NUMBERS)
    }

    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }
}

/// The scene that these bytes choose.
pub(crate) fn describe(bytes: &[u8]) -> SceneDesc {
    let mut choices = Choices { bytes: bytes.iter() };
    let mut desc = SceneDesc::default();
    let mut manuals = Vec::new();
    for _ in 0..4 + choices.below(12) {
        let family = choices.of(FAMILIES);
        let manual = kinds(family);
        let manual = manual[choices.below(manual.len())];
        let id = desc.add(Node::new(family, manual.kind, Params::new(), Span::NONE));
        manuals.push(manual.params);
        add_root(&mut desc, family, id);
    }
    let ids: Vec<NodeId> = desc.nodes().map(|(id, _)| id).collect();
    for (&id, params) in ids.iter().zip(manuals) {
        for doc in params {
            // Most parameters keep their defaults, and some have a value of a wrong type.
            let value = match choices.below(5) {
                0..=2 => continue,
                3 => fitting(&mut choices, doc, &ids),
                _ => any(&mut choices, &ids),
            };
            desc[id].params.push(doc.name, value, Span::NONE);
        }
    }
    desc
}

const FAMILIES: &[Family] = &[
    Family::Shape,
    Family::Bsdf,
    Family::Texture,
    Family::Light,
    Family::Shape,
    Family::Camera,
    Family::Filter,
    Family::Sampler,
    Family::Integrator,
];

fn kinds(family: Family) -> Vec<Manual> {
    match family {
        Family::Bsdf => Material::manual(),
        Family::Texture => Texture::manual(),
        Family::Light => Light::manual(),
        Family::Camera => Camera::manual(),
        Family::Filter => Filter::manual(),
        Family::Sampler => Sampler::manual(),
        Family::Integrator => {
            let all = aureole::render::integrators().iter();
            all.map(|m| Manual { kind: m.kind, summary: m.summary, params: m.params }).collect()
        }
        _ => Shape::manual().into_iter().chain([manual::GROUP, manual::INSTANCE]).collect(),
    }
}

/// Makes a node part of the scene, where its family has a place there.
fn add_root(desc: &mut SceneDesc, family: Family, id: NodeId) {
    match family {
        Family::Shape => desc.shapes.push(id),
        Family::Light => desc.lights.push(id),
        Family::Camera => desc.cameras.push(id),
        Family::Filter => desc.filter = Some(id),
        Family::Sampler => desc.sampler = Some(id),
        Family::Integrator => desc.integrator = Some(id),
        _ => {}
    }
}

/// A value of the type that the manual asks for.
fn fitting(choices: &mut Choices<'_>, doc: &ParamDoc, ids: &[NodeId]) -> Value {
    match doc.ty {
        "bool" => Value::Bool(choices.below(2) == 1),
        "int" => Value::Int(choices.of(INTEGERS)),
        "float" | "float or name" | "float or pair" => Value::Float(choices.number()),
        "string" => {
            // What the manual quotes are the words that mean something.
            let quoted: Vec<&str> = doc.doc.split('`').skip(1).step_by(2).collect();
            let known = if quoted.is_empty() || choices.below(8) == 0 { WORDS } else { &quoted };
            Value::String(choices.of(known).to_owned())
        }
        "point" | "vector" => Value::Vec3(choices.numbers()),
        "spectrum" => Value::Spectrum(SpectrumSource::Rgb(choices.numbers().map(|x: f64| x as f32))),
        "transform" => Value::Transform(transform(choices)),
        "mesh" => Value::Mesh(Arc::new(mesh(choices))),
        "floats" => Value::Floats((0..choices.below(32)).map(|_| choices.number() as f32).collect()),
        "ints" => Value::Ints((0..choices.below(12)).map(|_| choices.of(INTEGERS) as i32).collect()),
        "path" => Value::Path("nowhere/picture.png".into()),
        "shapes" => Value::Nodes((0..choices.below(4)).map(|_| choices.of(ids)).collect()),
        "texture" if choices.below(2) == 0 => Value::Float(choices.number()),
        _ => Value::Node(choices.of(ids)),
    }
}

/// A value of any type.
fn any(choices: &mut Choices<'_>, ids: &[NodeId]) -> Value {
    const TYPES: &[&str] = &[
        "bool",
        "int",
        "float",
        "string",
        "point",
        "spectrum",
        "transform",
        "mesh",
        "floats",
        "ints",
        "path",
        "shapes",
        "bsdf",
    ];
    let ty = choices.of(TYPES);
    fitting(choices, &ParamDoc { name: "", ty, default: "", doc: "" }, ids)
}

fn transform(choices: &mut Choices<'_>) -> Transform {
    let vector = |choices: &mut Choices<'_>| {
        let [x, y, z] = choices.numbers().map(|x: f64| x as f32);
        Vector3::new(x, y, z)
    };
    match choices.below(4) {
        0 => Transform::translate(vector(choices)),
        1 => Transform::scale(vector(choices)),
        2 => Transform::rotate(vector(choices), choices.number()),
        _ => Transform::from_rows(std::array::from_fn(|_| choices.numbers())).unwrap_or_default(),
    }
}

fn mesh(choices: &mut Choices<'_>) -> Mesh {
    let vertices = choices.below(8);
    let vector = |choices: &mut Choices<'_>| choices.numbers().map(|x: f64| x as f32);
    let positions: Vec<[f32; 3]> = (0..vertices).map(|_| vector(choices)).collect();
    let indices = (0..choices.below(6)).map(|_| [0; 3].map(|_: u32| choices.below(9) as u32)).collect();
    let has_normals = choices.below(2) == 1;
    let normals = if has_normals { (0..vertices).map(|_| vector(choices)).collect() } else { Vec::new() };
    Mesh { positions, indices, normals, ..Mesh::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_choose_everything() {
        assert_ne!(describe(&[]).len(), 0);
        let bytes: Vec<u8> = (0..=255).collect();
        assert!(describe(&bytes).nodes().any(|(_, node)| node.params.iter().next().is_some()));
    }
}
