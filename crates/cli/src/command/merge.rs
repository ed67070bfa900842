//! `aureole merge`: from parts of a render to the whole.

use aureole::image::{ToneMapping, WriteOptions};
use aureole::render::Merger;

use super::render::annotate;
use crate::args::MergeArgs;
use crate::checkpoint::read_film;
use crate::exit::{Exit, Failure};
use crate::output::Output;

/// Runs the command.
pub(crate) fn run(args: &MergeArgs) -> Result<Exit, Failure> {
    let output = Output::new(&args.output, None)?;
    output.check()?;
    let mut merger = Merger::default();
    let refused = |error: aureole::render::MergeError| Failure::new(Exit::Scene, error.to_string());
    for path in &args.parts {
        merger.add(read_film(path, None)?, &path.display().to_string()).map_err(refused)?;
    }
    let whole = merger.finish().map_err(refused)?;
    let mut image = whole.film.image();
    annotate(&mut image, whole.fingerprint.get("seed").unwrap_or_default(), &whole.film);
    let tone = ToneMapping { exposure: args.exposure, curve: args.tone.into(), ..ToneMapping::default() };
    output.write(&image, &WriteOptions { tone, ..WriteOptions::default() })?;
    Ok(Exit::Done)
}
