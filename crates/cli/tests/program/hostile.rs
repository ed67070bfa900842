//! Files that are broken, hostile or no files at all: a message that says where, a code that says what, and no waiting.

use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::time::{Duration, Instant};

use crate::fixture::Program;

/// Nothing of this may take longer: what multiplies takes for ever, a busy machine only a while.
const SOON: Duration = Duration::from_secs(60);

/// A scene that fails soon, with a code and certain words.
fn fails_soon(program: &Program, args: &str, code: i32, words: &[&str]) {
    let start = Instant::now();
    program.fails(args, code, words);
    assert!(start.elapsed() < SOON, "{args}: {:?}", start.elapsed());
}

fn with_shape(plugin: &str, file: &str) -> Program {
    Program::with_ball(&format!(r#"<shape type="{plugin}"><string name="filename" value="{file}"/></shape>"#))
}

fn with_texture(file: &str) -> Program {
    Program::with_ball(&format!(
        r#"<shape type="rectangle"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
        <string name="filename" value="{file}"/></texture></bsdf></shape>"#
    ))
}

#[test]
fn folders_and_devices_are_no_files() {
    for plugin in ["ply", "obj", "serialized", "sdfgrid"] {
        for file in [".", "/dev/zero"] {
            fails_soon(&with_shape(plugin, file), "render ball.xml", 3, &["not a file", "ball.xml:21:"]);
        }
    }
    fails_soon(&Program::new(), "render .", 3, &["cannot read `.`"]);
}

#[test]
fn textures_that_cannot_be_read_are_replaced_and_named() {
    for file in ["missing.png", ".", "/dev/zero", "ball.xml"] {
        let start = Instant::now();
        let outcome = with_texture(file).ok("render ball.xml --spp 1");
        assert!(outcome.stderr.contains(file) && outcome.stderr.contains("magenta"), "{}", outcome.stderr);
        assert!(start.elapsed() < SOON);
    }
}

#[test]
fn pipes_that_nobody_writes_to_are_not_waited_for() {
    let program = with_shape("ply", "pipe.ply");
    let made = std::process::Command::new("mkfifo").arg(program.path().join("pipe.ply")).status();
    assert!(made.is_ok_and(|status| status.success()));
    fails_soon(&program, "render ball.xml", 3, &["pipe.ply", "not a file"]);
}

#[test]
fn what_may_not_be_read_is_named() {
    let program = with_shape("ply", "secret.ply");
    program.write("secret.ply", "ply\n");
    let path = program.path().join("secret.ply");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o0)).expect("it is ours");
    if std::fs::read(&path).is_ok() {
        // This user may read everything, but for what no read works on.
        std::fs::remove_file(&path).expect("it is ours");
        std::os::unix::fs::symlink("/proc/self/mem", &path).expect("its place is free");
    }
    fails_soon(&program, "render ball.xml", 3, &["secret.ply", "ball.xml:21:"]);
}

#[test]
fn names_need_not_be_utf_8() {
    let program = Program::with_ball("");
    let name = std::ffi::OsStr::from_bytes(b"b\xe4ll.xml");
    std::fs::rename(program.path().join("ball.xml"), program.path().join(name)).expect("any name will do");
    let output = program.command("render --spp 1").arg(name).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::fs::write(program.path().join(name), "<scene").expect("it can be written");
    let output = program.command("render --spp 1").arg(name).output().expect("it runs");
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("ll.xml:1:"));
}

#[test]
fn entity_bombs_do_not_go_off() {
    let program = Program::new();
    let entities: String =
        (1..10).map(|i| format!("<!ENTITY e{i} \"{}\">", format!("&e{};", i - 1).repeat(10))).collect();
    program.write("bomb.xml", &format!("<!DOCTYPE s [<!ENTITY e0 \"ha\">{entities}]><scene>&e9;</scene>"));
    // Nothing of a document type is taken in, so its entity is no more than a word.
    fails_soon(&program, "render bomb.xml", 3, &["text between elements", "bomb.xml:1:"]);
}

#[test]
fn packed_bombs_are_refused() {
    let program = Program::new();
    // A gigabyte of nothing, twice packed by the system's tool; once is what is read.
    let script = "head -c 1000000000 /dev/zero | gzip -1 > bomb.pbrt.gz";
    let packed = std::process::Command::new("sh").args(["-c", script]).current_dir(program.path()).status();
    assert!(packed.is_ok_and(|status| status.success()));
    fails_soon(&program, "render bomb.pbrt.gz", 5, &["bomb.pbrt.gz", "size in bytes", "--max-unpack-ratio"]);
}

#[test]
fn deep_nesting_is_refused() {
    let program = Program::new();
    let deep = |open: &str, close: &str| format!("{}{}", open.repeat(100_000), close.repeat(100_000));
    let shapes = deep("<shape type=\"shapegroup\">", "</shape>");
    program.write("deep.xml", &format!("<scene version=\"3.0.0\">{shapes}</scene>"));
    fails_soon(&program, "render deep.xml", 5, &["nesting", "deep.xml:1:", "--max-nesting"]);
    program.write("deep.pbrt", &deep("AttributeBegin\n", "AttributeEnd\n"));
    fails_soon(&program, "render deep.pbrt", 5, &["nested", "deep.pbrt:257:"]);
    let open = "[".repeat(100_000);
    program.write("brackets.pbrt", &format!("WorldBegin\nShape \"sphere\" \"float radius\" {open}"));
    fails_soon(&program, "render brackets.pbrt", 3, &["bracket", "brackets.pbrt:2:"]);
}

#[test]
fn long_chains_of_references_are_refused() {
    let program = Program::new();
    let chain: String = (1..100_000)
        .map(|i| format!("Texture \"t{i}\" \"spectrum\" \"scale\" \"texture tex\" \"t{}\"\n", i - 1))
        .collect();
    program.write(
        "chain.pbrt",
        &format!(
            "WorldBegin\nTexture \"t0\" \"spectrum\" \"constant\" \"rgb value\" [1 1 1]\n{chain}\
             Material \"diffuse\" \"texture reflectance\" \"t99999\"\nShape \"sphere\"\n"
        ),
    );
    fails_soon(&program, "render chain.pbrt", 5, &["chain of elements", "chain.pbrt:", "--max-nesting"]);
}

#[test]
fn includes_in_circles_and_in_floods_are_refused() {
    let program = Program::new();
    program.write("self.pbrt", "Include \"self.pbrt\"\n");
    fails_soon(&program, "render self.pbrt", 3, &["includes itself", "self.pbrt:1:"]);
    symlink("linked.pbrt", program.path().join("again.pbrt")).expect("links can be made");
    program.write("linked.pbrt", "Include \"again.pbrt\"\n");
    fails_soon(&program, "render linked.pbrt", 3, &["again.pbrt:1:"]);

    // Twice two files that include twice two files ...
    for i in 0..40 {
        program.write(&format!("{i}.pbrt"), &format!("Include \"{0}.pbrt\"\nInclude \"{0}.pbrt\"\n", i + 1));
        let twice = format!("<include filename=\"{}.xml\"/>", i + 1).repeat(2);
        program.write(&format!("{i}.xml"), &format!("<scene version=\"3.0.0\">{twice}</scene>"));
    }
    program.write("40.pbrt", "# the end\n");
    program.write("40.xml", "<scene version=\"3.0.0\"/>");
    fails_soon(&program, "render 0.pbrt", 5, &["number of files", ".pbrt:", "--max-files"]);
    fails_soon(&program, "render 0.xml", 5, &["number of files", ".xml:"]);
}

#[test]
fn absurd_sizes_are_refused() {
    let program = Program::with_ball("");
    for size in ["1000000000", "99999999999999999999", "-5", "0", "1e9", "nan"] {
        let film = format!("<film type=\"hdrfilm\"><integer name=\"width\" value=\"{size}\"/></film>");
        program.write(
            "huge.xml",
            &format!("<scene version=\"3.0.0\"><sensor type=\"perspective\">{film}</sensor></scene>"),
        );
        fails_soon(&program, "render huge.xml", 3, &["width", "huge.xml:1:"]);
    }
    program.write(
        "huge.pbrt",
        "Film \"rgb\" \"integer xresolution\" 1000000000 \"integer yresolution\" 1000000000\nWorldBegin",
    );
    fails_soon(&program, "render huge.pbrt", 3, &["width", "huge.pbrt:1:"]);
    fails_soon(
        &program,
        "render ball.xml --set film.width=1000000 --set film.height=1000000",
        5,
        &["pixels", "--max-pixels"],
    );
}

#[test]
fn floods_of_mistakes_take_no_longer_than_files_of_their_size() {
    let program = Program::new();
    let mistakes = "Shape \"sphere\" \"float radiuss\" 1\n".repeat(50_000);
    program.write("mistakes.pbrt", &format!("WorldBegin\n{mistakes}"));
    let start = Instant::now();
    let outcome = program.ok("render mistakes.pbrt --spp 1 --resolution 8x8");
    assert!(outcome.stderr.contains("more warnings are not shown"), "{}", outcome.stderr);
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());

    let unknown: String = (0..100_000).map(|i| format!("\"float p{i}\" 1\n")).collect();
    program.write("flood.pbrt", &format!("WorldBegin\nShape \"sphere\"\n{unknown}"));
    fails_soon(&program, "render flood.pbrt", 5, &["parameters", "flood.pbrt:259:", "--max-params"]);
    let unknown: String = (0..100_000).map(|i| format!("<float name=\"p{i}\" value=\"1\"/>\n")).collect();
    program.write(
        "flood.xml",
        &format!("<scene version=\"3.0.0\"><shape type=\"sphere\">\n{unknown}</shape></scene>"),
    );
    fails_soon(&program, "render flood.xml", 5, &["parameters", "flood.xml:258:"]);
}

#[test]
fn floods_of_what_is_looked_up_are_refused() {
    let program = Program::new();
    let flood = |name: &str, line: fn(usize) -> String, rest: &str| {
        let lines: String = (0..5000).map(line).collect();
        program.write(name, &format!("<scene version=\"3.0.0\">{lines}{rest}</scene>"));
    };
    flood("defaults.xml", |i| format!("<default name=\"a{i}\" value=\"1\"/>\n"), "");
    fails_soon(&program, "render defaults.xml", 5, &["parameters", "defaults.xml:257:"]);
    flood("folders.xml", |i| format!("<path value=\"f{i}\"/>\n"), "");
    fails_soon(&program, "render folders.xml", 5, &["search folders", "folders.xml:64:"]);
    let ball = "<bsdf type=\"diffuse\" id=\"b0\"/><shape type=\"sphere\"><ref id=\"b5000\"/></shape>";
    flood("aliases.xml", |i| format!("<alias id=\"b{i}\" as=\"b{}\"/>\n", i + 1), ball);
    fails_soon(&program, "render aliases.xml", 3, &["unknown id `b5000`", "aliases.xml:5001:"]);

    let defaults: String = (0..256).map(|i| format!(" \"float p{i}\" 1")).collect();
    let blocks = "AttributeBegin\nShape \"sphere\"\nAttributeEnd\n".repeat(2000);
    program.write("attributes.pbrt", &format!("WorldBegin\nAttribute \"shape\"{defaults}\n{blocks}"));
    let start = Instant::now();
    program.ok("render attributes.pbrt --spp 1 --resolution 8x8");
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
}

#[test]
fn floods_of_errors_are_cut_off() {
    let program = Program::new();
    let named: String = (0..20_000).map(|i| format!("<bsdf type=\"diffuse\" id=\"m{i}\"/>\n")).collect();
    let wrong = "<shape type=\"sphere\"><ref id=\"nowhere\"/></shape>\n".repeat(20_000);
    program.write("wrong.xml", &format!("<scene version=\"3.0.0\">\n{named}{wrong}</scene>"));
    fails_soon(
        &program,
        "render wrong.xml",
        3,
        &["unknown id", "wrong.xml:20002:", "more errors are not shown"],
    );
}

#[test]
fn what_multiplies_is_refused() {
    let program = Program::new();
    let merged: String = (1..40)
        .map(|i| {
            format!("<shape type=\"merge\" id=\"m{i}\"><ref id=\"m{0}\"/><ref id=\"m{0}\"/></shape>", i - 1)
        })
        .collect();
    program.write(
        "merge.xml",
        &format!("<scene version=\"3.0.0\"><shape type=\"merge\" id=\"m0\"><shape type=\"cube\"/></shape>{merged}</scene>"),
    );
    fails_soon(&program, "render merge.xml", 5, &["merged shapes", "merge.xml:1:"]);

    let mixed: String = (1..40)
        .map(|i| {
            format!(
                "Texture \"t{i}\" \"spectrum\" \"mix\" \"texture tex1\" \"t{0}\" \"texture tex2\" \"t{0}\"\n",
                i - 1
            )
        })
        .collect();
    program.write(
        "mix.pbrt",
        &format!(
            "WorldBegin\nTexture \"t0\" \"spectrum\" \"constant\" \"rgb value\" [1 1 1]\n{mixed}\
             Material \"diffuse\" \"texture reflectance\" \"t39\"\nShape \"sphere\"\n"
        ),
    );
    fails_soon(&program, "render mix.pbrt", 5, &["evaluations", "mix.pbrt:"]);
}

#[test]
fn numbers_that_are_none_are_named() {
    for value in ["nan", "inf", "1e999"] {
        let element = format!(r#"<shape type="sphere"><float name="radius" value="{value}"/></shape>"#);
        fails_soon(&Program::with_ball(&element), "render ball.xml", 3, &["radius", "ball.xml:21:"]);
    }
    let flat = r#"<shape type="sphere"><transform name="to_world"><scale x="0"/></transform></shape>"#;
    fails_soon(&Program::with_ball(flat), "render ball.xml", 3, &["inverse", "ball.xml:21:"]);
}

#[test]
fn triangles_without_area_and_vertices_that_are_no_numbers() {
    let program = with_shape("ply", "mesh.ply");
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    program.write("mesh.ply", &format!("{header}0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"));
    program.ok("render ball.xml --spp 1");
    program.write("mesh.ply", &format!("{header}0 0 0\n1 0 0\nnan 0 0\n3 0 1 2\n"));
    fails_soon(&program, "render ball.xml", 3, &["1 vertices", "ball.xml:21:"]);
    program.write("mesh.ply", &format!("{header}0 0 0\n1 0 0\n2 0 0\n3 0 1 7\n"));
    fails_soon(&program, "render ball.xml", 3, &["index 7", "mesh.ply", "ball.xml:21:"]);
}
