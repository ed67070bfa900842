//! Values of parameters.

use std::path::PathBuf;
use std::sync::Arc;

use aureole_math::Transform;
use aureole_spectrum::SpectrumSource;

use crate::{Mesh, NodeId};

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Value {
    /// A switch.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// A word.
    String(String),
    /// A file, already resolved against the scene's folders.
    Path(PathBuf),
    /// A point or vector of the plane.
    Vec2([f64; 2]),
    /// A point, vector or normal of space.
    Vec3([f64; 3]),
    /// A spectrum or colour.
    Spectrum(SpectrumSource),
    /// An affine or projective map.
    Transform(Transform),
    /// Many numbers.
    Floats(Arc<[f32]>),
    /// Many whole numbers.
    Ints(Arc<[i32]>),
    /// Many words.
    Strings(Vec<String>),
    /// A triangle mesh.
    Mesh(Arc<Mesh>),
    /// Another element.
    Node(NodeId),
    /// Several elements.
    Nodes(Vec<NodeId>),
}

impl Value {
    /// The value's type, for messages.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Bool(_) => "a boolean",
            Self::Int(_) => "an integer",
            Self::Float(_) => "a number",
            Self::String(_) => "a string",
            Self::Path(_) => "a file name",
            Self::Vec2(_) => "a pair of numbers",
            Self::Vec3(_) => "three numbers",
            Self::Spectrum(SpectrumSource::Rgb(_)) => "a colour",
            Self::Spectrum(_) => "a spectrum",
            Self::Transform(_) => "a transform",
            Self::Floats(_) => "a list of numbers",
            Self::Ints(_) => "a list of integers",
            Self::Strings(_) => "a list of strings",
            Self::Mesh(_) => "a mesh",
            Self::Node(_) => "an element",
            Self::Nodes(_) => "a list of elements",
        }
    }

    /// Reads a value typed by a person, as `--set` does: `true`, `12`, `0.5`, `0.1,0.2,0.3` (a colour or point), or a word.
    pub fn parse(text: &str) -> Self {
        if let Ok(b) = text.parse() {
            return Self::Bool(b);
        }
        if let Ok(i) = text.parse() {
            return Self::Int(i);
        }
        if let Ok(x) = text.parse() {
            return Self::Float(x);
        }
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x, y]) => Self::Vec2([x, y]),
            Ok(&[x, y, z]) => Self::Vec3([x, y, z]),
            _ => Self::String(text.to_owned()),
        }
    }
}
