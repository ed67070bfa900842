//! `aureole merge`: from parts of a render to the whole.

use aureole::image::{ToneMapping, WriteOptions};
use aureole::render::Merger;
use serde::Serialize;

use super::render::annotate;
use crate::args::MergeArgs;
use crate::checkpoint::read_film;
use crate::diagnostics::Painter;
use crate::exit::{Exit, Failure};
use crate::output::{Output, is_same_file, print};

/// What was put together, as `--json` prints it.
#[derive(Debug, Serialize)]
struct Merged {
    parts: usize,
    width: u32,
    height: u32,
    samples_per_pixel: u32,
    /// Samples that were not finite and are left out.
    non_finite: u64,
    file: String,
}

/// Runs the command. Everything that is wrong with the parts is told, not only the first thing.
pub(crate) fn run(args: &MergeArgs, painter: &Painter) -> Result<Exit, Failure> {
    let output = Output::new(&args.output, None)?;
    output.check()?;
    if let Some(part) = args.parts.iter().find(|part| is_same_file(part, &args.output)) {
        let message = format!("the image would replace the part `{}`", part.display());
        return Err(Failure::usage(message).with_help("name another file with `-o`"));
    }
    if args.json && matches!(output, Output::Stdout(_)) {
        return Err(Failure::usage("`--json` and `-o -` both want standard output"));
    }

    let mut merger = Merger::default();
    let mut refused = None;
    for path in &args.parts {
        let added = read_film(path, None).and_then(|film| {
            let refused = |error: aureole::render::MergeError| Failure::new(Exit::Scene, error.to_string());
            merger.add(film, &path.display().to_string()).map_err(refused)
        });
        if let Err(failure) = added {
            painter.failure(&failure);
            refused.get_or_insert(failure.exit());
        }
    }
    if let Some(exit) = refused {
        return Err(Failure::Shown(exit));
    }
    let whole = merger.finish().map_err(|error| Failure::new(Exit::Scene, error.to_string()))?;

    let mut image = whole.film.image();
    annotate(&mut image, whole.fingerprint.get("seed").unwrap_or_default(), &whole.film);
    let tone = ToneMapping { exposure: args.exposure, curve: args.tone.into(), ..ToneMapping::default() };
    output.write(&image, &WriteOptions { tone, ..WriteOptions::default() })?;
    if args.json {
        let crop = whole.film.shape().crop;
        print(super::json_line(&Merged {
            parts: args.parts.len(),
            width: crop.width,
            height: crop.height,
            samples_per_pixel: whole.spp,
            non_finite: whole.film.dropped(),
            file: output.to_string(),
        })?)?;
    }
    Ok(Exit::Done)
}
