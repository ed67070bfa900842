//! `aureole list`: the elements that scenes are made of.

use std::fmt::Write;

use aureole::desc::{Family, ParamDoc, suggest};
use aureole::elements::{Camera, Filter, Light, Manual, Material, Sampler, Shape, Texture, shape};
use aureole::scene::manual;
use serde::Serialize;

use crate::args::ListArgs;
use crate::exit::{Exit, Failure};
use crate::output::print;

/// An element, for people or as JSON.
#[derive(Clone, Copy, Debug, Serialize)]
struct Entry {
    family: &'static str,
    kind: &'static str,
    summary: &'static str,
    #[serde(serialize_with = "params_as_objects")]
    params: &'static [ParamDoc],
}

/// Runs the command.
pub(crate) fn run(args: &ListArgs) -> Result<Exit, Failure> {
    let all = entries();
    let chosen = match &args.family {
        Some(name) => select(&all, name)?,
        None => all,
    };
    if args.json {
        print(super::json_line(&chosen)?)?;
    } else {
        print(text(&chosen, args.family.is_some()))?;
    }
    Ok(Exit::Done)
}

/// Every element of every family.
fn entries() -> Vec<Entry> {
    Family::ALL
        .iter()
        .flat_map(|&family| manuals(family).into_iter().map(move |m| entry(family, m)))
        .collect()
}

fn manuals(family: Family) -> Vec<Manual> {
    match family {
        Family::Shape => Shape::manual().into_iter().chain([manual::GROUP, manual::INSTANCE]).collect(),
        Family::Bsdf => Material::manual(),
        Family::Texture => Texture::manual(),
        Family::Light => Light::manual(),
        Family::Camera => Camera::manual(),
        Family::Filter => Filter::manual(),
        Family::Sampler => Sampler::manual(),
        Family::Film => vec![manual::FILM],
        Family::Integrator => aureole::render::integrators()
            .iter()
            .map(|m| Manual { kind: m.kind, summary: m.summary, params: m.params })
            .collect(),
        Family::Medium => Vec::new(),
    }
}

fn entry(family: Family, manual: Manual) -> Entry {
    Entry { family: family.name(), kind: manual.kind, summary: manual.summary, params: manual.params }
}

/// The elements of a family, or those of a name.
fn select(all: &[Entry], name: &str) -> Result<Vec<Entry>, Failure> {
    let family = family_name(name);
    let chosen: Vec<Entry> =
        all.iter().filter(|entry| entry.family == family || entry.kind == name).copied().collect();
    if !chosen.is_empty() {
        return Ok(chosen);
    }
    let families = || Family::ALL.iter().map(|family| family.name());
    let failure = Failure::usage(format!("there is no family or element `{name}`"));
    Err(match suggest(name, families().chain(all.iter().map(|entry| entry.kind))) {
        Some(near) => failure.with_help(format!("did you mean `{near}`?")),
        None => failure.with_help(format!("families: {}", families().collect::<Vec<_>>().join(", "))),
    })
}

/// The family that a word means: also plurals and what others call them.
fn family_name(word: &str) -> &str {
    match word {
        "material" | "materials" => "bsdf",
        "media" => "medium",
        "emitter" | "emitters" => "light",
        "sensor" | "sensors" => "camera",
        _ => word.strip_suffix('s').unwrap_or(word),
    }
}

fn text(entries: &[Entry], with_params: bool) -> String {
    let mut text = String::new();
    let width = entries.iter().map(|entry| entry.kind.len()).max().unwrap_or(0);
    let mut family = "";
    for entry in entries {
        if entry.family != family {
            family = entry.family;
            let space = if text.is_empty() { "" } else { "\n" };
            let _ = writeln!(text, "{space}{family}"); // writing to a string cannot fail
            if with_params && family == Family::Shape.name() {
                let _ = writeln!(text, "\n  every shape also takes");
                write_params(&mut text, shape::COMMON_PARAMS);
            }
        }
        if with_params {
            let _ = writeln!(text, "\n  {}\n    {}", entry.kind, entry.summary);
            write_params(&mut text, entry.params);
        } else {
            let _ = writeln!(text, "  {:<width$}  {}", entry.kind, entry.summary);
        }
    }
    text
}

fn write_params(text: &mut String, params: &[ParamDoc]) {
    let widest = |f: fn(&ParamDoc) -> &str| params.iter().map(|param| f(param).len()).max().unwrap_or(0);
    let (name, ty, default) = (widest(|p| p.name), widest(|p| p.ty), widest(|p| p.default));
    for param in params {
        let line = format!(
            "      {:<name$}  {:<ty$}  {:<default$}  {}",
            param.name, param.ty, param.default, param.doc
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

fn params_as_objects<S: serde::Serializer>(params: &[ParamDoc], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Param {
        name: &'static str,
        #[serde(rename = "type")]
        ty: &'static str,
        default: &'static str,
        doc: &'static str,
    }
    serializer.collect_seq(params.iter().map(|p| Param {
        name: p.name,
        ty: p.ty,
        default: p.default,
        doc: p.doc,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_and_elements_are_found() {
        let all = entries();
        assert!(select(&all, "shapes").unwrap().len() > 5);
        assert_eq!(select(&all, "materials").unwrap().len(), select(&all, "bsdf").unwrap().len());
        assert_eq!(select(&all, "rough_conductor").unwrap().len(), 1);
        assert!(select(&all, "spere").is_err());
    }

    #[test]
    fn every_element_has_a_summary_and_every_parameter_a_meaning() {
        for entry in entries() {
            assert!(!entry.summary.is_empty(), "{}", entry.kind);
            for param in entry.params {
                assert!(!param.ty.is_empty() && !param.doc.is_empty(), "{} {}", entry.kind, param.name);
            }
        }
    }
}
