//! One sample again is the same sample; and what is broken is found, always the same one first.

use aureole_desc::{Report, Sources};
use aureole_formats::{LoadOptions, load_text};
use aureole_render::replay::{Event, replay};
use aureole_render::{RenderOptions, SampleId, Silent, render};
use aureole_scene::{CompileOptions, Scene, compile};

/// Balls of glass, metal and paint over a floor, below a lamp of some radiance.
fn scene(lamp: &str) -> Scene {
    let text = format!(
        r#"<scene version="3.0.0">
        <sensor type="perspective">
            <transform name="to_world"><lookat origin="0, 2, 6" target="0, 0.5, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm">
                <integer name="width" value="40"/><integer name="height" value="30"/><rfilter type="box"/>
            </film>
        </sensor>
        <shape type="rectangle">
            <transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/></transform>
        </shape>
        <shape type="sphere"><point name="center" x="-1.2" y="0.5" z="0"/><float name="radius" value="0.5"/>
            <bsdf type="dielectric"/></shape>
        <shape type="sphere"><point name="center" x="0" y="0.5" z="0"/><float name="radius" value="0.5"/>
            <bsdf type="roughconductor"/></shape>
        <shape type="sphere"><point name="center" x="1.2" y="0.5" z="0"/><float name="radius" value="0.5"/>
            <bsdf type="plastic"/></shape>
        <shape type="sphere" id="lamp"><point name="center" x="0" y="2" z="-1"/><float name="radius" value="0.4"/>
            <emitter type="area"><rgb name="radiance" value="{lamp}"/></emitter></shape>
        <emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
        </scene>"#
    );
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let desc = load_text("mitsuba", "a.xml", &text, &LoadOptions::default(), &mut sources, &mut report)
        .expect("the scene is well-formed");
    compile(&desc, &CompileOptions::default(), &mut report).expect("the scene can be built")
}

#[test]
fn a_sample_again_is_the_same_sample() {
    let scene = scene("5");
    for integrator in ["path", "direct", "whitted"] {
        let options = RenderOptions {
            spp: Some(1),
            seed: 7,
            integrator: Some(integrator.to_owned()),
            ..RenderOptions::default()
        };
        let rendered = render(&scene, &options, &Silent).expect("it renders");
        for (x, y) in (0..40).step_by(3).flat_map(|x| (0..30).step_by(4).map(move |y| (x, y))) {
            let again = replay(&scene, &options, SampleId { x, y, sample: 0 }).expect("it is in the image");
            let pixel = rendered.image.rgb(x as usize, y as usize);
            assert_eq!(again.radiance.rgb(), pixel, "{integrator}, pixel {x},{y}");
            assert!(again.culprit().is_none());
        }
    }
}

#[test]
fn paths_tell_what_they_meet() {
    let options = RenderOptions::default();
    let replay =
        replay(&scene("5"), &options, SampleId { x: 10, y: 16, sample: 0 }).expect("it is in the image");
    let count = |is: fn(&Event) -> bool| replay.events.iter().filter(|event| is(event)).count();
    assert!(matches!(replay.events[0], Event::Start { .. }));
    assert!(count(|event| matches!(event, Event::Vertex(_))) > 1, "{:?}", replay.events);
    let lights = count(|event| matches!(event, Event::Light { .. }));
    assert_eq!(lights, count(|event| matches!(event, Event::Shadow { .. })));
}

#[test]
fn the_first_broken_sample_is_the_same_for_any_number_of_threads() {
    let scene = scene("1e30");
    let first = |threads| {
        let options = RenderOptions { spp: Some(3), threads, ..RenderOptions::default() };
        let stats = render(&scene, &options, &Silent).expect("it renders").stats;
        assert!(stats.non_finite > 0 && stats.non_finite < stats.samples);
        stats.first_non_finite.expect("there are some")
    };
    let id = first(1);
    assert_eq!([id; 3], [first(2), first(3), first(8)]);

    let again = replay(&scene, &RenderOptions::default(), id).expect("it is in the image");
    let (index, _) = again.culprit().expect("something is too bright");
    assert!(matches!(again.events[index], Event::Found { .. } | Event::Light { .. }), "{:?}", again.events);
}
