//! Compiles a description into a scene: arenas of plain values, two-level acceleration, a light picker, ray queries.
//!
//! ```
//! use aureole_desc::{Family, Node, Params, Report, SceneDesc, Span, Value};
//! use aureole_math::{Point3, Ray, Vector3};
//! use aureole_scene::{CompileOptions, compile};
//!
//! let mut desc = SceneDesc::default();
//! let sphere = desc.add(Node::new(Family::Shape, "sphere", Params::new(), Span::NONE));
//! desc.shapes.push(sphere);
//! let scene = compile(&desc, &CompileOptions::default(), &mut Report::default())?;
//! let ray = Ray::new(Point3::new(0.0, 0.0, 3.0), -Vector3::Z);
//! assert_eq!(scene.closest_hit(&ray).unwrap().t, 2.0);
//! # Ok::<(), aureole_desc::SceneError>(())
//! ```

#![forbid(unsafe_code)]

mod attributes;
mod compile;
mod film;
mod lights;
pub mod manual;
mod origins;
mod resolve;
mod scene;
mod shapes;

pub use compile::{CompileOptions, compile};
pub use film::{Colors, Crop, Film};
pub use lights::{LightChoice, LightPicker};
pub use origins::Origins;
pub use scene::{Counts, Elements, Interaction, Scene, SceneHit};
