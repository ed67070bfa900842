//! Cameras: rays go where films and lenses say.

use aureole_desc::{Family, Node, Params, Span, Value};
use aureole_elements::Camera;
use aureole_elements::camera::{CameraRay, CameraSample};
use aureole_math::{Pcg32, Point2, Point3, Ray, Transform, Vector3, warp};
use aureole_testkit::{Chi2Config, chi2_sphere};

use crate::world::{World, params, word};

use Value::Float;

/// The world's film is twice as wide as high.
const FILM: [f32; 2] = [256.0, 128.0];

fn camera(kind: &str, params: Params) -> Camera {
    let node = Node::new(Family::Camera, kind, params, Span::NONE);
    Camera::build(&node, &mut World::default()).unwrap_or_else(|error| panic!("{kind}: {error}"))
}

/// The ray through a place on the film, in fractions of its size from the top left.
fn ray(camera: &Camera, x: f32, y: f32, lens: Point2) -> Ray {
    camera.generate_ray(&CameraSample { film: Point2::new(x * FILM[0], y * FILM[1]), lens, time: 0.0 }).ray
}

const CENTER: Point2 = Point2 { x: 0.5, y: 0.5 };

fn place() -> (&'static str, Value) {
    let from = Point3::new(0.5, 1.0, -2.0);
    let view = Transform::look_at(from, Point3::new(0.1, 0.2, 0.3), Vector3::new(0.1, 1.0, 0.0));
    ("world_from_camera", Value::Transform(view.expect("not along the up vector")))
}

/// Two cameras at the same place.
fn batch(kinds: [&str; 2]) -> Camera {
    let mut world = World::default();
    let cameras = kinds.map(|kind| match world.add(Family::Camera, kind, [place()]) {
        Value::Node(id) => id,
        other => panic!("not a node: {other:?}"),
    });
    let node =
        Node::new(Family::Camera, "batch", params([("cameras", Value::Nodes(cameras.into()))]), Span::NONE);
    Camera::build(&node, &mut world).expect("two cameras")
}

/// A meter on a square in the plane z = 0.
fn irradiance_meter() -> Camera {
    let mut world = World::default();
    let id = world.shape("rectangle", params([]));
    world.measured = Some(world.shapes[id].clone());
    let node = Node::new(Family::Camera, "irradiance_meter", params([]), Span::NONE);
    Camera::build(&node, &mut world).expect("a shape of known area")
}

#[test]
fn a_batch_shows_its_cameras_side_by_side() {
    let both = batch(["perspective", "orthographic"]);
    let lens = Point2::new(0.3, 0.8);
    for (x, kind) in [(0.0, "perspective"), (0.5, "orthographic")] {
        let mut world = World::half_as_wide();
        let node = Node::new(Family::Camera, kind, params([place()]), Span::NONE);
        let alone = Camera::build(&node, &mut world).expect("is sound");
        let film = Point2::new(0.2 * 128.0, 0.7 * 128.0);
        let expected = alone.generate_ray(&CameraSample { film, lens, time: 0.0 }).ray;
        let found = ray(&both, x + 0.1, 0.7, lens);
        assert!((found.direction - expected.direction).length() < 1e-5, "{kind}");
        assert!((found.origin - expected.origin).length() < 1e-4, "{kind}");
    }
}

/// Its pixels are parts of the shape, and directions are drawn by cosine.
#[test]
fn a_meter_looks_out_of_its_shape() {
    let meter = irradiance_meter();
    assert!((meter.gain() - std::f32::consts::PI).abs() < 1e-6);
    let mut rng = Pcg32::new(4);
    let mut sum = 0.0;
    for _ in 0..10_000 {
        let [x, y] = [rng.next_f32(), rng.next_f32()];
        let r = ray(&meter, x, y, rng.point2());
        let at = Vector3::new(2.0 * x - 1.0, 2.0 * y - 1.0, 0.0);
        assert!((r.origin - Point3::ORIGIN - at).length() < 1e-4, "{r:?}");
        assert!(r.direction.z > 0.0);
        sum += r.direction.z / 10_000.0;
    }
    // The mean cosine of directions drawn by cosine.
    assert!((sum - 2.0 / 3.0).abs() < 0.015, "{sum}");
}

#[test]
fn every_kind_makes_unit_rays() {
    let mut rng = Pcg32::new(1);
    for kind in Camera::KINDS {
        let camera = match *kind {
            "batch" => batch(["perspective", "orthographic"]),
            "irradiance_meter" => irradiance_meter(),
            "realistic" => crate::realistic::camera(8.0, &[place()]),
            _ => camera(kind, params([place()])),
        };
        for _ in 0..1000 {
            let film = Point2::new(rng.next_f32() * FILM[0], rng.next_f32() * FILM[1]);
            let sample = CameraSample { film, lens: rng.point2(), time: 0.0 };
            let CameraRay { ray: r, weight } = camera.generate_ray(&sample);
            assert!((r.direction.length() - 1.0).abs() < 1e-5, "{kind}: {r:?}");
            assert!(r.origin.is_finite() && r.t_min >= 0.0, "{kind}: {r:?}");
            // What a lens stops meets nothing.
            assert!((r.t_max > r.t_min) == (weight > 0.0), "{kind}: {r:?} {weight}");
        }
    }
}

#[test]
fn opposite_borders_are_the_field_of_view_apart() {
    let angle = |camera: &Camera, [a, b]: [[f32; 2]; 2]| {
        let [a, b] = [a, b].map(|[x, y]| ray(camera, x, y, CENTER).direction);
        a.dot(b).clamp(-1.0, 1.0).acos().to_degrees()
    };
    let horizontal = [[0.0, 0.5], [1.0, 0.5]];
    let vertical = [[0.5, 0.0], [0.5, 1.0]];
    let diagonal = [[0.0, 0.0], [1.0, 1.0]];
    let cases = [
        ("x", horizontal),
        ("larger", horizontal),
        ("y", vertical),
        ("smaller", vertical),
        ("diagonal", diagonal),
    ];
    for (axis, borders) in cases {
        let camera = camera("perspective", params([place(), ("fov", Float(50.0)), ("fov_axis", word(axis))]));
        assert!((angle(&camera, borders) - 50.0).abs() < 1e-2, "{axis}");
    }
}

/// The image's right is −X of camera space, its top +Y.
#[test]
fn images_are_upright() {
    for kind in ["perspective", "orthographic"] {
        let camera = camera(kind, params([]));
        let seen = |x, y| ray(&camera, x, y, CENTER).at(5.0);
        assert!(seen(0.9, 0.5).x < -0.1 && seen(0.1, 0.5).x > 0.1, "{kind}");
        assert!(seen(0.5, 0.1).y > 0.1 && seen(0.5, 0.9).y < -0.1, "{kind}");
    }
}

#[test]
fn a_lens_gathers_in_the_plane_of_focus() {
    for kind in ["perspective", "orthographic"] {
        let lens = [("aperture_radius", Float(0.2)), ("focus_distance", Float(3.0))];
        let camera = camera(kind, params(lens));
        let mut rng = Pcg32::new(2);
        let at_focus = |r: Ray| r.origin + r.direction * ((3.0 - r.origin.z) / r.direction.z);
        let expected = at_focus(ray(&camera, 0.3, 0.6, CENTER));
        let mut widest = 0.0_f32;
        for _ in 0..500 {
            let r = ray(&camera, 0.3, 0.6, rng.point2());
            assert!((at_focus(r) - expected).length() < 1e-4, "{kind}: {r:?}");
            widest = widest.max((r.origin - ray(&camera, 0.3, 0.6, CENTER).origin).length());
        }
        assert!((0.19..0.2001).contains(&widest), "{kind}: {widest}");
    }
}

/// Directions of Mitsuba 3.9 through the film at (0.02586013, 0.9354395), with its principal point moved by (0.1, -0.2).
#[test]
fn the_principal_point_moves_as_in_mitsuba() {
    let shift = [("principal_point_x", Float(0.1)), ("principal_point_y", Float(-0.2))];
    let [a, b] = shift;
    let camera = camera("perspective", params([place(), ("fov", Float(50.0)), a, b]));
    let expected = Vector3::new(0.165_874_9, -0.433_752_86, 0.885_631_9);
    let found = ray(&camera, 0.025_860_13, 0.935_439_5, CENTER).direction;
    assert!((found - expected).length() < 1e-4, "{found:?}");
}

/// A film drawn evenly by solid angle covers the sphere evenly. False alarm: one in a hundred seeds.
#[test]
fn spherical_cameras_see_everything() {
    for (mapping, is_equal_area) in [("latlong", false), ("equal_area", true)] {
        let camera = camera("spherical", params([place(), ("mapping", word(mapping))]));
        let config = Chi2Config { test_count: 2, ..Chi2Config::default() };
        let sample = |rng: &mut Pcg32| {
            let u = rng.point2();
            // Rows of a latitude picture are as long as the sine of their angle.
            let y = if is_equal_area { u.y } else { (1.0 - 2.0 * u.y).acos() / std::f32::consts::PI };
            Some(ray(&camera, u.x, y, CENTER).direction)
        };
        if let Err(error) = chi2_sphere(&config, sample, |_| warp::UNIFORM_SPHERE_PDF) {
            panic!("{mapping}: {error}");
        }
    }
}

/// A faraway sensor sees all of the scene's ball, or one point; a meter sees one direction.
#[test]
fn distant_rays_cover_the_scene() {
    let ball = [("scene_center", Value::Vec3([1.0, 2.0, 3.0])), ("scene_radius", Float(2.0))];
    let center = Point3::new(1.0, 2.0, 3.0);
    let [middle, radius] = ball;
    let all = camera("distant", params([middle.clone(), radius.clone(), place()]));
    let one = camera("distant", params([middle, radius, ("target", Value::Vec3([0.0, 0.0, 9.0]))]));
    let mut rng = Pcg32::new(1);
    let (mut nearest, mut farthest) = (f32::INFINITY, 0.0_f32);
    for _ in 0..1000 {
        let r = ray(&all, 0.5, 0.5, rng.point2());
        let to_center = center - r.origin;
        let aside = (to_center - r.direction * to_center.dot(r.direction)).length();
        assert!((to_center.dot(r.direction) - 2.0).abs() < 1e-4, "rays begin outside");
        (nearest, farthest) = (nearest.min(aside), farthest.max(aside));
        let r = ray(&one, 0.5, 0.5, rng.point2());
        let target = Point3::new(0.0, 0.0, 9.0);
        assert!((r.at((target - r.origin).length()) - target).length() < 1e-4);
        assert!((r.origin - center).length() >= 2.0);
    }
    assert!(nearest < 0.1 && farthest > 1.95 && farthest < 2.001, "{nearest} {farthest}");
}
