//! Readers of scene and mesh files: pbrt-v4, Mitsuba 3, PLY, OBJ, serialized; the embedded gallery.
//!
//! Every reader turns a file in its own dialect into the one vocabulary of a [`SceneDesc`]; what is wrong comes back as a
//! [`SceneError`] with its place, what is merely odd goes into the [`Report`].
//!
//! ```no_run
//! use aureole_desc::{Report, Sources};
//! use aureole_formats::{LoadOptions, load};
//!
//! let (mut sources, mut report) = (Sources::default(), Report::default());
//! let scene = load("cbox.xml".as_ref(), &LoadOptions::default(), &mut sources, &mut report)?;
//! println!("{} shapes", scene.shapes.len());
//! # Ok::<(), aureole_desc::SceneError>(())
//! ```

#![forbid(unsafe_code)]

pub mod brdf;
pub mod file;
mod format;
mod gallery;
pub mod mesh;
mod mitsuba;
mod object;
mod pbrt;
pub mod spectrum_file;

use std::path::Path;

use aureole_desc::{Limits, Report, SceneDesc, SceneError, Sources};
use aureole_spectrum::ColorMode;

pub use format::{Context, FORMATS, Format, Input, known_suffixes};
pub use gallery::{GALLERY, GalleryScene};

/// What a reader may be told.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Values of a scene's own parameters (`-D name=value`); they win over the defaults in the file.
    pub defines: Vec<(String, String)>,
    /// What a file may ask for.
    pub limits: Limits,
    /// How colour will be rendered, for formats that read spectra differently by it.
    pub color: ColorMode,
}

/// Reads a scene or a mesh; the format follows from the suffix, else from the first bytes.
///
/// A mesh on its own gets a camera, a ground and lights.
///
/// # Errors
/// The first thing that makes the scene unusable; further ones are in the report.
pub fn load(
    path: &Path,
    options: &LoadOptions,
    sources: &mut Sources,
    report: &mut Report,
) -> Result<SceneDesc, SceneError> {
    let format = format::of_file(path, &options.limits)?;
    (format.read)(Input { path, text: None }, &mut Context { options, sources, report })
}

/// Reads a scene from text: for tests, programs and the embedded gallery. Relative file names count from `name`'s folder.
///
/// # Errors
/// As [`load`], and for a format without that name.
pub fn load_text(
    format: &str,
    name: &str,
    text: &str,
    options: &LoadOptions,
    sources: &mut Sources,
    report: &mut Report,
) -> Result<SceneDesc, SceneError> {
    let format = format::by_name(format)?;
    let input = Input { path: name.as_ref(), text: Some(text) };
    (format.read)(input, &mut Context { options, sources, report })
}
