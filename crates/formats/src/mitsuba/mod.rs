//! Mitsuba 3 scenes (XML), and those of version 0.6, in Aureole's vocabulary.
//!
//! Reading has two steps: `xml` turns files into a tree of plugins as written, with includes, parameters and
//! search folders resolved; `translate` and the family files turn plugins into nodes. Mitsuba's own defaults are written
//! out where they differ from Aureole's.
//!
//! # Conventions
//! World and camera space agree with Aureole's. Mitsuba's v = 0 is the top row of a bitmap: every bitmap's `to_uv` gets a
//! flip, and texture coordinates of meshes stay as they are in Mitsuba.
//!
//! # References
//! The plugins' manual at <https://mitsuba.readthedocs.io/en/stable/src/plugin_reference.html>.

mod bsdf;
mod ellipsoids;
mod emitter;
mod film;
mod integrator;
mod medium;
mod scope;
mod sensor;
mod shape;
mod texture;
mod translate;
mod tree;
mod xml;

use aureole_desc::{SceneDesc, SceneError};

use crate::format::{Context, Format, Input};

/// The format.
pub(crate) const FORMAT: Format = Format {
    name: "mitsuba",
    summary: "Mitsuba 3 scenes in XML",
    suffixes: &["xml"],
    sniff: |start| {
        let text = String::from_utf8_lossy(start);
        text.trim_start_matches('\u{feff}').trim_start().starts_with('<') && text.contains("<scene")
    },
    read,
};

fn read(input: Input<'_>, context: &mut Context<'_>) -> Result<SceneDesc, SceneError> {
    let before = context.report.errors.len();
    let parsed = xml::parse(input.path, input.text, context)?;
    if context.report.errors.len() > before {
        Err(context.report.errors.remove(before))
    } else {
        translate::translate(&parsed, context)
    }
}

#[cfg(test)]
mod tests;
