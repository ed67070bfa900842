//! Shapes that shine in groups: each instance is a light of its own.

use aureole_desc::{Family, Instance, Node, Params, Report, SceneDesc, Span, Value};
use aureole_math::{Pcg32, Point3, Ray, Transform, Vector3};
use aureole_scene::{CompileOptions, Scene, compile};
use aureole_spectrum::Wavelengths;

/// A dark ball and a shining one in a group, placed twice: moved, and mirrored and stretched; once by a node and once by an
/// instance that takes less room.
fn scene() -> Scene {
    let mut desc = SceneDesc::default();
    let mut add =
        |family: Family, kind: &str, params: Params| desc.add(Node::new(family, kind, params, Span::NONE));
    let light = add(Family::Light, "area", Params::new().with("radiance", Value::Float(3.0)));
    let ball =
        |y: f64| Params::new().with("radius", Value::Float(0.5)).with("center", Value::Vec3([0.0, y, 0.0]));
    let dark = add(Family::Shape, "sphere", ball(-2.0));
    let bright = add(Family::Shape, "sphere", ball(0.0).with("emission", Value::Node(light)));
    let group = add(Family::Shape, "group", Params::new().with("shapes", Value::Nodes(vec![dark, bright])));
    let right = Transform::translate(Vector3::new(2.0, 0.0, 0.0));
    let left =
        Transform::translate(Vector3::new(-2.0, 0.0, 0.0)) * Transform::scale(Vector3::new(-1.0, 2.0, 0.5));
    let params =
        Params::new().with("group", Value::Node(group)).with("world_from_object", Value::Transform(right));
    let node = add(Family::Shape, "instance", params);
    desc.shapes.push(node);
    desc.instances.extend(Instance::new(group, &left, Span::NONE));
    let mut report = Report::default();
    let scene = compile(&desc, &CompileOptions::default(), &mut report).expect("is sound");
    assert!(report.warnings.iter().all(|warning| warning.message.contains("camera")), "{report:?}");
    scene
}

#[test]
fn each_instance_is_a_light() {
    let scene = scene();
    assert_eq!(scene.counts().lights, 2);
    let seen = |x: f32, y: f32| {
        let ray = Ray::new(Point3::new(x, y, 5.0), -Vector3::Z);
        let hit = scene.closest_hit(&ray).expect("something is there");
        let at = scene.interaction(&ray, &hit);
        assert_eq!(scene.elements(&hit).light, at.light);
        (at.light, scene.emitted(&at, Vector3::Z, Wavelengths::RGB).rgb()[0])
    };
    let [(right, a), (left, b)] = [seen(2.0, 0.0), seen(-2.0, 0.0)];
    assert!(right.is_some() && left.is_some() && right != left);
    assert_eq!([a, b], [3.0, 3.0]);
    assert_eq!(seen(2.0, -2.0), (None, 0.0));
    // Power goes with area: the picker prefers the larger of the two.
    let pmf = [right, left].map(|light| scene.picker.pmf(light.expect("was asserted")));
    assert!(pmf[1] > pmf[0] && (pmf[0] + pmf[1] - 1.0).abs() < 1e-6, "{pmf:?}");
}

/// What is drawn towards a light in an instance is found there by a ray, with the same density.
#[test]
fn draws_and_rays_agree() {
    let scene = scene();
    let context = scene.light_context(Wavelengths::RGB);
    let mut rng = Pcg32::new(1);
    let reference = Point3::new(0.3, 1.5, 2.0);
    for (id, light) in scene.lights.iter() {
        let mut tested = 0;
        for _ in 0..500 {
            let Some(drawn) = light.sample(&context, reference, rng.point2()) else { continue };
            let ray = Ray::new(reference, drawn.wi);
            let Some(hit) = scene.closest_hit(&ray) else { continue };
            let at = scene.interaction(&ray, &hit);
            // Near the silhouette rounding decides.
            if at.light != Some(id) || at.surface.ng.abs_dot(drawn.wi) < 0.2 {
                continue;
            }
            tested += 1;
            let pdf = light.pdf_omega(&context, reference, drawn.wi, Some(&at.surface));
            assert!((pdf / drawn.pdf_omega - 1.0).abs() < 1e-2, "{pdf} {drawn:?}");
        }
        assert!(tested > 200, "{tested}");
    }
}
