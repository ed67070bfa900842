//! Long renders: checkpoints, resuming, parts and their merging, the same bits every time.

use std::path::Path;

use crate::fixture::Program;

/// Renders the ball in parts, `i.exr` each.
fn render_parts(program: &Program, n: u32) -> Vec<String> {
    let names = (0..n).map(|i| format!("{n}-{i}.exr"));
    let render = |(i, name): (usize, String)| {
        program.ok(&format!("render ball.xml --spp 32 --shard {i}/{n} -o {name} -q"));
        name
    };
    names.enumerate().map(render).collect()
}

#[test]
fn parts_in_any_order_are_the_whole() {
    let program = Program::with_ball("");
    program.ok("render ball.xml --spp 32 -o whole.exr");
    for n in [2, 5, 16] {
        let mut parts = render_parts(&program, n);
        for turn in 0..3 {
            parts.rotate_left(turn);
            parts.swap(0, 1);
            program.ok(&format!("merge {} -o merged.exr", parts.join(" ")));
            assert_eq!(program.read("merged.exr"), program.read("whole.exr"), "{parts:?}");
        }
    }
    program.ok("render ball.xml --spp 32 --samples 0..7 -o a.exr");
    program.ok("render ball.xml --spp 32 --samples 7..32 -o b.exr --threads 3 --tile 7");
    program.ok("merge b.exr a.exr -o merged.exr");
    assert_eq!(program.read("merged.exr"), program.read("whole.exr"));
}

#[test]
fn parts_that_do_not_make_a_whole_are_refused() {
    let program = Program::with_ball("");
    let parts = render_parts(&program, 5);
    let others: Vec<_> = parts.iter().filter(|part| *part != "5-2.exr").map(String::as_str).collect();
    let others = others.join(" ");
    program.fails(&format!("merge {others} -o m.exr"), 3, &["samples 12..19 are missing"]);
    let doubled = format!("merge {others} 5-2.exr 5-1.exr -o m.exr");
    program.fails(&doubled, 3, &["samples 6..12", "5-1.exr"]);

    program.ok("render ball.xml --spp 32 --shard 2/5 -o seed.exr --seed 9");
    program.fails(&format!("merge {others} seed.exr -o m.exr"), 3, &["seed.exr", "seed: 9, here 0"]);
    program.ok("render ball.xml --spp 32 --shard 2/5 -o radius.exr -D radius=2");
    program.fails(&format!("merge {others} radius.exr -o m.exr"), 3, &["radius.exr", "shape: #"]);
    program.ok("render ball.xml --spp 32 -o image.exr");
    program.fails("merge image.exr -o m.exr", 3, &["image.exr", "no film"]);
    program.fails("merge ball.xml -o m.exr", 3, &["ball.xml"]);
    program.fails("merge missing.exr -o m.exr", 3, &["missing.exr"]);
    assert!(!program.path().join("m.exr").exists());
}

#[test]
fn parts_have_sensible_bounds() {
    let program = Program::with_ball("");
    program.fails("render ball.xml --shard 2/2", 2, &["counted from 0"]);
    program.fails("render ball.xml --spp 4 --shard 1/9 -o a.exr", 2, &["cannot be shared"]);
    program.fails("render ball.xml --spp 4 --samples 2..9 -o a.exr", 2, &["beyond 4"]);
    program.fails("render ball.xml --shard 0/2 -o a.png", 2, &[".exr"]);
    program.fails("render ball.xml --samples 4 -o a.exr", 2, &["0..64"]);
}

#[test]
fn a_checkpoint_goes_on_with_more_samples() {
    let program = Program::with_ball("");
    program.ok("render ball.xml --spp 24 -o whole.exr");
    program.ok("render ball.xml --spp 5 -o few.exr --checkpoint film.exr --resume");
    program.fails("render ball.xml --spp 24 --checkpoint film.exr", 2, &["exists already", "--resume"]);
    let outcome = program.ok("render ball.xml --spp 24 -o more.exr --checkpoint film.exr --resume --tile 11");
    assert!(outcome.stderr.contains("at 5 samples"), "{}", outcome.stderr);
    assert_eq!(program.read("more.exr"), program.read("whole.exr"));
    // There is nothing left to do, and the image is written all the same.
    let stats =
        program.ok("render ball.xml --spp 24 -o again.exr --checkpoint film.exr --resume --stats json");
    assert_eq!((&stats.json()["samples"], &stats.json()["complete"]), (&0.into(), &true.into()));
    assert_eq!(program.read("again.exr"), program.read("whole.exr"));
    // A checkpoint is a film like any other.
    program.ok("merge film.exr -o merged.exr");
    assert_eq!(program.read("merged.exr"), program.read("whole.exr"));
}

#[test]
fn checkpoints_of_other_renders_are_refused() {
    let program = Program::with_ball("");
    let render = "render ball.xml --checkpoint film.exr --resume";
    program.ok(render);
    let before = program.read("film.exr");
    for (options, words) in [
        ("--seed 3", "seed: 0, here 3"),
        ("--resolution 41x30", "size: 40 x 30"),
        ("--crop 0,0,0.5,0.5", "size: 40 x 30"),
        ("-D radius=0.5", "shape: #"),
        ("--set integrator.max_depth=2", "integrator: #"),
        ("--integrator direct", "integrator option: none, here direct"),
        ("--set camera.fov=20", "camera: #"),
        ("--set sampler.kind=independent", "sampler: #"),
        ("--spp 3", "4 already, only 3"),
        ("--samples 2..4", "samples: 0..4, here 2..4"),
    ] {
        program.fails(&format!("{render} {options}"), 3, &["film.exr", words]);
    }
    assert_eq!(program.read("film.exr"), before);
    program.write(
        "ball.xml",
        &String::from_utf8_lossy(&program.read("ball.xml")).replace("diffuse", "conductor"),
    );
    program.fails(render, 3, &["bsdf: #"]);
}

#[test]
fn damaged_checkpoints_are_refused() {
    let program = Program::with_ball("");
    program.ok("render ball.xml --spp 2 --checkpoint whole.exr");
    let whole = program.read("whole.exr");
    let mut flipped = whole.clone();
    *flipped.last_mut().expect("a byte") ^= 16;
    let damaged = [whole[..whole.len() / 2].to_vec(), Vec::new(), flipped, vec![0xff; whole.len()]];
    for bytes in damaged {
        std::fs::write(program.path().join("film.exr"), bytes).expect("a writable folder");
        program.fails("render ball.xml --spp 4 --checkpoint film.exr --resume", 3, &["film.exr"]);
    }
}

#[cfg(unix)]
#[test]
fn interrupted_renders_lose_nothing() {
    let program = Program::with_ball("");
    program.ok("render ball.xml --spp 3000 -o whole.exr --threads 2");
    for (signal, code) in [("INT", Some(130)), ("TERM", Some(143)), ("KILL", None)] {
        let checkpoint = format!("{signal}.film.exr");
        let args = format!(
            "render ball.xml --spp 3000 -o part.exr --checkpoint {checkpoint} --every 1ms --resume -q"
        );
        let mut child = program.command(&args).spawn().expect("a program");
        while !program.path().join(&checkpoint).exists() && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let kill = std::process::Command::new("kill").args(["-s", signal, &child.id().to_string()]).status();
        assert!(kill.is_ok_and(|status| status.success()));
        assert_eq!(child.wait().expect("a child").code(), code, "{signal}");
        let stats = program.ok(&format!("{args} --stats json").replace("part", signal)).json();
        assert!(stats["samples"].as_u64().is_some_and(|n| n < 40 * 30 * 3000), "nothing was resumed");
        assert_eq!(program.read(&format!("{signal}.exr")), program.read("whole.exr"), "{signal}");
    }
}

/// No file may grow beyond a few blocks: what a full disk is to a program.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_checkpoint() {
    let program = Program::with_ball("");
    program.ok("render ball.xml --spp 2 --checkpoint film.exr -o two.exr");
    let before = program.read("film.exr");
    let render = "render ball.xml --spp 4 --checkpoint film.exr --resume -o four.exr";
    let script = format!("trap '' XFSZ; ulimit -f 8; exec {} {render}", env!("CARGO_BIN_EXE_aureole"));
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(program.path())
        .output()
        .expect("sh");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{message}");
    assert!(message.contains("cannot write"), "{message}");
    assert_eq!(program.read("film.exr"), before);
    program.ok(render);
    program.ok("render ball.xml --spp 4 -o whole.exr");
    assert_eq!(program.read("four.exr"), program.read("whole.exr"));
}

/// Renders a scene with other threads and tiles, which must not show.
fn check_repeatability(program: &Program, scene: &str) {
    let render = |options: &str| {
        program.ok(&format!("render {scene} --resolution 24x20 --spp 3 -q -o a.exr {options}"));
        program.read("a.exr")
    };
    let first = render("--threads 1");
    for options in
        ["--threads 2", "--threads 3", "--threads 8", "--threads 2 --tile 7", "--threads 8 --tile 64"]
    {
        assert_eq!(render(options), first, "{scene} {options}");
    }
}

#[test]
fn threads_and_tiles_change_no_bit_of_the_gallery() {
    let program = Program::new();
    for scene in aureole::formats::GALLERY {
        check_repeatability(&program, &format!("gallery:{}", scene.name));
    }
}

/// Scenes that other renderers publish; they are not part of this project.
#[test]
fn threads_and_tiles_change_no_bit_of_published_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/mitsuba/tests/scenes");
    let Ok(folders) = std::fs::read_dir(&folder) else {
        println!("skipped: {} is not there", folder.display());
        return;
    };
    let program = Program::new();
    let files = folders.flatten().flat_map(|folder| std::fs::read_dir(folder.path()).into_iter().flatten());
    let paths = files.flatten().map(|file| file.path());
    for path in paths.filter(|path| path.extension().is_some_and(|suffix| suffix == "xml")) {
        check_repeatability(&program, &path.display().to_string());
    }
}
