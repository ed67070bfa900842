//! Aureole, a physically based ray tracer: the one crate to depend on.
//!
//! Each module is a crate that can also be used alone. Data walks one way through them: a file or a program makes a
//! description ([`desc`], [`formats`]), which is compiled into a [`scene`], which a [`render`] turns into an [`image`].
//!
//! ```
//! use aureole::prelude::*;
//!
//! let (mut sources, mut report) = (Sources::default(), Report::default());
//! let text = r#"<scene version="3.0.0">
//!     <shape type="sphere"/>
//!     <emitter type="constant"/>
//! </scene>"#;
//! let mut desc = load_text("mitsuba", "ball.xml", text, &LoadOptions::default(), &mut sources, &mut report)?;
//! desc.set("film.width", "16")?;
//! desc.set("film.height", "16")?;
//!
//! let scene = compile(&desc, &CompileOptions::default(), &mut report)?;
//! let options = RenderOptions { spp: Some(4), ..RenderOptions::default() };
//! let rendered = render(&scene, &options, &Silent)?;
//! write_image(&rendered.image, &std::env::temp_dir().join("ball.png"), &WriteOptions::default())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub use aureole_accel as accel;
pub use aureole_desc as desc;
pub use aureole_elements as elements;
pub use aureole_formats as formats;
pub use aureole_image as image;
pub use aureole_math as math;
pub use aureole_render as render;
pub use aureole_scene as scene;
pub use aureole_spectrum as spectrum;

/// What nearly every program needs.
pub mod prelude {
    pub use aureole_desc::{
        Family, Node, NodeId, ParamDoc, Params, Report, SceneDesc, SceneError, Sources, Span, Value,
    };
    pub use aureole_formats::{LoadOptions, load, load_text};
    pub use aureole_image::{Image, ToneMapping, WriteOptions, write_image};
    pub use aureole_math::{Point3, Transform, Vector3};
    pub use aureole_render::{RenderOptions, Rendered, Silent, render};
    pub use aureole_scene::{CompileOptions, Scene, compile};
    pub use aureole_spectrum::SpectrumSource;
}
