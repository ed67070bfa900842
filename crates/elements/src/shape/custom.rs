//! Kinds of shapes that a program defines itself.

use std::sync::Arc;

use aureole_desc::{Node, SceneError};

use super::{COMMON_PARAMS, Shape, ShapeOps};
use crate::{Element, Manual, Resolver};

/// A kind of shape beside the built-in ones: whatever can be intersected and bounded can be rendered.
#[derive(Clone, Copy, Debug)]
pub struct ShapeKind {
    /// Its name in scenes, what it is, its parameters.
    pub manual: Manual,
    build: fn(&Node, &mut dyn Resolver) -> Result<Shape, SceneError>,
}

impl ShapeKind {
    /// The kind of that name, built from nodes by `S::from_params`.
    pub fn of<S: Element + ShapeOps + 'static>(name: &'static str) -> Self {
        Self { manual: Manual::of::<S>(name), build: build::<S> }
    }

    /// Builds a shape of this kind.
    ///
    /// # Errors
    /// Whatever is wrong with the parameters.
    pub fn build(&self, node: &Node, resolver: &mut dyn Resolver) -> Result<Shape, SceneError> {
        (self.build)(node, resolver)
    }
}

fn build<S: Element + ShapeOps + 'static>(
    node: &Node,
    resolver: &mut dyn Resolver,
) -> Result<Shape, SceneError> {
    let mut node = node.clone();
    for common in COMMON_PARAMS {
        node.params.take(common.name); // read by the scene's compiler, or left to the shape
    }
    Ok(Shape::Custom(Arc::new(crate::element::build::<S>(&node, resolver)?)))
}
