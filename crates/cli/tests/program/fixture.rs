//! Runs the program in a folder of its own.

use std::path::Path;
use std::process::{Command, Output};

/// A temporary folder and the program, which is run in it.
pub(crate) struct Program {
    pub(crate) folder: tempfile::TempDir,
}

/// What the program said and how it ended.
pub(crate) struct Outcome {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

/// A ball under a lit sky, small enough for tests; `{}` is replaced by further elements.
pub(crate) const BALL: &str = r#"<scene version="3.0.0">
    <default name="radius" value="1"/>
    <integrator type="path"/>
    <sensor type="perspective">
        <transform name="to_world">
            <lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/>
        </transform>
        <sampler type="independent">
            <integer name="sample_count" value="4"/>
        </sampler>
        <film type="hdrfilm">
            <integer name="width" value="40"/>
            <integer name="height" value="30"/>
        </film>
    </sensor>
    <shape type="sphere">
        <float name="radius" value="$radius"/>
        <bsdf type="diffuse"/>
    </shape>
    <emitter type="constant"/>
    {}
</scene>
"#;

impl Program {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A program beside the file `ball.xml`, with further elements in it.
    pub(crate) fn with_ball(elements: &str) -> Self {
        let program = Self::new();
        program.write("ball.xml", &BALL.replace("{}", elements));
        program
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path().join(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path().join(name)).unwrap()
    }

    pub(crate) fn command(&self, args: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_aureole"));
        command.current_dir(self.path()).args(args.split_whitespace());
        command
    }

    pub(crate) fn run(&self, args: &str) -> Outcome {
        self.command(args).output().unwrap().into()
    }

    /// Runs the program, which must succeed.
    pub(crate) fn ok(&self, args: &str) -> Outcome {
        let outcome = self.run(args);
        assert_eq!(outcome.code, Some(0), "{args}: {}", outcome.stderr);
        outcome
    }

    /// Runs the program, which must end with a code and say certain words.
    pub(crate) fn fails(&self, args: &str, code: i32, words: &[&str]) {
        let outcome = self.run(args);
        assert_eq!(outcome.code, Some(code), "{args}: {}", outcome.stderr);
        for word in words {
            assert!(outcome.stderr.contains(word), "{args}: no `{word}` in\n{}", outcome.stderr);
        }
        assert!(outcome.stdout.is_empty(), "{args}");
    }
}

impl From<Output> for Outcome {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: output.stdout,
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

impl Outcome {
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).unwrap()
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8(self.stdout.clone()).unwrap()
    }
}
