//! The commands besides `render`.

use crate::fixture::Program;

#[test]
fn every_command_helps_with_examples() {
    let program = Program::new();
    for command in ["render", "info", "list", "diff", "gallery"] {
        let help = program.ok(&format!("{command} --help")).text();
        assert!(help.contains("Examples:"), "{command}");
    }
    assert!(program.ok("--version").text().starts_with("aureole "));
}

#[test]
fn info_counts() {
    let program = Program::with_ball(r#"<shape type="rectangle"/>"#);
    let info = program.ok("info ball.xml --json").json();
    assert_eq!(info["shapes"], 2);
    assert_eq!(info["lights"], 1);
    assert_eq!(info["width"], 40);
    assert_eq!(info["kinds"]["shape"]["sphere"], 1);
    assert!((info["bounds"][0][0].as_f64().unwrap() + 1.0).abs() < 1e-3);
    let text = program.ok("info ball.xml --accel").text();
    assert!(text.contains("40 x 30") && text.contains("SAH"), "{text}");
}

#[test]
fn list_knows_every_family() {
    let program = Program::new();
    let all = program.ok("list").text();
    for word in
        ["sphere", "rough_conductor", "checkerboard", "envmap", "perspective", "gaussian", "sobol", "path"]
    {
        assert!(all.contains(word), "{word}");
    }
    assert!(program.ok("list shape").text().contains("radius"));
    let elements = program.ok("list --json").json();
    let sphere = elements.as_array().unwrap().iter().find(|element| element["kind"] == "sphere").unwrap();
    assert_eq!(sphere["family"], "shape");
    assert_eq!(sphere["params"][0]["name"].as_str().map(str::is_empty), Some(false));
}

#[test]
fn diff_measures_and_judges() {
    let program = Program::with_ball("");
    program.ok("render ball.xml -o a.exr --spp 16");
    program.ok("render ball.xml -o b.exr --spp 16 --seed 1");
    let same = program.ok("diff a.exr a.exr --json --fail-above 0").json();
    assert_eq!(same["mse"], 0.0);
    assert!(same["psnr"].is_null());
    let noise = program.ok("diff a.exr b.exr --json").json();
    assert!(noise["mse"].as_f64().unwrap() > 0.0 && noise["flip"].as_f64().unwrap() < 0.5);
    assert_eq!(program.run("diff a.exr b.exr --fail-above 0").code, Some(1));
    assert_eq!(program.run("diff a.exr b.exr --metric mse --fail-above 1").code, Some(0));
    program.ok("diff a.exr b.exr -o map.png");
    assert!(program.read("map.png").starts_with(b"\x89PNG"));
    program.fails("diff a.exr gone.exr", 3, &["gone.exr"]);
}

#[test]
fn a_z_test_accepts_noise_and_rejects_bias() {
    let program = Program::with_ball("");
    program.ok("render ball.xml -o mean.exr --spp 64");
    program.ok("render ball.xml -o good.exr --spp 16 --seed 1");
    program.ok("render ball.xml -o bad.exr --spp 16 --seed 1 --set integrator.max_depth=1");
    // Any image will do as a variance that is larger than the truth, and a number of samples that goes with it.
    let verdict = |name: &str| {
        program.run(&format!("diff mean.exr {name} --ztest mean.exr --spp 256 --json")).json()["ztest"]["passes"].clone()
    };
    assert_eq!(verdict("good.exr"), true);
    assert_eq!(verdict("bad.exr"), false);
}

#[test]
fn the_gallery_is_listed_shown_and_rendered() {
    let program = Program::new();
    let list = program.ok("gallery").text();
    assert!(list.contains("cornell-box") && list.contains("glass"));
    let text = program.ok("gallery glass").text();
    program.write("mine.xml", &text);
    program.ok("render mine.xml --resolution 16x9 --spp 1");
    program.ok("gallery glass -o pictures --spp 1 -q");
    assert!(program.read("pictures/glass.png").starts_with(b"\x89PNG"));
    program.fails("gallery glas", 2, &["`glass`"]);
}
