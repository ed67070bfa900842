//! What farms and worried people ask: machine-readable lines, memory before it is taken, one sample in slow motion.

use crate::fixture::Program;

/// Every line of standard error is a JSON object; gives those of one kind of event.
fn events(stderr: &str, kind: &str) -> Vec<serde_json::Value> {
    let lines = stderr.lines().map(|line| {
        serde_json::from_str::<serde_json::Value>(line).unwrap_or_else(|error| panic!("{error}: {line}"))
    });
    lines.filter(|object| object["event"] == kind).collect()
}

#[test]
fn messages_progress_and_log_as_json_lines() {
    let program = Program::with_ball(r#"<shape type="sphere"><float name="radiuss" value="2"/></shape>"#);
    let outcome = program.ok("render ball.xml --json -vv");
    let warnings = events(&outcome.stderr, "warning");
    assert_eq!(warnings.len(), 1);
    assert_eq!((&warnings[0]["line"], &warnings[0]["help"]), (&21.into(), &"did you mean `radius`?".into()));
    assert!(!events(&outcome.stderr, "log").is_empty());
    let done = events(&outcome.stderr, "done");
    assert_eq!(done[0]["stats"]["samples"], 4800);

    let wrong = r#"<shape type="spere"/><shape type="sphere"><float name="radius" value="-1"/></shape>"#;
    let outcome = Program::with_ball(wrong).run("render ball.xml --json");
    assert_eq!(outcome.code, Some(3));
    let errors = events(&outcome.stderr, "error");
    assert!(errors[0]["file"].as_str().is_some_and(|file| file.ends_with("ball.xml")), "{errors:?}");
}

#[test]
fn wrong_usage_and_lists_as_json_too() {
    let program = Program::with_ball("");
    let outcome = program.run("render ball.xml --json --sp 4");
    assert_eq!(outcome.code, Some(2));
    let errors = events(&outcome.stderr, "error");
    assert!(errors[0]["message"].as_str().is_some_and(|text| text.contains("'--sp'")), "{errors:?}");
    assert!(errors[0]["help"].as_str().is_some_and(|text| text.contains("--spp")), "{errors:?}");
    for command in ["info missing.xml --json", "diff a.exr b.exr --json", "render missing.xml --json"] {
        let outcome = program.run(command);
        assert_eq!((outcome.code, events(&outcome.stderr, "error").len()), (Some(3), 1), "{command}");
    }
    assert_eq!(events(&program.run("list sfere --json").stderr, "error").len(), 1);
    let gallery = program.ok("gallery --json").json();
    assert_eq!(gallery[0]["name"], "cornell-box");
}

#[test]
fn checkpoints_are_told_to_programs() {
    let program = Program::with_ball("");
    let render = "render ball.xml --json --checkpoint film.exr --resume --every 1ms --spp";
    let first = program.ok(&format!("{render} 300"));
    assert_eq!(events(&first.stderr, "resumed")[0]["samples_per_pixel"], 0);
    assert!(!events(&first.stderr, "checkpoint").is_empty(), "{}", first.stderr);
    let again = program.ok(&format!("{render} 301"));
    assert_eq!(events(&again.stderr, "resumed")[0]["samples_per_pixel"], 300);
}

#[test]
fn long_renders_tell_how_far_they_are() {
    let program = Program::with_ball("");
    let outcome = program.ok("render ball.xml --json --time 2.5 --resolution 200x200");
    let progress = events(&outcome.stderr, "progress");
    assert!(!progress.is_empty() && progress.len() <= 3, "{}", outcome.stderr);
    assert!(progress[0]["done"].as_f64().is_some_and(|done| (0.2..0.9).contains(&done)));
}

#[test]
fn verbosity_has_degrees() {
    let program = Program::with_ball("");
    let lines = |args: &str| program.ok(&format!("render ball.xml {args}")).stderr.lines().count();
    let (plain, verbose, more) = (lines(""), lines("-v"), lines("-vv"));
    assert!(plain < verbose && verbose < more, "{plain} {verbose} {more}");
}

#[test]
fn memory_is_asked_for_beforehand() {
    let program = Program::with_ball("");
    program.ok("render ball.xml --memory-limit 1GiB");
    program.fails("render ball.xml --memory-limit 1MiB", 5, &["memory", "--memory-limit"]);
    program.fails("render ball.xml --resolution 16000x16000 --memory-limit 4GiB", 5, &["for the image"]);
    program.fails("render ball.xml --memory-limit some", 2, &["4GiB"]);
    let info = program.ok("info ball.xml --json --resolution 1000x1000").json();
    let predicted = info["predicted_memory_bytes"].as_u64().expect("a number");
    assert!((50 << 20..500 << 20).contains(&predicted), "{predicted}");
}

#[test]
fn the_prediction_is_near_what_is_taken() {
    let program = Program::new();
    let predicted = program.ok("info gallery:cornell-box --json --resolution 1000x1000").json();
    let taken = program.ok("render -o a.exr --resolution 1000x1000 --spp 1 --stats json").json();
    let number = |object: &serde_json::Value, name: &str| object[name].as_f64().expect("a number");
    let ratio = number(&predicted, "predicted_memory_bytes") / number(&taken, "peak_memory_bytes");
    assert!((0.85..1.5).contains(&ratio), "{ratio}");
}

#[test]
fn one_sample_in_slow_motion() {
    let program = Program::with_ball("");
    let text = program.ok("render ball.xml --debug-pixel 20,15,3").text();
    for words in [
        "pixel 20,15, sample 3",
        "vertex 1",
        "sphere (ball.xml:16:5) of diffuse (ball.xml:18:9)",
        "lobes      Diffuse",
        "escape",
        "radiance",
    ] {
        assert!(text.contains(words), "no `{words}` in\n{text}");
    }
    assert_eq!(text, program.ok("render ball.xml --debug-pixel 20,15,3 --threads 2").text());
    let others: String =
        (0..4).map(|i| program.ok(&format!("render ball.xml --debug-pixel 20,15,{i}")).text()).collect();
    for words in ["light      constant (ball.xml:20:5), towards", "shadow     free", "light      none"] {
        assert!(others.contains(words), "no `{words}` in\n{others}");
    }
    assert!(!program.path().join("ball.png").exists(), "nothing is rendered");
    program.fails("render ball.xml --debug-pixel 40,0", 2, &["40,0", "40 x 30"]);
    program.fails("render ball.xml --debug-pixel 4", 2, &["12,40"]);
}
