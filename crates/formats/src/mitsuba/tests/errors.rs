use aureole_desc::SceneError;

use super::read_with;
use crate::LoadOptions;

/// The messages of a wrong scene, each with its line and column.
fn errors(text: &str) -> Vec<String> {
    let outcome = read_with(text, &LoadOptions::default());
    let first = outcome.result.unwrap_err();
    let describe =
        |error: &SceneError| match outcome.sources.locate(error.span()).and_then(|place| place.line_column) {
            Some((line, column)) => format!("{line}:{column}: {error}"),
            None => error.to_string(),
        };
    std::iter::once(&first).chain(&outcome.report.errors).map(describe).collect()
}

fn error(text: &str) -> String {
    let mut all = errors(text);
    assert_eq!(all.len(), 1, "{all:?}");
    all.remove(0)
}

#[test]
fn wrong_xml() {
    assert_eq!(
        error("<scene version=\"3.0.0\">\n <shape type=\"cube\">\n</scene>"),
        "3:1: `</scene>` closes `<shape>`: one of the two is missing its partner"
    );
    assert_eq!(
        error("<scene version=\"3.0.0\">\n <shape"),
        "2:8: the file ends before all elements are closed"
    );
    assert_eq!(error("<shape type=\"cube\"/>"), "1:1: a scene starts with <scene>, not with <shape>");
    assert_eq!(error(""), "1:1: no element in the file: a scene starts with <scene version=\"3.0.0\">");
    assert_eq!(
        error("<!DOCTYPE s [<!ENTITY a \"aaaaaaaaaa\">]>\n<scene>&a;</scene>"),
        "2:8: text between elements has no meaning here"
    );
    assert_eq!(error("<scene>\n  words\n</scene>"), "1:8: text between elements has no meaning here");
}

#[test]
fn wrong_names() {
    let scene = |inside: &str| error(&format!("<scene version=\"3.0.0\">\n{inside}\n</scene>"));
    assert_eq!(scene("<shape type=\"spere\"/>"), "2:1: unknown shape `spere`");
    assert_eq!(
        scene("<shape type=\"sphere\"><bsdf type=\"difuse\"/></shape>"),
        "2:22: unknown bsdf `difuse`"
    );
    assert_eq!(scene("<shap type=\"sphere\"/>"), "2:1: unknown element `shap`");
    assert_eq!(scene("<shape type=\"cube\"><ref id=\"white\"/></shape>"), "2:20: unknown id `white`");
    assert_eq!(scene("<shape type=\"$what\"/>"), "2:14: unknown parameter `$what`");
    assert_eq!(
        scene("<bsdf id=\"a\" type=\"null\"/>\n<bsdf id=\"a\" type=\"null\"/>"),
        "3:11: the id `a` is taken: it is at scene.xml:2:1 already"
    );
    assert_eq!(
        scene("<shape type=\"cube\"><float nam=\"a\" value=\"1\"/></shape>"),
        "2:32: unknown attribute `nam`"
    );
    assert_eq!(scene("<shape/>"), "2:1: <shape> needs `type`: this attribute must be there");
}

#[test]
fn unknown_kinds_come_with_the_known_ones() {
    let outcome =
        read_with("<scene version=\"3.0.0\"><shape type=\"spere\"/></scene>", &LoadOptions::default());
    assert_eq!(outcome.result.unwrap_err().help().as_deref(), Some("did you mean `sphere`?"));
}

#[test]
fn wrong_values() {
    let shape = |inside: &str| {
        error(&format!("<scene version=\"3.0.0\"><shape type=\"disk\">\n{inside}</shape></scene>"))
    };
    assert_eq!(shape("<float name=\"a\" value=\"big\"/>"), "2:24: `a` must be a finite number, found `big`");
    assert_eq!(shape("<float name=\"a\" value=\"nan\"/>"), "2:24: `a` must be a finite number, found `nan`");
    assert_eq!(shape("<integer name=\"a\" value=\"1.5\"/>"), "2:26: `a` must be an integer, found `1.5`");
    assert_eq!(
        shape("<boolean name=\"a\" value=\"yes\"/>"),
        "2:26: `a` must be `true` or `false`, found `yes`"
    );
    assert_eq!(shape("<point name=\"a\" value=\"1, 2\"/>"), "2:24: `a` must be three numbers, found `1, 2`");
    assert_eq!(
        shape("<rgb name=\"a\" value=\"#12345\"/>"),
        "2:22: `a` must be six hexadecimal digits, found `#12345`"
    );
    assert!(shape("<spectrum name=\"a\" value=\"700:1, 400:2\"/>").contains("ascending"));
    assert_eq!(
        shape("<transform name=\"to_world\"><scale x=\"0\"/></transform>"),
        "2:28: a scale by zero has no inverse"
    );
    assert_eq!(
        shape("<transform name=\"to_world\"><rotate angle=\"3\"/></transform>"),
        "2:28: a rotation needs an axis: x, y or z"
    );
    assert_eq!(
        shape(
            "<transform name=\"to_world\"><lookat origin=\"0,0,0\" target=\"0,1,0\" up=\"0,1,0\"/></transform>"
        ),
        "2:28: origin, target and up lie on one line"
    );
    assert_eq!(shape("<transform name=\"to_world\"><turn/></transform>"), "2:28: unknown transform `turn`");
}

#[test]
fn missing_and_misplaced_parts() {
    let scene = |inside: &str| error(&format!("<scene version=\"3.0.0\">{inside}</scene>"));
    assert!(scene("<shape type=\"disk\"><bsdf type=\"mask\"/></shape>").contains("bsdf `mask` needs `bsdf`"));
    assert!(scene("<shape type=\"ply\"/>").contains("shape `ply` needs `filename`"));
    assert!(scene("<sensor type=\"thinlens\"/>").contains("needs `aperture_radius`"));
    assert!(scene("<shape type=\"instance\"/>").contains("needs `shapegroup`"));
    assert!(scene("<scene/>").contains("a scene inside of a scene"));
    assert!(
        scene("<shape type=\"disk\"><bsdf id=\"a\" type=\"twosided\"><ref id=\"a\"/></bsdf></shape>")
            .contains("`a` contains itself")
    );
    assert!(
        scene("<integrator type=\"moment\" id=\"m\"><ref id=\"m\"/></integrator>")
            .contains("`moment` inside of `moment`")
    );
    assert!(scene("<shape type=\"merge\" id=\"m\"><ref id=\"m\"/></shape>").contains("contains itself"));
}

#[test]
fn several_errors_at_once() {
    let text =
        "<scene version=\"3.0.0\">\n<shape type=\"a\"/>\n<shape type=\"b\"/>\n<emitter type=\"c\"/></scene>";
    assert_eq!(errors(text), ["2:1: unknown shape `a`", "3:1: unknown shape `b`", "4:1: unknown light `c`"]);
}

#[test]
fn depth_is_limited() {
    let nested = |n: usize| {
        format!(
            "<scene version=\"3.0.0\">{}{}</scene>",
            "<shape type=\"merge\">".repeat(n),
            "</shape>".repeat(n)
        )
    };
    assert!(error(&nested(300)).contains("nesting of objects is beyond the limit: 257 > 256"));
    assert!(error(&nested(50_000)).contains("beyond the limit"));
    // Chains of references count as nesting too.
    let chain: String = (0..1000)
        .map(|i| format!("<bsdf type=\"twosided\" id=\"b{i}\"><ref id=\"b{}\"/></bsdf>", i + 1))
        .collect();
    let text = format!(
        "<scene version=\"3.0.0\">{chain}<bsdf type=\"null\" id=\"b1000\"/><shape type=\"cube\"><ref id=\"b0\"/></shape></scene>"
    );
    assert!(error(&text).contains("beyond the limit"));
}

#[test]
fn what_has_no_use_is_said() {
    let (_, warnings) = super::read(
        "<shape type=\"disk\"><texture type=\"checkerboard\"/><float name=\"a\" value=\"1\"/><float name=\"a\" value=\"2\"/></shape>",
    );
    assert_eq!(
        warnings,
        ["`a` is given twice: the last one counts", "<texture> inside of shape `disk` is ignored"]
    );
}

#[test]
fn broken_scenes_never_panic() {
    let whole = include_str!("../../gallery/materials.xml");
    let mut rng = aureole_math::Pcg32::new(4);
    for _ in 0..3000 {
        let mut bytes = whole.as_bytes().to_vec();
        for _ in 0..1 + rng.next_u32() % 3 {
            let i = rng.next_u32() as usize % bytes.len();
            bytes[i] ^= 1 << (rng.next_u32() % 7);
        }
        let outcome = read_with(&String::from_utf8_lossy(&bytes), &LoadOptions::default());
        if let Err(error) = outcome.result {
            outcome.sources.locate(error.span());
        }
    }
}
