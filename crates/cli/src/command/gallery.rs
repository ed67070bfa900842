//! `aureole gallery`: the scenes that come with the program.

use std::fmt::Write;
use std::path::Path;

use aureole::formats::{GALLERY, GalleryScene};
use serde::Serialize;

use super::render;
use crate::args::{GalleryArgs, RenderArgs, SceneArgs};
use crate::diagnostics::Painter;
use crate::exit::{Exit, Failure};
use crate::output::print;
use crate::session::GALLERY_PREFIX;

/// Runs the command.
pub(crate) fn run(args: &GalleryArgs, painter: &Painter) -> Result<Exit, Failure> {
    let scene = args.name.as_deref().map(find).transpose()?;
    match (&args.output, scene) {
        (Some(folder), Some(scene)) => render_into(folder, scene, args, painter),
        (Some(folder), None) => render_all(folder, args, painter),
        (None, Some(scene)) => print(scene.text).map(|()| Exit::Done),
        (None, None) if args.json => print(super::json_line(&entries())?).map(|()| Exit::Done),
        (None, None) => print(list()).map(|()| Exit::Done),
    }
}

fn find(name: &str) -> Result<&'static GalleryScene, Failure> {
    let name = name.strip_prefix(GALLERY_PREFIX).unwrap_or(name);
    GalleryScene::find(name).map_err(|error| {
        let help = error.help().unwrap_or_else(|| "`aureole gallery` lists them".to_owned());
        Failure::usage(error.to_string()).with_help(help)
    })
}

/// A scene in the list.
#[derive(Debug, Serialize)]
struct Entry {
    name: &'static str,
    format: &'static str,
    summary: &'static str,
}

fn entries() -> Vec<Entry> {
    let entry =
        |scene: &GalleryScene| Entry { name: scene.name, format: scene.format, summary: scene.summary };
    GALLERY.iter().map(entry).collect()
}

fn list() -> String {
    let width = GALLERY.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    GALLERY.iter().fold(String::new(), |mut text, scene| {
        let _ = writeln!(text, "{:<width$}  {}", scene.name, scene.summary); // writing to a string cannot fail
        text
    })
}

/// Renders every scene, until one is interrupted.
fn render_all(folder: &Path, args: &GalleryArgs, painter: &Painter) -> Result<Exit, Failure> {
    for scene in GALLERY {
        let exit = render_into(folder, scene, args, painter)?;
        if exit != Exit::Done {
            return Ok(exit);
        }
    }
    Ok(Exit::Done)
}

fn render_into(
    folder: &Path,
    scene: &GalleryScene,
    args: &GalleryArgs,
    painter: &Painter,
) -> Result<Exit, Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::write(folder, &error))?;
    let name = format!("{GALLERY_PREFIX}{}", scene.name);
    let render_args = RenderArgs {
        scene: SceneArgs { scene: Some(name.into()), ..SceneArgs::default() },
        output: Some(folder.join(scene.name).with_extension("png")),
        spp: args.spp,
        loudness: args.loudness,
        json: args.json,
        ..RenderArgs::default()
    };
    render::run(&render_args, painter)
}
