//! The reader of pbrt-v4 scenes.
//!
//! pbrt's camera space is left-handed; the world's numbers are taken as they are and the camera is mirrored, so that
//! images come out the same. What Aureole cannot do yet is a warning that names it.
//!
//! Reference: the pbrt-v4 input file format, <https://pbrt.org/fileformat-v4>.

mod cameras;
mod color;
mod curve;
mod directives;
mod flags;
mod lexer;
mod lights;
mod materials;
mod objects;
mod options;
mod params;
mod quads;
mod shapes;
mod state;
mod textures;
mod version3;

#[cfg(test)]
mod tests;

use aureole_desc::{SceneDesc, SceneError, Span};

use crate::format::Format;
use crate::{Context, Input, file};
use state::Reader;

/// The format's entry in the list.
pub(crate) const FORMAT: Format = Format {
    name: "pbrt",
    summary: "pbrt-v4 scenes",
    suffixes: &["pbrt"],
    sniff: |start| {
        let text = String::from_utf8_lossy(start);
        ["WorldBegin", "LookAt", "Integrator", "Camera"].iter().any(|word| text.contains(word))
            && !text.contains('<')
    },
    read,
};

fn read(input: Input<'_>, context: &mut Context<'_>) -> Result<SceneDesc, SceneError> {
    let (source, text) = match input.text {
        Some(text) => (context.sources.add_text(input.path, text), text.into()),
        None => file::read_text(input.path, &context.options.limits, context.sources, Span::NONE)?,
    };
    let mut reader = Reader::new(context, input.path);
    reader.open_files.push(input.path.to_owned());
    let before = reader.context.report.errors.len();
    reader.run(&text, source)?;
    if reader.context.report.errors.len() > before {
        return Err(reader.context.report.errors.remove(before));
    }
    reader.finish(source)
}
