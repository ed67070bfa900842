//! What is wrong is said with its place, and the exit code tells what kind of wrong it is.

use crate::fixture::Program;

#[test]
fn a_missing_scene() {
    Program::new().fails("render missing.xml", 3, &["missing.xml"]);
}

#[test]
fn a_file_of_no_known_format() {
    let program = Program::new();
    program.write("notes.txt", "no scene at all");
    program.fails("render notes.txt", 3, &["notes.txt"]);
}

#[test]
fn an_unknown_plugin_with_its_place_and_a_suggestion() {
    let program = Program::with_ball(r#"<shape type="spere"/>"#);
    program.fails("render ball.xml", 3, &["spere", "ball.xml:21:", "did you mean `sphere`?"]);
}

#[test]
fn a_value_of_the_wrong_type() {
    let program = Program::with_ball(r#"<shape type="sphere"><float name="radius" value="big"/></shape>"#);
    program.fails("render ball.xml", 3, &["big", "ball.xml:21:"]);
}

#[test]
fn an_impossible_number_for_the_integrator() {
    let program = Program::new();
    let integrator =
        r#"<integrator type="direct"><integer name="emitter_samples" value="4294967295"/></integrator>"#;
    program.write("many.xml", &format!("<scene version=\"3.0.0\">\n  {integrator}\n</scene>\n"));
    for command in ["render", "info"] {
        program.fails(&format!("{command} many.xml"), 3, &["emitter_samples", "4294967295", "many.xml:2:"]);
    }
}

#[test]
fn an_unclosed_tag() {
    let program = Program::new();
    program.write("open.xml", "<scene version=\"3.0.0\">\n  <shape type=\"sphere\">\n</scene>\n");
    program.fails("render open.xml", 3, &["shape", "open.xml:"]);
}

#[test]
fn an_include_cycle() {
    let program = Program::new();
    let including =
        |name: &str| format!("<scene version=\"3.0.0\">\n  <include filename=\"{name}\"/>\n</scene>\n");
    program.write("a.xml", &including("b.xml"));
    program.write("b.xml", &including("a.xml"));
    program.fails("render a.xml", 3, &["a.xml", "include"]);
}

#[test]
fn a_missing_mesh_names_the_mesh_and_the_line_that_wants_it() {
    let element = r#"<shape type="ply"><string name="filename" value="gone.ply"/></shape>"#;
    Program::with_ball(element).fails("render ball.xml", 3, &["gone.ply", "ball.xml:21:"]);
}

#[test]
fn a_limit() {
    let program = Program::with_ball("");
    program.fails("render ball.xml --max-pixels 100", 5, &["1200", "100"]);
    program.fails("render ball.xml --max-file-bytes 10", 5, &["ball.xml"]);
}

#[test]
fn wrong_usage() {
    let program = Program::with_ball("");
    program.fails("render ball.xml --sp 4", 2, &["--spp"]);
    program.fails("rendr ball.xml", 2, &["render"]);
    program.fails("render ball.xml --integrator pth", 2, &["path"]);
    program.fails("render ball.xml --resolution 40", 2, &["640x480"]);
    program.fails("render ball.xml --spp 0", 2, &["--spp"]);
    program.fails("render ball.xml --crop 0.5,0.5,0.5,0.5", 2, &["empty"]);
    program.fails("render ball.xml --set integator.max_depth=2", 2, &["integrator"]);
    program.fails("render ball.xml --color spectral", 2, &["later"]);
    program.fails("render ball.xml -o image.pgn", 2, &["png"]);
    program.fails("render ball.xml -o - --stats json", 2, &["standard output"]);
    program.fails("render gallery:glas", 2, &["`glass`"]);
    program.fails("list sfere", 2, &["sfere"]);
}

#[test]
fn what_cannot_be_written_is_said_before_the_work() {
    let program = Program::with_ball("");
    program.fails("render ball.xml -o no/such/folder/image.png --spp 100000000", 4, &["no/such/folder"]);
    std::fs::create_dir(program.path().join("folder.png")).unwrap();
    program.fails("render ball.xml -o folder.png --spp 100000000", 4, &["folder.png"]);
}

#[test]
fn warnings_do_not_stop_a_render_but_strictly_they_do() {
    let program = Program::with_ball(r#"<shape type="sphere"><float name="radiuss" value="2"/></shape>"#);
    let outcome = program.ok("render ball.xml");
    for word in ["radiuss", "did you mean `radius`?", "ball.xml:21:"] {
        assert!(outcome.stderr.contains(word), "{}", outcome.stderr);
    }
    assert!(program.ok("render ball.xml -q").stderr.is_empty());
    std::fs::remove_file(program.path().join("ball.png")).unwrap();
    program.fails("render ball.xml --strict", 3, &["radiuss", "--strict"]);
    assert!(!program.path().join("ball.png").exists());
}

#[test]
fn several_errors_are_said_at_once() {
    let negative = r#"<shape type="sphere"><float name="radius" value="-1"/></shape>"#;
    let program = Program::with_ball(&format!("{negative}\n{negative}"));
    program.fails("render ball.xml", 3, &["ball.xml:21:", "ball.xml:22:"]);
}

#[test]
fn several_errors_are_said_at_once_for_pbrt_too() {
    let program = Program::new();
    program.write(
        "three.pbrt",
        "WorldBegin\nShape \"spere\" \"float radius\" 1\nMaterial \"difuse\"\n\
         Shape \"sphere\" \"floot radius\" [1 2] \"float zmin\" 0\nShape \"sphere\"\n",
    );
    let words = ["spere", "three.pbrt:2:", "difuse", "three.pbrt:3:", "floot", "three.pbrt:4:", "`float`"];
    program.fails("render three.pbrt", 3, &words);
}

#[test]
fn messages_have_no_colours_away_from_a_terminal() {
    let program = Program::with_ball(r#"<shape type="spere"/>"#);
    assert!(!program.run("render ball.xml").stderr.contains('\x1b'));
}
