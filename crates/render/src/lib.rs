//! Integrators, film, passes, progress.
//!
//! ```
//! use aureole_desc::{Report, SceneDesc};
//! use aureole_render::{RenderOptions, Silent, render};
//! use aureole_scene::{CompileOptions, compile};
//!
//! let mut desc = SceneDesc::default();
//! desc.set("film.width", "8")?;
//! desc.set("film.height", "8")?;
//! let scene = compile(&desc, &CompileOptions::default(), &mut Report::default())?;
//! let rendered = render(&scene, &RenderOptions { spp: Some(1), ..RenderOptions::default() }, &Silent)?;
//! assert_eq!(rendered.image.width(), 8);
//! # Ok::<(), aureole_desc::SceneError>(())
//! ```

#![forbid(unsafe_code)]

mod exact_sum;
mod film;
mod film_file;
mod fingerprint;
pub mod integrator;
mod memory;
mod merge;
mod render;
pub mod replay;
mod splat;

pub use exact_sum::ExactSum;
pub use film::Film;
pub use film_file::{FilmError, FilmFile};
pub use fingerprint::Fingerprint;
pub use integrator::{Integrator, IntegratorManual, integrators};
pub use memory::MemoryEstimate;
pub use merge::{MergeError, Merger, Overlap};
pub use render::{
    Observer, Progress, RenderOptions, RenderStats, Rendered, SampleId, Silent, render, resume,
};
