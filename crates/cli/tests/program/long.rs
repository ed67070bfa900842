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
    // Everything that is wrong is told at once, and a part is never overwritten.
    let several = "merge 5-0.exr image.exr seed.exr missing.exr -o m.exr";
    program.fails(several, 3, &["image.exr", "seed: 9, here 0", "missing.exr"]);
    program.fails(
        "merge 5-0.exr 5-0.exr 5-3.exr -o m.exr",
        3,
        &["0..6 are in both", "6..19, 25..32 are missing"],
    );
    program.fails("merge 5-0.exr 5-1.exr -o ./5-1.exr", 2, &["would replace the part `5-1.exr`"]);
    assert!(!program.path().join("m.exr").exists());
}

#[test]
fn a_merge_for_programs() {
    let program = Program::with_ball("");
    render_parts(&program, 2);
    let merged = program.ok("merge 2-1.exr 2-0.exr -o m.exr --json").json();
    assert_eq!((&merged["parts"], &merged["samples_per_pixel"]), (&2.into(), &32.into()));
    let refused = program.run("merge 2-1.exr -o m.exr --json");
    let error: serde_json::Value = serde_json::from_str(&refused.stderr).expect("one JSON object");
    assert_eq!(error["message"], "samples 0..16 are missing");
    assert_eq!(refused.code, Some(3));
}

#[test]
fn a_merge_that_cannot_be_written_leaves_what_was_there() {
    let program = Program::with_ball("");
    render_parts(&program, 2);
    program.write("m.pfm", "an older picture");
    let merge = "merge 2-1.exr 2-0.exr -o m.pfm";
    let output = on_a_full_disk(&program, merge, 4);
    assert_eq!(output.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write `m.pfm`"));
    assert_eq!(program.read("m.pfm"), b"an older picture");
    program.ok(merge);
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

/// Runs the program where no file may grow beyond a few blocks: what a full disk is to it.
#[cfg(unix)]
fn on_a_full_disk(program: &Program, args: &str, blocks: u32) -> std::process::Output {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec {} {args}", env!("CARGO_BIN_EXE_aureole"));
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", &script]).current_dir(program.path()).output().expect("sh")
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_checkpoint() {
    let program = Program::with_ball("");
    program.ok("render ball.xml --spp 2 --checkpoint film.exr -o two.exr");
    let before = program.read("film.exr");
    let render = "render ball.xml --spp 4 --checkpoint film.exr --resume -o four.exr";
    let output =
        on_a_full_disk(&program, &format!("{render} --spp 400 --every 1ms").replacen("--spp 4 ", "", 1), 8);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{message}");
    // Trouble on the way is told once, however often it is met, and once more at the end.
    assert_eq!(message.matches("cannot write `film.exr`").count(), 2, "{message}");
    assert!(!message.contains(".aureole-"), "{message}");
    assert_eq!(program.read("film.exr"), before);
    program.ok(render);
    program.ok("render ball.xml --spp 4 -o whole.exr");
    assert_eq!(program.read("four.exr"), program.read("whole.exr"));
}

#[test]
fn checkpoints_and_images_are_different_files() {
    let program = Program::with_ball("");
    program.fails("render ball.xml --checkpoint a.exr -o ./a.exr", 2, &["would replace the checkpoint"]);
    program.fails("render ball.xml --checkpoint ball.png", 2, &["would replace the checkpoint"]);
    program.fails("render ball.xml --every 5s", 2, &["--checkpoint"]);
    // A part is a film as a checkpoint is.
    program.ok("render ball.xml --spp 4 --shard 0/2 --checkpoint part.exr -o part.exr");
    program.ok("render ball.xml --spp 4 --samples 2..4 -o other.exr");
    program.ok("merge other.exr part.exr -o whole.exr");
    std::fs::create_dir(program.path().join("folder")).expect("a writable folder");
    program.fails("render ball.xml --checkpoint folder --resume", 4, &["folder", "not a file"]);
    program.fails("render ball.xml --checkpoint no/such/film.exr", 4, &["no/such/film.exr"]);
}

#[cfg(unix)]
#[test]
fn two_processes_do_not_share_a_checkpoint() {
    let program = Program::with_ball("");
    let render = "render ball.xml --checkpoint film.exr --resume";
    let mut child =
        program.command(&format!("{render} --spp 100000000 --every 1ms -q")).spawn().expect("a program");
    while !program.path().join("film.exr").exists() && child.try_wait().expect("a child").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    program.fails(render, 4, &["film.exr", "in use by another process"]);
    program.ok("render ball.xml --checkpoint other.exr");
    child.kill().expect("a child");
    child.wait().expect("a child");
    // Whoever is dead holds nothing: what is wrong now is another thing, however far it came.
    program.fails(&format!("{render} --seed 7"), 3, &["seed"]);
}

/// However large the tiles are: a request to end is heard after a few samples.
#[cfg(unix)]
#[test]
fn requests_to_end_are_heard_within_a_tile() {
    let program = Program::with_ball("");
    // One tile, one pass: 16 samples for each of a million pixels.
    let args = "render ball.xml --resolution 1024x1024 --tile 1024 --spp 1000000 --threads 1 -o a.exr --json";
    let mut child = program.command(args).stderr(std::process::Stdio::null()).spawn().expect("a program");
    std::thread::sleep(std::time::Duration::from_secs(1));
    let start = std::time::Instant::now();
    let kill = std::process::Command::new("kill").args(["-s", "TERM", &child.id().to_string()]).status();
    assert!(kill.is_ok_and(|status| status.success()));
    assert_eq!(child.wait().expect("a child").code(), Some(143));
    println!("{:?}", start.elapsed());
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
#[ignore = "needs the scenes beside the project"]
fn threads_and_tiles_change_no_bit_of_shared_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/mitsuba/tests/scenes");
    let folders = std::fs::read_dir(&folder).expect("there are scenes beside the project");
    let program = Program::new();
    let files = folders.flatten().flat_map(|folder| std::fs::read_dir(folder.path()).into_iter().flatten());
    let paths = files.flatten().map(|file| file.path());
    let paths: Vec<_> = paths.filter(|path| path.extension().is_some_and(|suffix| suffix == "xml")).collect();
    assert!(!paths.is_empty(), "there are no scenes in {}", folder.display());
    for path in paths {
        check_repeatability(&program, &path.display().to_string());
    }
}
