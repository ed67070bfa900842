//! Instances that move: rays see them where they are at the rays' times.

use aureole_desc::{Family, Node, Params, Report, SceneDesc, SceneError, Span, Value};
use aureole_math::{Point3, Ray, Transform, Vector3};
use aureole_scene::{CompileOptions, Scene, compile};

/// A ball that moves from where it is at first.
fn scene(end: Transform, report: &mut Report) -> Result<Scene, SceneError> {
    let mut desc = SceneDesc::default();
    let mut add =
        |family: Family, kind: &str, params: Params| desc.add(Node::new(family, kind, params, Span::NONE));
    let light = add(Family::Light, "area", Params::new());
    let ball = Params::new().with("radius", Value::Float(0.5)).with("emission", Value::Node(light));
    let ball = add(Family::Shape, "sphere", ball);
    let group = add(Family::Shape, "group", Params::new().with("shapes", Value::Nodes(vec![ball])));
    let params =
        Params::new().with("group", Value::Node(group)).with("world_from_object_end", Value::Transform(end));
    let instance = add(Family::Shape, "instance", params);
    desc.shapes.push(instance);
    compile(&desc, &CompileOptions::default(), report)
}

#[test]
fn rays_see_things_where_they_are() {
    let mut report = Report::default();
    let scene = scene(Transform::translate(Vector3::new(4.0, 0.0, 0.0)), &mut report).expect("is sound");
    for (time, x) in [(0.0, 0.0), (0.25, 1.0), (0.5, 2.0), (1.0, 4.0)] {
        for place in [0.0, 1.0, 2.0, 4.0_f32] {
            let ray = Ray { time, ..Ray::new(Point3::new(place + 0.3, 0.0, 3.0), -Vector3::Z) };
            let hit = scene.closest_hit(&ray);
            assert_eq!(hit.is_some(), place == x, "{time} {place}");
            assert_eq!(scene.occluded(&ray), place == x);
            if let Some(hit) = hit {
                let at = scene.interaction(&ray, &hit);
                assert!((at.surface.p - Point3::new(place + 0.3, 0.0, 0.4)).length() < 1e-4, "{at:?}");
                assert!((at.surface.ng - Vector3::new(0.6, 0.0, 0.8)).length() < 1e-4, "{at:?}");
                assert_eq!((at.light, scene.elements(&hit).light), (None, None));
            }
        }
    }
}

/// What moves is no lamp, which is said; what ends where it begins is as ever; nothing turns inside out on its way.
#[test]
fn what_moves_is_dark() {
    let says = |report: &Report, words: &str| report.warnings.iter().any(|w| w.message.contains(words));
    let mut report = Report::default();
    let still = scene(Transform::IDENTITY, &mut report).expect("is sound");
    assert!(still.counts().lights == 1 && !says(&report, "moves"));
    let moving = scene(Transform::translate(Vector3::X), &mut report).expect("is sound");
    assert!(moving.counts().lights == 0 && says(&report, "what moves does not shine"), "{report:?}");
    let mirror = Transform::scale(Vector3::new(-1.0, 1.0, 1.0));
    let error = scene(mirror, &mut Report::default()).expect_err("it would be flat on its way");
    assert!(error.to_string().contains("mirroring"), "{error}");
}
