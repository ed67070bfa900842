//! Renders a scene file: `cargo run --release --example render_file -- scene.pbrt image.exr`.

use std::path::PathBuf;

use aureole::formats::GALLERY;
use aureole::prelude::*;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "it is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (scene_file, image_file) = (arguments.next(), arguments.next());
    let image_file = image_file.unwrap_or_else(|| std::env::temp_dir().join("render_file.png"));

    // Read the file, or else the first scene of the gallery.
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let options = LoadOptions::default();
    let mut desc = match &scene_file {
        Some(file) => load(file, &options, &mut sources, &mut report)?,
        None => GALLERY[0].load(&options, &mut sources, &mut report)?,
    };

    // Descriptions are plain data until they are compiled.
    desc.set("integrator.max_depth", "8")?;
    let scene = compile(&desc, &CompileOptions::default(), &mut report)?;
    for warning in &report.warnings {
        let place = sources.locate(warning.at).map_or(String::new(), |place| format!("{place}: "));
        eprintln!("{place}{}", warning.message);
    }

    let options = RenderOptions { spp: Some(16), ..RenderOptions::default() };
    let rendered = render(&scene, &options, &Silent)?;
    write_image(&rendered.image, &image_file, &WriteOptions::default())?;
    println!("{} rays to {}", rendered.stats.rays, image_file.display());
    Ok(())
}
