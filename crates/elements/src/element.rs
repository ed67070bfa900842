//! The door through which descriptions become elements.

use std::path::Path;
use std::sync::Arc;

use aureole_desc::{Limits, Node, NodeId, ParamDoc, Params, Report, SceneError, Span, Textured};
use aureole_image::{Bitmap, Encoding};
use aureole_math::{Arena, Id};
use aureole_spectrum::{SpectrumRole, SpectrumSource};

use crate::{Camera, Material, Shape, Texture};

/// An element of some family: its manual, and how it is built.
pub trait Element: Sized {
    /// What it models, in one sentence.
    const SUMMARY: &'static str;
    /// The parameters that [`from_params`](Self::from_params) asks for.
    const PARAMS: &'static [ParamDoc];

    /// Builds the element.
    ///
    /// # Errors
    /// A parameter that is missing, of the wrong type or out of range, with its place in the scene file.
    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError>;
}

/// An element's manual, as `aureole list` prints it.
#[derive(Clone, Copy, Debug)]
pub struct Manual {
    /// The kind's name in scene files.
    pub kind: &'static str,
    /// What it models.
    pub summary: &'static str,
    /// Its parameters.
    pub params: &'static [ParamDoc],
}

impl Manual {
    pub(crate) fn of<E: Element>(kind: &'static str) -> Self {
        Self { kind, summary: E::SUMMARY, params: E::PARAMS }
    }
}

/// The image plane, which cameras need to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSpec {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl FilmSpec {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height as f32
    }
}

/// Turns names of other elements into ids, and files into pixels. Nothing else of a scene is visible to an element.
pub trait Resolver {
    /// The texture that a node describes, built once.
    ///
    /// # Errors
    /// Whatever is wrong with that node.
    fn texture(&mut self, node: NodeId) -> Result<Id<Texture>, SceneError>;

    /// A texture that is constant.
    fn constant(&mut self, spectrum: &SpectrumSource, role: SpectrumRole) -> Id<Texture>;

    /// The material that a node describes, built once.
    ///
    /// # Errors
    /// Whatever is wrong with that node.
    fn material(&mut self, node: NodeId) -> Result<Id<Material>, SceneError>;

    /// The pixels of an image file, read once. A file that cannot be read gives a placeholder and a warning.
    ///
    /// # Errors
    /// Only when a placeholder would make no sense.
    fn bitmap(&mut self, path: &Path, encoding: Encoding, at: Span) -> Result<Arc<Bitmap>, SceneError>;

    /// The image plane.
    fn film(&self) -> FilmSpec;

    /// The shape that an area light sits on.
    fn emitting_shape(&self) -> Option<Id<Shape>>;

    /// The camera that a node describes, for a film of its own.
    ///
    /// # Errors
    /// Whatever is wrong with that node.
    fn camera(&mut self, node: NodeId, film: FilmSpec) -> Result<Camera, SceneError>;

    /// The shape that a camera sits on.
    fn measured_shape(&self) -> Option<Shape>;

    /// Where warnings go.
    fn report(&mut self) -> &mut Report;

    /// What a scene may ask for.
    fn limits(&self) -> &Limits;

    /// The textures that are built so far, for shapes that are moved by one.
    fn textures(&self) -> &Arena<Texture>;
}

/// Builds an element and warns about parameters that it did not ask for.
pub(crate) fn build<E: Element>(node: &Node, resolver: &mut dyn Resolver) -> Result<E, SceneError> {
    let mut params = node.params.clone();
    let element = E::from_params(&mut params, resolver).map_err(|error| with_place(error, node.span))?;
    params.warn_unused(&format!("{} `{}`", node.family, node.kind), E::PARAMS, resolver.report());
    Ok(element)
}

/// An error without a place of its own is at its element.
fn with_place(error: SceneError, place: Span) -> SceneError {
    match error {
        SceneError::Invalid { message, at } if at.is_none() => SceneError::Invalid { message, at: place },
        SceneError::MissingParam { element, param, wanted, at } if at.is_none() => {
            SceneError::MissingParam { element, param, wanted, at: place }
        }
        other => other,
    }
}

/// A parameter that is a texture, a spectrum or a number, as a texture.
///
/// # Errors
/// [`SceneError::BadParam`], or whatever is wrong with the texture.
pub fn spectrum_texture(
    params: &mut Params,
    resolver: &mut dyn Resolver,
    name: &str,
    default: f32,
    role: SpectrumRole,
) -> Result<Id<Texture>, SceneError> {
    match params.try_textured(name)? {
        Some(Textured::Node(node)) => resolver.texture(node),
        Some(Textured::Constant(spectrum)) => Ok(resolver.constant(&spectrum, role)),
        None => Ok(resolver.constant(&SpectrumSource::Uniform(default), role)),
    }
}

/// A parameter that is a texture or a number, as a texture of numbers.
///
/// # Errors
/// [`SceneError::BadParam`], or whatever is wrong with the texture.
pub fn float_texture(
    params: &mut Params,
    resolver: &mut dyn Resolver,
    name: &str,
    default: f32,
) -> Result<Id<Texture>, SceneError> {
    spectrum_texture(params, resolver, name, default, SpectrumRole::Unbounded)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A resolver for elements that need nothing resolved.
    #[derive(Default)]
    pub(crate) struct NoResolver {
        report: Report,
        limits: Limits,
        textures: Arena<Texture>,
    }

    impl Resolver for NoResolver {
        fn texture(&mut self, _: NodeId) -> Result<Id<Texture>, SceneError> {
            Err(SceneError::invalid("no textures here", Span::NONE))
        }
        fn constant(&mut self, _: &SpectrumSource, _: SpectrumRole) -> Id<Texture> {
            Id::new(0)
        }
        fn material(&mut self, _: NodeId) -> Result<Id<Material>, SceneError> {
            Err(SceneError::invalid("no materials here", Span::NONE))
        }
        fn bitmap(&mut self, _: &Path, _: Encoding, _: Span) -> Result<Arc<Bitmap>, SceneError> {
            Ok(Arc::new(Bitmap::placeholder([1.0; 3])))
        }
        fn film(&self) -> FilmSpec {
            FilmSpec { width: 256, height: 256 }
        }
        fn emitting_shape(&self) -> Option<Id<Shape>> {
            None
        }
        fn camera(&mut self, _: NodeId, _: FilmSpec) -> Result<Camera, SceneError> {
            Err(SceneError::invalid("no cameras here", Span::NONE))
        }
        fn measured_shape(&self) -> Option<Shape> {
            None
        }
        fn report(&mut self) -> &mut Report {
            &mut self.report
        }
        fn limits(&self) -> &Limits {
            &self.limits
        }
        fn textures(&self) -> &Arena<Texture> {
            &self.textures
        }
    }
}
