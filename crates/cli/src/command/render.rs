//! `aureole render`: from a scene file to an image.

use std::ops::Range;
use std::path::PathBuf;

use aureole::image::{Image, ToneMapping, WriteOptions};
use aureole::render::{Film, RenderOptions, RenderStats, resume};
use serde::Serialize;
use serde_json::json;

use super::debug_pixel;
use crate::args::{Color, RenderArgs, StatsFormat};
use crate::checkpoint::{Checkpoint, Identity};
use crate::claim::Claim;
use crate::diagnostics::Painter;
use crate::exit::{self, Exit, Failure};
use crate::memory;
use crate::output::{Output, is_same_file, print};
use crate::progress::{Show, Watch, duration, print_line, quantity};
use crate::session::{self, Session};
use crate::signals::Signals;

/// Figures of a render, as `--stats json` prints them.
#[derive(Debug, Serialize)]
struct Stats {
    load_seconds: f64,
    build_seconds: f64,
    render_seconds: f64,
    samples: u64,
    rays: u64,
    /// Where the system tells.
    peak_memory_bytes: Option<u64>,
    non_finite: u64,
    /// Whether all samples that were asked for were drawn.
    complete: bool,
    file: String,
}

/// Runs the command.
pub(crate) fn run(args: &RenderArgs, painter: &Painter) -> Result<Exit, Failure> {
    let signals = Signals::listen();
    let Checked { output, claim: _claim } = check(args)?;
    limit_threads(args.threads);
    let mut options = render_options(args);
    let films_of = (args.checkpoint.is_some() || is_part(args)).then_some(&options);
    let session = session::open_for_films(&args.scene, films_of, args.loudness, painter)?;
    if let Some(pixel) = args.debug_pixel {
        return debug_pixel::run(&session, &options, pixel);
    }
    let (samples, spp) = samples(args, &options, &session)?;
    let output = match output {
        Some(output) => output,
        None => default_output(&session, is_part(args).then_some(&samples))?,
    };
    check_apart(args, &output)?;
    if args.loudness.verbose > 0 && !args.json {
        describe(&session);
    }
    let identity = session.fingerprint.clone().map(|fingerprint| Identity {
        fingerprint,
        samples: samples.clone(),
        spp,
    });
    let checkpoint = args.checkpoint.clone().zip(identity.clone());
    let checkpoint = checkpoint.map(|(path, identity)| Checkpoint::new(path, args.every, identity));
    let film = begin(args, &session, samples.start, checkpoint.as_ref())?;
    options.samples = Some(samples);

    let show = match (args.json, args.loudness.quiet) {
        (true, _) => Show::Lines,
        (false, true) => Show::Nothing,
        (false, false) => Show::Bar,
    };
    signals.be_patient();
    let watch = Watch::new(signals.clone(), show, args.time, checkpoint.as_ref(), painter);
    let rendered = resume(&session.scene, &options, film, &watch);
    watch.finish();
    let mut rendered = rendered.map_err(|error| {
        painter.error(&error.to_string(), error.help().as_deref());
        Failure::Shown(exit::of_scene_error(&error))
    })?;

    // The image is written even where the checkpoint cannot be, and the failure told afterwards.
    let kept = checkpoint.as_ref().map_or(Ok(()), |checkpoint| checkpoint.write(rendered.film.clone()));
    match (&output, identity) {
        (Output::File(path), Some(identity)) if is_part(args) => identity.write(rendered.film, path)?,
        _ => {
            annotate(&mut rendered.image, args.seed, &rendered.film);
            output.write(&rendered.image, &write_options(args))?;
        }
    }
    kept?;
    tell(args, painter, &session, &rendered.stats, &output)?;
    Ok(signals.received().unwrap_or(Exit::Done))
}

/// Whether a part of the samples is rendered, to a film instead of an image.
fn is_part(args: &RenderArgs) -> bool {
    args.shard.is_some() || args.samples.is_some()
}

/// The samples to draw of every pixel, and the number of those of the whole.
fn samples(
    args: &RenderArgs,
    options: &RenderOptions,
    session: &Session,
) -> Result<(Range<u32>, u32), Failure> {
    let whole = options.samples(&session.scene);
    let spp = whole.end;
    let samples = match (args.shard, &args.samples) {
        (Some(shard), _) => shard.of(spp),
        (None, Some(samples)) => samples.clone(),
        (None, None) => whole,
    };
    if samples.is_empty() || samples.end > spp {
        let message = match args.shard {
            Some(shard) => format!("{spp} samples a pixel cannot be shared by {} parts", shard.count),
            None => format!("samples {}..{} are beyond {spp}", samples.start, samples.end),
        };
        return Err(Failure::usage(message).with_help("`--spp` is the number of samples of the whole"));
    }
    Ok((samples, spp))
}

/// The film to begin with: the checkpoint's, or an empty one.
fn begin(
    args: &RenderArgs,
    session: &Session,
    first: u32,
    checkpoint: Option<&Checkpoint>,
) -> Result<Film, Failure> {
    let shape = session.scene.film;
    let Some(checkpoint) = checkpoint.filter(|_| args.resume) else { return Ok(Film::new(shape, first)) };
    let film = checkpoint.film(shape)?;
    let path = checkpoint.path().display();
    let least = film.as_ref().map_or(0, |film| film.drawn()[0]);
    if args.json {
        let file = path.to_string();
        print_line(&json!({ "event": "resumed", "file": file, "samples_per_pixel": least }));
    } else if !args.loudness.quiet {
        eprint(&match &film {
            Some(_) => format!("going on from `{path}`, at {least} samples a pixel\n"),
            None => format!("`{path}` does not exist yet: starting anew\n"),
        });
    }
    Ok(film.unwrap_or_else(|| Film::new(shape, first)))
}

/// What is known before any work is done.
struct Checked {
    /// Without `-o`, the output is known only later.
    output: Option<Output>,
    /// The claim on the checkpoint.
    claim: Option<Claim>,
}

/// Finds what is wrong with the command line before any work is done.
fn check(args: &RenderArgs) -> Result<Checked, Failure> {
    if args.color == Color::Spectral {
        return Err(Failure::usage("spectral rendering comes with a later version")
            .with_help("`--color rgb` is what there is"));
    }
    let output = args.output.as_deref().map(|path| Output::new(path, args.format)).transpose()?;
    if args.stats.is_some() && matches!(output, Some(Output::Stdout(_))) {
        return Err(Failure::usage("`--stats` and `-o -` both want standard output"));
    }
    if output.is_none() && args.format.is_some() {
        return Err(Failure::usage("`--format` is for `-o -`"));
    }
    output.iter().try_for_each(Output::check)?;
    if is_part(args) {
        check_part(args, output.as_ref())?;
    }
    let Some(path) = &args.checkpoint else { return Ok(Checked { output, claim: None }) };
    output.iter().try_for_each(|output| check_apart(args, output))?;
    let claim = Some(Checkpoint::check(path, args.resume)?);
    Ok(Checked { output, claim })
}

/// An image must not replace the checkpoint; a part may, being a film too.
fn check_apart(args: &RenderArgs, output: &Output) -> Result<(), Failure> {
    match (output, &args.checkpoint) {
        (Output::File(image), Some(checkpoint)) if !is_part(args) && is_same_file(image, checkpoint) => {
            Err(Failure::usage("the image would replace the checkpoint")
                .with_help("name different files with `-o` and `--checkpoint`"))
        }
        _ => Ok(()),
    }
}

/// A part's film needs a format that keeps it, and says how many samples there are.
fn check_part(args: &RenderArgs, output: Option<&Output>) -> Result<(), Failure> {
    let is_exr = |path: &PathBuf| path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("exr"));
    if !output.is_none_or(|output| matches!(output, Output::File(path) if is_exr(path))) {
        return Err(Failure::usage("a part of a render is kept in a film: name an `.exr` file with `-o`"));
    }
    if args.time.is_some() {
        return Err(Failure::usage("parts of a render are made of samples, not of time"));
    }
    Ok(())
}

/// The file that the scene names, else one named after the scene.
fn default_output(session: &Session, part: Option<&Range<u32>>) -> Result<Output, Failure> {
    let path = match part {
        Some(samples) => PathBuf::from(format!("{}.{}-{}.exr", session.stem, samples.start, samples.end)),
        None => session.film_filename().unwrap_or_else(|| PathBuf::from(format!("{}.png", session.stem))),
    };
    let output = Output::File(path);
    output.check().map_err(|failure| failure.with_help("name another file with `-o`"))?;
    Ok(output)
}

/// Lets everything that works in parallel outside the render keep to the same number of threads.
fn limit_threads(threads: usize) {
    // It fails only if the pool exists already, and then it is of no consequence.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
}

fn render_options(args: &RenderArgs) -> RenderOptions {
    // With a time alone, time is what ends the render.
    let spp = args.spp.or(args.time.map(|_| u32::MAX));
    RenderOptions {
        spp,
        time: args.time,
        samples: None,
        seed: args.seed,
        threads: args.threads,
        tile: args.tile,
        integrator: args.integrator.clone(),
    }
}

fn write_options(args: &RenderArgs) -> WriteOptions {
    let tone = ToneMapping { exposure: args.exposure, curve: args.tone.into(), ..ToneMapping::default() };
    WriteOptions { tone, ..WriteOptions::default() }
}

/// Notes in the image what made it; nothing that differs from run to run.
pub(super) fn annotate(image: &mut Image, seed: impl ToString, film: &Film) {
    let pixels = (image.width() * image.height()).max(1) as u64;
    let metadata = &mut image.metadata;
    metadata.insert("software".into(), concat!("Aureole ", env!("CARGO_PKG_VERSION")).into());
    metadata.insert("seed".into(), seed.to_string().into());
    metadata.insert("samplesPerPixel".into(), ((film.samples() / pixels) as i32).into());
}

/// With `-v`: what was read and how long it took.
fn describe(session: &Session) {
    let counts = session.scene.counts();
    eprint(&format!(
        "read in {}, built in {}: {}primitives in {} shapes and {} instances, {} lights\n",
        duration(session.load_seconds),
        duration(session.build_seconds),
        quantity(counts.primitives as f64),
        counts.shapes,
        counts.instances,
        counts.lights,
    ));
}

/// The last line, or the figures.
fn tell(
    args: &RenderArgs,
    painter: &Painter,
    session: &Session,
    stats: &RenderStats,
    output: &Output,
) -> Result<(), Failure> {
    if stats.non_finite > 0 && !args.loudness.quiet {
        let (which, help) = match stats.first_non_finite {
            Some(id) => debug_pixel::explain(session, &render_options(args), id),
            None => Default::default(),
        };
        let count = stats.non_finite;
        painter.warning(&format!("{count} samples were not finite and are left out; {which}"), Some(&help));
    }
    let figures = Stats {
        load_seconds: session.load_seconds,
        build_seconds: session.build_seconds,
        render_seconds: stats.seconds,
        samples: stats.samples,
        rays: stats.rays,
        peak_memory_bytes: memory::peak(),
        non_finite: stats.non_finite,
        complete: stats.complete,
        file: output.to_string(),
    };
    if args.json {
        print_line(&json!({ "event": "done", "stats": figures }));
    }
    match args.stats {
        Some(StatsFormat::Json) => print(super::json_line(&figures)?),
        None if args.json => Ok(()),
        None if args.loudness.quiet => Ok(()),
        None => {
            let state = if stats.complete || args.time.is_some() { "" } else { " (interrupted)" };
            eprint(&format!(
                "{}  {}samples  {}rays/s  {output}{state}\n",
                duration(stats.seconds),
                quantity(stats.samples as f64),
                quantity(stats.rays as f64 / stats.seconds.max(1e-9)),
            ));
            Ok(())
        }
    }
}

fn eprint(text: &str) {
    // Nobody is left to tell when standard error is closed.
    let _ = std::io::Write::write_all(&mut std::io::stderr(), text.as_bytes());
}
