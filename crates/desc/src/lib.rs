//! The scene description: a generic tree of nodes with spans, known to no element.
//!
//! Readers (`aureole-formats`) produce a [`SceneDesc`]; elements take their parameters from it through the narrow
//! door of [`Params`]. Nothing here knows what a sphere is.
//!
//! ```
//! use aureole_desc::{Family, Node, Params, SceneDesc, Span, Value};
//!
//! let mut scene = SceneDesc::default();
//! let params = Params::new().with("radius", Value::Float(2.0));
//! let sphere = scene.add(Node::new(Family::Shape, "sphere", params, Span::NONE));
//! scene.shapes.push(sphere);
//! assert_eq!(scene[sphere].kind, "sphere");
//! ```

mod error;
mod limits;
mod mesh;
mod node;
mod normals;
mod params;
mod report;
mod scene_desc;
mod span;
mod split;
mod value;

pub use error::{SceneError, suggest};
pub use limits::Limits;
pub use mesh::{Attribute, AttributeDomain, Mesh};
pub use node::{Family, Node, NodeId};
pub use params::{Param, ParamDoc, Params, Textured};
pub use report::{Report, Warning};
pub use scene_desc::{Instance, SceneDesc};
pub use span::{Location, SourceFile, SourceId, Sources, Span};
pub use value::Value;
