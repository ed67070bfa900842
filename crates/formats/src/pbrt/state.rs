//! What a pbrt file builds up: the graphics state, named things, and the description.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use aureole_desc::{Family, Limits, Node, NodeId, Params, SceneDesc, SceneError, Span, Value};
use aureole_math::Transform;
use rustc_hash::FxHashMap;

use super::color::ColorSpace;
use super::params::{ParamSet, PbrtParam};
use crate::Context;
use crate::file::SearchPath;

/// What directives change and `AttributeEnd` restores.
#[derive(Clone)]
pub(super) struct GraphicsState {
    /// Transforms at the start and the end of the shutter.
    pub ctm: [Transform; 2],
    /// Which of the two transforms directives change.
    pub active: [bool; 2],
    pub reverse_orientation: bool,
    pub color_space: ColorSpace,
    pub material: Option<NodeId>,
    pub area_light: Option<ParamSet>,
    /// Defaults that `Attribute` sets, by what they are for. They are shared by states until one changes them.
    pub defaults: Rc<FxHashMap<String, Vec<PbrtParam>>>,
}

/// What `AttributeBegin` and `ObjectBegin` leave to be ended.
pub(super) enum Saved {
    Attributes(Box<GraphicsState>),
    Object(Box<GraphicsState>),
}

/// What textures give. Both have names of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum TextureType {
    Float,
    Spectrum,
}

/// An object being defined: its name, and its shapes so far.
pub(super) struct OpenObject {
    pub name: String,
    pub shapes: Vec<NodeId>,
    pub span: Span,
}

/// The reader's whole state.
pub(super) struct Reader<'a, 'c> {
    pub context: &'a mut Context<'c>,
    /// Relative names count from the main file's folder.
    search: SearchPath,
    pub desc: SceneDesc,
    pub state: GraphicsState,
    pub saved: Vec<(Saved, Span)>,
    pub coordinate_systems: FxHashMap<String, [Transform; 2]>,
    pub textures: FxHashMap<String, [Option<NodeId>; 2]>,
    pub materials: FxHashMap<String, NodeId>,
    pub objects: FxHashMap<String, NodeId>,
    pub open_object: Option<OpenObject>,
    /// Files on the way down to the current one.
    pub open_files: Vec<PathBuf>,
    pub in_world: bool,
    /// The times between which transforms move.
    pub transform_times: [f64; 2],
    /// Whether something moves.
    pub has_motion: bool,
    /// Options given before the film's size is known are built at the end.
    pub film: Option<ParamSet>,
    pub flags: Flags,
    pub camera: Option<PendingCamera>,
    /// Whether something showed that the scene is of pbrt version 3.
    pub is_version3: bool,
}

/// What `Option` sets and the picture depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flags {
    /// Factor on the edge length of displaced meshes.
    pub edge_scale: f64,
    /// Pictures are read at their full size only.
    pub no_texture_filter: bool,
    /// Every surface is matte.
    pub force_diffuse: bool,
    /// Samples lie in the middle of their pixels.
    pub no_pixel_jitter: bool,
}

impl Default for Flags {
    fn default() -> Self {
        Self { edge_scale: 1.0, no_texture_filter: false, force_diffuse: false, no_pixel_jitter: false }
    }
}

/// A camera waits for the film, which decides its screen.
pub(super) struct PendingCamera {
    pub kind: String,
    pub params: ParamSet,
    /// At the first and the last of the transform times.
    pub world_from_camera: [Transform; 2],
}

impl<'a, 'c> Reader<'a, 'c> {
    pub(super) fn new(context: &'a mut Context<'c>, main: &Path) -> Self {
        Self {
            context,
            search: SearchPath::beside(main),
            desc: SceneDesc::default(),
            state: GraphicsState {
                ctm: [Transform::IDENTITY; 2],
                active: [true; 2],
                reverse_orientation: false,
                color_space: ColorSpace::default(),
                material: None,
                area_light: None,
                defaults: Rc::default(),
            },
            saved: Vec::new(),
            coordinate_systems: FxHashMap::default(),
            textures: FxHashMap::default(),
            materials: FxHashMap::default(),
            objects: FxHashMap::default(),
            open_object: None,
            open_files: Vec::new(),
            in_world: false,
            transform_times: [0.0, 1.0],
            has_motion: false,
            film: None,
            flags: Flags::default(),
            camera: None,
            is_version3: false,
        }
    }

    pub(super) fn limits(&self) -> &Limits {
        &self.context.options.limits
    }

    pub(super) fn warn(&mut self, message: impl Into<String>, at: Span) {
        self.context.report.warn(message, at);
    }

    /// A file by the name that the scene gives it.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.search.resolve(name)
    }

    /// Adds a node.
    pub(super) fn add(&mut self, family: Family, kind: &str, params: Params, at: Span) -> NodeId {
        self.desc.add(Node::new(family, kind, params, at))
    }

    /// A texture by name; where there is none of the wanted type, one of the other.
    pub(super) fn texture(&self, name: &str, ty: TextureType, at: Span) -> Result<Value, SceneError> {
        let found = self.textures.get(name).and_then(|of| of[ty as usize].or(of[1 - ty as usize]));
        found.map(Value::Node).ok_or_else(|| unknown("texture", name, self.textures.keys(), at))
    }

    /// The current transform, of what does not move.
    pub(super) fn ctm(&mut self, at: Span) -> Result<Transform, SceneError> {
        let [start, end] = self.moving_ctm(at)?;
        if start != end {
            self.warn("only shapes, objects and cameras move: this stays where it is at first", at);
        }
        Ok(start)
    }

    /// The current transforms at the first and the last of the transform times.
    pub(super) fn moving_ctm(&self, at: Span) -> Result<[Transform; 2], SceneError> {
        if self.state.ctm.iter().all(Transform::is_invertible) {
            Ok(self.state.ctm)
        } else {
            Err(SceneError::invalid("the current transform cannot be inverted", at))
        }
    }

    /// Multiplies the active transforms.
    pub(super) fn concat(&mut self, transform: Transform) {
        for (ctm, active) in self.state.ctm.iter_mut().zip(self.state.active) {
            if active {
                *ctm = *ctm * transform;
            }
        }
    }

    /// Replaces the active transforms.
    pub(super) fn replace(&mut self, transforms: [Transform; 2]) {
        for (i, transform) in transforms.into_iter().enumerate() {
            if self.state.active[i] {
                self.state.ctm[i] = transform;
            }
        }
    }
}

/// A name that nothing has.
pub(super) fn unknown<'n>(
    what: &'static str,
    name: &str,
    known: impl Iterator<Item = &'n String> + Clone,
    at: Span,
) -> SceneError {
    SceneError::unknown_name(what, name, known.map(String::as_str), at)
}
