//! `aureole render`: outputs, options, figures, repeatability.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::fixture::Program;
use aureole::image::{Image, ImageLimits, read_image};

fn image(program: &Program, name: &str) -> Image {
    read_image(&program.path().join(name), &ImageLimits::default()).unwrap()
}

#[test]
fn the_default_output_is_named_after_the_scene() {
    let program = Program::with_ball("");
    let outcome = program.ok("render ball.xml");
    assert!(outcome.stderr.contains("ball.png") && outcome.stderr.contains("rays/s"), "{}", outcome.stderr);
    assert!(outcome.stdout.is_empty());
    assert_eq!((image(&program, "ball.png").width(), image(&program, "ball.png").height()), (40, 30));
}

#[test]
fn quiet_says_nothing() {
    let outcome = Program::with_ball("").ok("render ball.xml -q");
    assert!(outcome.stdout.is_empty() && outcome.stderr.is_empty(), "{}", outcome.stderr);
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let program = Program::with_ball("");
    for threads in [1, 2, 8] {
        program.ok(&format!("render ball.xml -o {threads}.exr --threads {threads} --seed 3"));
    }
    assert_eq!(program.read("1.exr"), program.read("2.exr"));
    assert_eq!(program.read("1.exr"), program.read("8.exr"));
    program.ok("render ball.xml -o other.exr --seed 4");
    assert_ne!(program.read("1.exr"), program.read("other.exr"));
}

#[test]
fn standard_output_gets_the_image() {
    let program = Program::with_ball("");
    program.ok("render ball.xml -o file.png");
    assert_eq!(program.ok("render ball.xml -o -").stdout, program.read("file.png"));
    assert!(program.ok("render ball.xml -o - --format exr").stdout.starts_with(&[0x76, 0x2f, 0x31, 0x01]));
}

#[test]
fn figures_are_one_line_of_json() {
    let program = Program::with_ball("");
    let outcome = program.ok("render ball.xml --stats json --spp 2");
    assert_eq!(outcome.text().lines().count(), 1);
    let stats = outcome.json();
    assert_eq!(stats["samples"], 40 * 30 * 2);
    assert_eq!(stats["non_finite"], 0);
    assert_eq!(stats["file"], "ball.png");
    for key in ["load_seconds", "build_seconds", "render_seconds", "rays"] {
        assert!(stats[key].as_f64().unwrap() > 0.0, "{key}");
    }
    assert!(!cfg!(target_os = "linux") || stats["peak_memory_bytes"].as_u64().unwrap() > 1 << 16);
}

#[test]
fn a_crop_is_the_same_part_of_the_whole() {
    let program = Program::with_ball("");
    program.ok("render ball.xml -o whole.exr");
    program.ok("render ball.xml -o part.exr --crop 0.25,0.2,0.75,0.8");
    program.ok("render ball.xml -o pixels.exr --crop 10,6,30,24");
    assert_eq!(program.read("part.exr"), program.read("pixels.exr"));
    let (whole, part) = (image(&program, "whole.exr"), image(&program, "part.exr"));
    assert_eq!((part.width(), part.height()), (20, 18));
    for y in 0..18 {
        for x in 0..20 {
            assert_eq!(part.rgb(x, y), whole.rgb(x + 10, y + 6), "at {x}, {y}");
        }
    }
}

#[test]
fn options_change_the_image() {
    let program = Program::with_ball("");
    let center = |args: &str| {
        program.ok(&format!("render ball.xml -o changed.exr --spp 16 {args}"));
        let image = image(&program, "changed.exr");
        (image.width(), image.rgb(image.width() / 2, image.height() / 2))
    };
    assert_eq!(center("--resolution 10x8").0, 10);
    // Grey under a white sky, emission alone (none), and no ball in the way.
    let (_, grey) = center("");
    assert!((grey[0] - 0.5).abs() < 0.05, "{grey:?}");
    assert_eq!(center("--set integrator.max_depth=1").1, [0.0; 3]);
    assert_eq!(center("--integrator normals").1.map(|x| (x * 4.0).round()).len(), 3);
    assert_eq!(center("-D radius=0.01 --crop 0,0,0.25,0.25").1, [1.0; 3]);
}

#[test]
fn exposure_and_tone_are_for_eight_bits() {
    let program = Program::with_ball("");
    program.ok("render ball.xml -o plain.png");
    program.ok("render ball.xml -o bright.png --exposure 1");
    program.ok("render ball.xml -o dark.png --exposure -1 --tone agx");
    let mean = |name: &str| image(&program, name).data().iter().sum::<f32>();
    assert!(mean("bright.png") > mean("plain.png") && mean("plain.png") > mean("dark.png"));
}

#[test]
fn time_ends_a_render() {
    let program = Program::with_ball("");
    let stats = program.ok("render ball.xml --time 0.3 --stats json").json();
    assert!(stats["samples"].as_u64().unwrap() > 40 * 30);
    assert!(stats["render_seconds"].as_f64().unwrap() < 10.0);
    let stats = program.ok("render ball.xml --time 100 --spp 2 --stats json").json();
    assert_eq!(stats["samples"], 40 * 30 * 2);
}

#[cfg(unix)]
#[test]
fn signals_end_a_render_with_what_there_is() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let program = Program::with_ball("");
        let mut child = program.command("render ball.xml -o part.exr --spp 4000000000 -q").spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(700));
        let kill = std::process::Command::new("kill").args(["-s", signal, &child.id().to_string()]).status();
        assert!(kill.unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(code));
        assert!((image(&program, "part.exr").rgb(0, 0)[0] - 1.0).abs() < 1e-5);
    }
}
