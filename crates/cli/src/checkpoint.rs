//! Films in files: what `--checkpoint` writes now and then, `--resume` goes on with, and parts of a render are.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use aureole::image::{ImageError, ImageLimits, write_atomically};
use aureole::render::{Film, FilmError, FilmFile, Fingerprint};
use aureole::scene;

use crate::claim::Claim;
use crate::exit::{Exit, Failure};

/// Bytes of a pixel in a film file, with some to spare.
const BYTES_PER_PIXEL: u64 = 128;

/// What a render's film files say besides the film.
#[derive(Clone, Debug)]
pub(crate) struct Identity {
    /// The scene, the seed and so on.
    pub fingerprint: Fingerprint,
    /// The samples that are to be drawn.
    pub samples: Range<u32>,
    /// Samples a pixel of the whole, of which these may be a part.
    pub spp: u32,
}

impl Identity {
    /// Writes a film; the file is never half-written, and an older one stays until the new one is whole.
    pub(crate) fn write(&self, film: Film, path: &Path) -> Result<(), Failure> {
        let Self { fingerprint, samples, spp } = self.clone();
        let bytes = FilmFile { film, fingerprint, samples, spp }.encode()?;
        Ok(write_atomically(path, &bytes)?)
    }

    /// A film to go on with, if it is one of this render.
    fn accept(&self, file: FilmFile) -> Result<Film, String> {
        let mut differences = file.fingerprint.differences(&self.fingerprint);
        if file.samples.start != self.samples.start {
            let words = |samples: &Range<u32>| format!("{}..{}", samples.start, samples.end);
            differences.push(format!("samples: {}, here {}", words(&file.samples), words(&self.samples)));
        }
        if !differences.is_empty() {
            return Err(differences.join("; "));
        }
        let [_, most] = file.film.drawn();
        if most > self.samples.len() as u32 {
            let wanted = self.samples.len();
            return Err(format!("samples a pixel: it has {most} already, only {wanted} are asked for"));
        }
        Ok(file.film)
    }
}

/// Reads a film file.
///
/// # Errors
/// [`Exit::Scene`] for anything but a whole film.
pub(crate) fn read_film(path: &Path, shape: Option<scene::Film>) -> Result<FilmFile, Failure> {
    let failed = |message: String| Failure::new(Exit::Scene, format!("`{}`: {message}", path.display()));
    let unreadable = |error: std::io::Error| {
        Failure::new(Exit::Scene, format!("cannot read `{}`: {error}", path.display()))
    };
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(failed("it is not a file".into()));
    }
    let pixels = shape.map_or(0, |shape| u64::from(shape.crop.width) * u64::from(shape.crop.height));
    let default = ImageLimits::default();
    let limits = ImageLimits {
        max_pixels: default.max_pixels.max(pixels),
        max_bytes: default.max_bytes.max(pixels.saturating_mul(BYTES_PER_PIXEL)),
    };
    let bytes = std::fs::read(path).map_err(unreadable)?;
    FilmFile::decode(&bytes, path, &limits).map_err(|error| match error {
        FilmError::Image(error @ ImageError::Decode { .. }) => {
            Failure::new(Exit::Scene, error.to_string().replace("image", "film"))
        }
        FilmError::Image(error) => error.into(),
        other => failed(other.to_string()),
    })
}

fn not_written(path: &Path, why: &str) -> Failure {
    Failure::new(Exit::Io, format!("cannot write `{}`: {why}", path.display()))
}

/// A file that holds what a render has so far.
pub(crate) struct Checkpoint {
    path: PathBuf,
    every: Duration,
    identity: Identity,
    /// When the next one is due; nothing while one is being written.
    due: Mutex<Option<Instant>>,
}

impl Checkpoint {
    /// A checkpoint that is first written after `every`.
    pub(crate) fn new(path: PathBuf, every: Duration, identity: Identity) -> Self {
        Self { path, every, identity, due: Mutex::new(Instant::now().checked_add(every)) }
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Finds out, before the work begins, whether it may be written: what is there must be wanted. Until the claim is
    /// dropped, no other process gets one.
    pub(crate) fn check(path: &Path, is_resumed: bool) -> Result<Claim, Failure> {
        let claim = Claim::new(path)?;
        if path.exists() && !is_resumed {
            let message = format!("the checkpoint `{}` exists already", path.display());
            return Err(Failure::usage(message).with_help("go on with `--resume`, or remove it"));
        }
        match std::fs::metadata(path) {
            Ok(meta) if !meta.is_file() => Err(not_written(path, "it is not a file")),
            Ok(meta) if meta.permissions().readonly() => Err(not_written(path, "it is read-only")),
            _ => Ok(claim),
        }
    }

    /// The film to go on with; `None` where there is no file yet, so that a farm can always say `--resume`.
    pub(crate) fn film(&self, shape: scene::Film) -> Result<Option<Film>, Failure> {
        if !self.path.exists() {
            return Ok(None);
        }
        let file = read_film(&self.path, Some(shape))?;
        let film = self.identity.accept(file).map_err(|differences| {
            let path = self.path.display();
            Failure::new(Exit::Scene, format!("`{path}` is of another render: {differences}"))
                .with_help("render with what it was made of, or name another checkpoint")
        })?;
        Ok(Some(film))
    }

    /// Whether it is time; who hears yes must [`write`](Self::write).
    pub(crate) fn claim(&self) -> bool {
        let Ok(mut due) = self.due.try_lock() else { return false };
        let is_due = due.is_some_and(|due| Instant::now() >= due);
        if is_due {
            *due = None;
        }
        is_due
    }

    /// Writes it. What was there before stays where that fails.
    pub(crate) fn write(&self, film: Film) -> Result<(), Failure> {
        let start = Instant::now();
        let result = self.identity.write(film, &self.path);
        tracing::info!(seconds = start.elapsed().as_secs_f64(), ok = result.is_ok(), "checkpoint");
        *self.due.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now().checked_add(self.every);
        result
    }
}
