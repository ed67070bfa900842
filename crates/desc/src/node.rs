//! One element of a description.

use crate::{Params, Span};

/// The kinds of things that a scene is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// Reconstruction filters.
    Filter,
    /// Sample generators.
    Sampler,
    /// Spatially varying values.
    Texture,
    /// Geometry, also groups and instances.
    Shape,
    /// Surface materials.
    Bsdf,
    /// Participating media.
    Medium,
    /// Emitters.
    Light,
    /// Cameras.
    Camera,
    /// The image plane: resolution, crop.
    Film,
    /// Light transport algorithms.
    Integrator,
}

impl Family {
    /// All families, in the order in which they are listed to people.
    pub const ALL: [Self; 10] = [
        Self::Shape,
        Self::Bsdf,
        Self::Texture,
        Self::Light,
        Self::Medium,
        Self::Camera,
        Self::Film,
        Self::Filter,
        Self::Sampler,
        Self::Integrator,
    ];

    /// The word for messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Filter => "filter",
            Self::Sampler => "sampler",
            Self::Texture => "texture",
            Self::Shape => "shape",
            Self::Bsdf => "bsdf",
            Self::Medium => "medium",
            Self::Light => "light",
            Self::Camera => "camera",
            Self::Film => "film",
            Self::Integrator => "integrator",
        }
    }
}

impl std::fmt::Display for Family {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Names a node of a [`SceneDesc`](crate::SceneDesc).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub(crate) u32);

impl NodeId {
    /// The node's position in its description.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// An element to build: what family, what kind, with which parameters, and where that was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The family.
    pub family: Family,
    /// The kind within the family, in Aureole's vocabulary, e.g. `rough_conductor`.
    pub kind: String,
    /// The name or id that the file gives it.
    pub name: Option<String>,
    /// Its parameters.
    pub params: Params,
    /// Where it was written.
    pub span: Span,
}

impl Node {
    /// A node without a name.
    pub fn new(family: Family, kind: impl Into<String>, params: Params, span: Span) -> Self {
        Self { family, kind: kind.into(), name: None, params, span }
    }

    /// The same node with a name.
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }
}
