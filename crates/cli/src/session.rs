//! From a command line's scene to a [`Scene`]: reading, changing, compiling, and telling what was wrong on the way.

use std::path::{Path, PathBuf};
use std::time::Instant;

use aureole::desc::{Limits, Report, SceneDesc, SceneError, Sources, Span, Value};
use aureole::formats::{GALLERY, GalleryScene, LoadOptions, load};
use aureole::render::{Fingerprint, MemoryEstimate, RenderOptions};
use aureole::scene::{CompileOptions, Film, Scene, compile};
use miette::Severity;

use crate::args::{LimitArgs, Loudness, SceneArgs};
use crate::diagnostics::Painter;
use crate::exit::{self, Exit, Failure};
use crate::memory;
use crate::progress::quantity;
use crate::window;

/// Scenes that come with the program are named like this.
pub(crate) const GALLERY_PREFIX: &str = "gallery:";

/// A scene, ready to render, and what is known about where it came from.
pub(crate) struct Session {
    /// What its files say.
    pub desc: SceneDesc,
    /// What rays meet.
    pub scene: Scene,
    /// Warnings on the way.
    pub report: Report,
    /// The files, for places in messages.
    pub sources: Sources,
    /// The memory that it was expected to take, with its render.
    pub estimate: MemoryEstimate,
    /// What tells its films from others, if that was asked for.
    pub fingerprint: Option<Fingerprint>,
    /// Seconds spent on reading.
    pub load_seconds: f64,
    /// Seconds spent on building.
    pub build_seconds: f64,
    /// A name for its image, without a suffix.
    pub stem: String,
}

/// Where a scene is.
enum Origin {
    File(PathBuf),
    Gallery(&'static GalleryScene),
}

impl Origin {
    fn new(scene: Option<&Path>) -> Result<Self, SceneError> {
        let Some(path) = scene else { return Ok(Self::Gallery(&GALLERY[0])) };
        match path.to_str().and_then(|name| name.strip_prefix(GALLERY_PREFIX)) {
            Some(name) => GalleryScene::find(name).map(Self::Gallery),
            None => Ok(Self::File(path.to_owned())),
        }
    }

    fn stem(&self) -> String {
        match self {
            Self::Gallery(scene) => scene.name.to_owned(),
            Self::File(path) => {
                // `scene.pbrt.gz` is `scene`.
                let unpacked = if path.extension().is_some_and(|suffix| suffix == "gz") {
                    path.with_extension("")
                } else {
                    path.clone()
                };
                unpacked.file_stem().map_or("image".into(), |stem| stem.to_string_lossy().into_owned())
            }
        }
    }

    fn load(
        &self,
        options: &LoadOptions,
        sources: &mut Sources,
        report: &mut Report,
    ) -> Result<SceneDesc, SceneError> {
        match self {
            Self::File(path) => load(path, options, sources, report),
            Self::Gallery(scene) => scene.load(options, sources, report),
        }
    }
}

/// An error of a scene, or of the words on the command line that change it.
struct Problem {
    error: SceneError,
    exit: Exit,
}

impl Problem {
    fn usage(error: SceneError) -> Self {
        Self { error, exit: Exit::Usage }
    }
}

impl From<SceneError> for Problem {
    fn from(error: SceneError) -> Self {
        Self { exit: exit::of_scene_error(&error), error }
    }
}

/// Reads and compiles a scene. Errors and warnings are shown here, with their places.
///
/// # Errors
/// [`Failure::Shown`] with the exit code; also for warnings, if they count as errors.
pub(crate) fn open(args: &SceneArgs, loudness: Loudness, painter: &Painter) -> Result<Session, Failure> {
    open_for_films(args, None, loudness, painter)
}

/// As [`open`], and takes the fingerprint of what will be rendered with some options.
pub(crate) fn open_for_films(
    args: &SceneArgs,
    films_of: Option<&RenderOptions>,
    loudness: Loudness,
    painter: &Painter,
) -> Result<Session, Failure> {
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let session = read_and_compile(args, films_of, &mut sources, &mut report);
    let show_all = loudness.verbose > 0;
    let is_strict = args.strict && !report.warnings.is_empty();
    if is_strict || !loudness.quiet {
        let severity = if is_strict { Severity::Error } else { Severity::Warning };
        painter.warnings(&report, severity, &sources, show_all);
    }
    match session {
        Err(Problem { error, exit }) => {
            painter.scene_errors(std::iter::once(&error).chain(&report.errors), &sources, show_all);
            Err(Failure::Shown(exit))
        }
        Ok(_) if !report.errors.is_empty() => {
            painter.scene_errors(&report.errors, &sources, show_all);
            Err(Failure::Shown(exit::of_scene_error(&report.errors[0])))
        }
        Ok(_) if is_strict => {
            painter.error("warnings are errors with `--strict`", None);
            Err(Failure::Shown(Exit::Scene))
        }
        Ok(session) => Ok(Session { report, sources, ..session }),
    }
}

fn read_and_compile(
    args: &SceneArgs,
    films_of: Option<&RenderOptions>,
    sources: &mut Sources,
    report: &mut Report,
) -> Result<Session, Problem> {
    let limits = limits(&args.limits);
    let origin = Origin::new(args.scene.as_deref()).map_err(Problem::usage)?;
    let options = LoadOptions { defines: args.define.clone(), limits, ..LoadOptions::default() };

    let start = Instant::now();
    let mut desc = origin.load(&options, sources, report)?;
    for (path, value) in &args.set {
        desc.set(path, value).map_err(Problem::usage)?;
    }
    window::apply(args, &mut desc).map_err(Problem::usage)?;
    let load_seconds = start.elapsed().as_secs_f64();

    let film = Film::of(&desc, &limits)?;
    let estimate = MemoryEstimate::new(&desc, film.crop.width, film.crop.height, &limits);
    check_memory(&estimate, args.limits.memory_limit)?;

    let start = Instant::now();
    let options = CompileOptions { camera: args.camera, limits, ..CompileOptions::default() };
    let scene = compile(&desc, &options, report)?;
    let integrator = films_of.and_then(|options| options.integrator.as_deref());
    aureole::render::integrator::check(&scene, integrator, report)?;
    let fingerprint = films_of.map(|options| Fingerprint::new(&desc, &film, args.camera, options));
    desc.release_bulk();
    let build_seconds = start.elapsed().as_secs_f64();
    tracing::info!(load_seconds, build_seconds, "scene ready");
    // The caller's come in their places.
    let (report, sources) = (Report::default(), Sources::default());
    let stem = origin.stem();
    Ok(Session { desc, scene, report, sources, estimate, fingerprint, load_seconds, build_seconds, stem })
}

/// Refuses what would be killed later.
fn check_memory(estimate: &MemoryEstimate, limit: Option<u64>) -> Result<(), Problem> {
    let needed = estimate.peak();
    let Some(allowed) = limit.or_else(memory::available) else { return Ok(()) };
    if needed <= allowed {
        return Ok(());
    }
    let why = if limit.is_some() { "`--memory-limit` allows" } else { "there are only" };
    let message = format!(
        "this render needs about {}B of memory ({}B of them for the scene, {}B for the image), {why} {}B",
        quantity(needed as f64),
        quantity((estimate.shapes + estimate.acceleration + estimate.textures) as f64),
        quantity(estimate.film as f64),
        quantity(allowed as f64),
    );
    Err(Problem { error: SceneError::invalid(message, Span::NONE), exit: Exit::Limit })
}

fn limits(args: &LimitArgs) -> Limits {
    let default = Limits::default();
    Limits {
        max_pixels: args.max_pixels.unwrap_or(default.max_pixels),
        max_file_bytes: args.max_file_bytes.unwrap_or(default.max_file_bytes),
        max_mesh_elements: args.max_mesh_elements.unwrap_or(default.max_mesh_elements),
        max_include_depth: args.max_include_depth.unwrap_or(default.max_include_depth),
        max_files: args.max_files.unwrap_or(default.max_files),
        max_nesting: args.max_nesting.unwrap_or(default.max_nesting),
        max_params: args.max_params.unwrap_or(default.max_params),
        max_evaluations: args.max_evaluations.unwrap_or(default.max_evaluations),
        max_unpack_ratio: args.max_unpack_ratio.unwrap_or(default.max_unpack_ratio),
    }
}

impl Session {
    /// The file that the scene itself names for its image.
    pub(crate) fn film_filename(&self) -> Option<PathBuf> {
        let film = self.desc.film.map(|id| &self.desc[id])?;
        match film.params.get("filename")? {
            Value::String(name) if !name.is_empty() => Some(name.into()),
            Value::Path(path) => Some(path.clone()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_named_after_scenes() {
        let stem = |name: &str| Origin::new(Some(name.as_ref())).unwrap().stem();
        assert_eq!(stem("a/b/cbox.xml"), "cbox");
        assert_eq!(stem("scene.pbrt.gz"), "scene");
        assert_eq!(stem("gallery:glass"), "glass");
        assert_eq!(Origin::new(None).unwrap().stem(), "cornell-box");
    }
}
