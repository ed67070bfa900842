//! Scenes that other renderers publish. They are not part of this project, so these tests run only where they are asked for.

#![expect(clippy::print_stdout, reason = "which file a failure is about")]

use std::path::{Path, PathBuf};

use aureole_desc::{Report, SceneDesc, Sources, Value};
use aureole_formats::{LoadOptions, load};

fn read(path: &Path) -> (SceneDesc, Report) {
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let options = LoadOptions::default();
    match load(path, &options, &mut sources, &mut report) {
        Ok(scene) => {
            assert!(report.errors.is_empty());
            for warning in &report.warnings {
                let place = sources.locate(warning.at).map(|place| place.to_string()).unwrap_or_default();
                println!("{place}: {}", warning.message);
            }
            (scene, report)
        }
        Err(error) => panic!("{}: {error} at {:?}", path.display(), sources.locate(error.span())),
    }
}

fn xml_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let fragment = ["include", "fragments"].iter().any(|name| path.ends_with(name));
        if path.is_dir() && !fragment {
            xml_files(&path, found);
        } else if path.extension().is_some_and(|suffix| suffix == "xml") {
            found.push(path);
        }
    }
}

#[test]
#[ignore = "needs the scenes beside the project"]
fn shared_mitsuba_scenes_read() {
    let mut files = Vec::new();
    xml_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/mitsuba"), &mut files);
    assert!(!files.is_empty(), "there are no scenes beside the project");
    files.sort();
    for path in files {
        println!("{}", path.display());
        let (scene, _) = read(&path);
        assert!(!scene.cameras.is_empty() && scene.film.is_some() && scene.integrator.is_some());
        for (_, node) in scene.nodes() {
            if let Some(Value::Mesh(mesh)) = node.params.get("mesh") {
                mesh.check().unwrap();
            }
        }
    }
}
