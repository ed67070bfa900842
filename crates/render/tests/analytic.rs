//! Scenes whose radiance is known in closed form, through every integrator that can solve them and every sampler.
//!
//! Every comparison allows five standard errors or one part in ten thousand: fewer than one false alarm in a million runs,
//! and the seeds are fixed.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use aureole_desc::{Family, Node, Params, Report, SceneDesc, Span, Value};
use aureole_math::{Point3, Transform, Vector3};
use aureole_render::{RenderOptions, Silent, render};
use aureole_scene::{CompileOptions, compile};

struct Builder(SceneDesc);

impl Builder {
    fn new() -> Self {
        let mut desc = SceneDesc::default();
        desc.set("film.width", "8").unwrap();
        desc.set("film.height", "8").unwrap();
        Self(desc)
    }

    fn node(&mut self, family: Family, kind: &str, params: Params) -> Value {
        Value::Node(self.0.add(Node::new(family, kind, params, Span::NONE)))
    }

    fn diffuse(&mut self, albedo: f64) -> Value {
        self.node(Family::Bsdf, "diffuse", Params::new().with("reflectance", Value::Float(albedo)))
    }

    fn shape(&mut self, kind: &str, params: Params) {
        let id = self.0.add(Node::new(Family::Shape, kind, params, Span::NONE));
        self.0.shapes.push(id);
    }

    fn light(&mut self, kind: &str, params: Params) {
        let id = self.0.add(Node::new(Family::Light, kind, params, Span::NONE));
        self.0.lights.push(id);
    }

    /// A narrow view from a point to another.
    fn camera(&mut self, from: [f32; 3], to: [f32; 3], up: Vector3) {
        let place = Transform::look_at(Point3::from(from), Point3::from(to), up).unwrap();
        let params = Params::new()
            .with("world_from_camera", Value::Transform(place))
            .with("fov", Value::Float(0.5))
            .with("near_clip", Value::Float(1e-4));
        let id = self.0.add(Node::new(Family::Camera, "perspective", params, Span::NONE));
        self.0.cameras.push(id);
    }

    /// Renders with an integrator and every sampler, and compares the mean with the expectation.
    fn expect(mut self, integrator: &str, settings: &[(&str, &str)], expected: f64) {
        for (name, value) in settings {
            self.0.set(name, value).unwrap();
        }
        for sampler in ["independent", "stratified", "sobol"] {
            self.0.set("sampler.kind", sampler).unwrap();
            self.0.set("sampler.sample_count", "256").unwrap();
            let scene = compile(&self.0, &CompileOptions::default(), &mut Report::default()).unwrap();
            let options = RenderOptions {
                spp: Some(256),
                integrator: Some(integrator.into()),
                ..RenderOptions::default()
            };
            let rendered = render(&scene, &options, &Silent).unwrap();
            assert_eq!(rendered.stats.non_finite, 0);
            for channel in 0..3 {
                let values = rendered.image.data().iter().skip(channel).step_by(3);
                let values: Vec<f64> = values.map(|x| f64::from(*x)).collect();
                let n = values.len() as f64;
                let mean = values.iter().sum::<f64>() / n;
                let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
                let tolerance = 5.0 * (variance / n).sqrt() + 1e-4 * expected;
                // What is too noisy to be wrong proves nothing.
                assert!(tolerance <= 0.1 * expected, "{integrator} with {sampler}: {mean} (± {tolerance})");
                assert!(
                    (mean - expected).abs() <= tolerance,
                    "{integrator} with {sampler}: {mean} instead of {expected} (± {tolerance})"
                );
            }
        }
    }
}

/// A convex body in even surroundings reflects its albedo times their radiance.
fn ball_in_the_fog(albedo: f64, radiance: f64) -> Builder {
    let mut b = Builder::new();
    let white = b.diffuse(albedo);
    b.shape("sphere", Params::new().with("bsdf", white));
    b.light("constant", Params::new().with("radiance", Value::Float(radiance)));
    b.camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], Vector3::Y);
    b
}

#[test]
fn convex_bodies_in_even_surroundings() {
    for integrator in ["path", "direct", "whitted"] {
        ball_in_the_fog(0.6, 2.0).expect(integrator, &[], 1.2);
    }
}

/// A point light over a matte floor: albedo / π · intensity · cosine / distance².
#[test]
fn a_point_light_over_a_floor() {
    for integrator in ["path", "direct", "whitted"] {
        let mut b = Builder::new();
        let grey = b.diffuse(0.5);
        b.shape("rectangle", Params::new().with("bsdf", grey));
        let light =
            Params::new().with("position", Value::Vec3([0.0, 0.0, 2.0])).with("intensity", Value::Float(3.0));
        b.light("point", light);
        b.camera([0.5, 0.0, 1.0], [0.0, 0.0, 0.0], Vector3::Z);
        b.expect(integrator, &[], 0.5 / std::f64::consts::PI * 3.0 / 4.0);
    }
}

/// A floor of a material under a point light of intensity 3, seen from its side.
fn floor(make: impl Fn(&mut Builder) -> Value, light: [f64; 3]) -> Builder {
    let mut b = Builder::new();
    let bsdf = make(&mut b);
    b.shape("rectangle", Params::new().with("bsdf", bsdf));
    let params = Params::new().with("position", Value::Vec3(light)).with("intensity", Value::Float(3.0));
    b.light("point", params);
    b.camera([0.5, 0.0, light[2].signum() as f32], [0.0, 0.0, 0.0], Vector3::Z);
    b
}

/// What is not there neither hides the light nor ends a segment; half of it takes half the light; and where that is asked for,
/// it is a surface like all others.
#[test]
fn light_samples_pass_what_is_not_there() {
    let lit = 0.5 / std::f64::consts::PI * 3.0 / 4.0;
    for (opacity, see_through, expected) in
        [(0.0, "true", lit), (0.25, "true", 0.75 * 0.75 * lit), (1.0, "true", 0.0), (0.0, "false", 0.0)]
    {
        let mut b = floor(|b| b.diffuse(0.5), [0.0, 0.0, 2.0]);
        let black = b.diffuse(0.0);
        let mask = Params::new().with("opacity", Value::Float(opacity)).with("bsdf", black);
        let mask = b.node(Family::Bsdf, "mask", mask);
        // The camera is outside of it, the light too.
        let place = Value::Transform(Transform::translate(Vector3::new(0.0, 0.0, 0.2)));
        b.shape("rectangle", Params::new().with("bsdf", mask).with("world_from_object", place));
        let settings = [("integrator.max_depth", "2"), ("integrator.see_through", see_through)];
        b.expect("path", &settings, expected);
    }
}

/// A matte floor scatters what a mirror would reflect: all of it.
#[test]
fn a_mirror_can_be_made_matte() {
    let mirror = |b: &mut Builder| {
        b.node(Family::Bsdf, "conductor", Params::new().with("material", Value::String("none".into())))
    };
    let b = floor(mirror, [0.0, 0.0, 2.0]);
    let settings = [("integrator.max_depth", "2"), ("integrator.force_diffuse", "true")];
    b.expect("path", &settings, 3.0 / 4.0 / std::f64::consts::PI);
}

/// A slope of height / 2 along X turns the normal; from behind it is the same surface, not its mirror image.
#[test]
fn bumps_are_the_same_surface_from_behind() {
    for z in [1.0, -1.0] {
        let bumpy = |b: &mut Builder| {
            let slope = Params::new()
                .with("v00", Value::Float(0.0))
                .with("v01", Value::Float(0.0))
                .with("v10", Value::Float(1.0))
                .with("v11", Value::Float(1.0));
            let slope = b.node(Family::Texture, "bilerp", slope);
            let grey = b.diffuse(0.5);
            let both = b.node(Family::Bsdf, "two_sided", Params::new().with("bsdf", grey));
            let bump = Params::new()
                .with("bsdf", both)
                .with("texture", slope)
                .with("tangents", Value::String("displaced".into()))
                .with("keep_sides", Value::Bool(false))
                .with("flip_invalid_normals", Value::Bool(false))
                .with("soften_terminator", Value::Bool(false));
            b.node(Family::Bsdf, "bump", bump)
        };
        let b = floor(bumpy, [1.0, 0.0, z]);
        let cos = (1.0 - 0.5 * z) / (1.25_f64.sqrt() * 2.0_f64.sqrt());
        b.expect("path", &[("integrator.max_depth", "2")], 0.5 / std::f64::consts::PI * 3.0 / 2.0 * cos);
    }
}

/// The middle below a parallel disk of radius R at height h receives E = π L R² / (R² + h²).
#[test]
fn a_disk_light_over_a_floor() {
    for (integrator, settings) in [
        ("path", vec![("integrator.max_depth", "2")]),
        ("direct", vec![]),
        ("direct", vec![("integrator.bsdf_samples", "0")]),
        ("direct", vec![("integrator.emitter_samples", "0"), ("integrator.bsdf_samples", "2")]),
        ("whitted", vec![]),
    ] {
        let mut b = Builder::new();
        let grey = b.diffuse(0.5);
        b.shape("rectangle", Params::new().with("bsdf", grey));
        let emission = b.node(Family::Light, "area", Params::new().with("radiance", Value::Float(4.0)));
        let down = Transform::translate(Vector3::new(0.0, 0.0, 2.0)) * Transform::rotate(Vector3::X, 180.0);
        b.shape(
            "disk",
            Params::new().with("world_from_object", Value::Transform(down)).with("emission", emission),
        );
        b.camera([0.5, 0.0, 0.7], [0.0, 0.0, 0.0], Vector3::Z);
        b.expect(integrator, &settings, 0.5 * 4.0 / (1.0 + 4.0));
    }
}

/// The same disk with a point light of a fiftieth of its power and an even sky, part of which the disk hides: whatever the
/// chance by which lights are chosen, all are counted once.
#[test]
fn lights_of_unequal_power_over_a_floor() {
    use std::f64::consts::PI;
    for (integrator, settings) in [
        ("path", vec![("integrator.max_depth", "2")]),
        ("direct", vec![]),
        ("direct", vec![("integrator.bsdf_samples", "0")]),
        ("whitted", vec![]),
    ] {
        let mut b = Builder::new();
        let grey = b.diffuse(0.5);
        b.shape("rectangle", Params::new().with("bsdf", grey));
        let (disk, sky) = (4.0, 0.3);
        let emission = b.node(Family::Light, "area", Params::new().with("radiance", Value::Float(disk)));
        let down = Transform::translate(Vector3::new(0.0, 0.0, 2.0)) * Transform::rotate(Vector3::X, 180.0);
        b.shape(
            "disk",
            Params::new().with("world_from_object", Value::Transform(down)).with("emission", emission),
        );
        // The disk sends out π² · 4 of power, a point 4 π times its intensity.
        let intensity = PI / 50.0;
        let point = Params::new()
            .with("position", Value::Vec3([-1.0, 0.0, 1.0]))
            .with("intensity", Value::Float(intensity));
        b.light("point", point);
        b.light("constant", Params::new().with("radiance", Value::Float(sky)));
        b.camera([0.5, 0.0, 0.7], [0.0, 0.0, 0.0], Vector3::Z);
        let seen = 1.0 / (1.0 + 4.0);
        let irradiance = PI * (disk * seen + sky * (1.0 - seen)) + intensity / 2.0_f64.powf(1.5);
        b.expect(integrator, &settings, 0.5 / PI * irradiance);
    }
}

/// Half cut out it is half as bright by either strategy; wholly cut out it is not seen but shines.
#[test]
fn a_cut_out_light_over_a_floor() {
    for (alpha, samples, share) in
        [(0.5, ["1", "1"], 0.5), (0.5, ["2", "0"], 0.5), (0.5, ["0", "2"], 0.5), (0.0, ["1", "1"], 1.0)]
    {
        let mut b = Builder::new();
        let grey = b.diffuse(0.5);
        b.shape("rectangle", Params::new().with("bsdf", grey));
        let emission = b.node(Family::Light, "area", Params::new().with("radiance", Value::Float(4.0)));
        let down = Transform::translate(Vector3::new(0.0, 0.0, 2.0)) * Transform::rotate(Vector3::X, 180.0);
        let disk = Params::new()
            .with("world_from_object", Value::Transform(down))
            .with("alpha", Value::Float(alpha))
            .with("emission", emission);
        b.shape("disk", disk);
        b.camera([0.5, 0.0, 0.7], [0.0, 0.0, 0.0], Vector3::Z);
        let settings = [("integrator.emitter_samples", samples[0]), ("integrator.bsdf_samples", samples[1])];
        b.expect("direct", &settings, share * 0.5 * 4.0 / (1.0 + 4.0));
    }
}

#[test]
fn films_limit_their_samples() {
    for (gain, most, expected) in [("2", "0.5", 0.5), ("0.5", "1.5", 1.0)] {
        let mut b = Builder::new();
        b.light("constant", Params::new().with("radiance", Value::Float(2.0)));
        b.camera([0.0; 3], [0.0, 0.0, 1.0], Vector3::Y);
        b.expect("path", &[("film.gain", gain), ("film.max_component", most)], expected);
    }
    // Of white light, Z is the largest of X, Y and Z: 1.089 times the channels.
    let mut b = Builder::new();
    b.light("constant", Params::new().with("radiance", Value::Float(2.0)));
    b.camera([0.0; 3], [0.0, 0.0, 1.0], Vector3::Y);
    b.expect("path", &[("film.max_component", "0.5"), ("film.max_component_of", "xyz")], 0.5 / 1.08884);
}

/// A black square in even surroundings, on its way from a place to another.
fn moving_square([start, end]: [Transform; 2], shutter: [&str; 2]) -> Builder {
    let mut b = Builder::new();
    let black = b.diffuse(0.0);
    let square = Node::new(Family::Shape, "rectangle", Params::new().with("bsdf", black), Span::NONE);
    let square = b.0.add(square);
    let group = b.node(Family::Shape, "group", Params::new().with("shapes", Value::Nodes(vec![square])));
    let instance = Params::new()
        .with("group", group)
        .with("world_from_object", Value::Transform(start))
        .with("world_from_object_end", Value::Transform(end));
    b.shape("instance", instance);
    b.light("constant", Params::new().with("radiance", Value::Float(1.0)));
    b.camera([0.0, 0.0, 4.0], [0.0; 3], Vector3::Y);
    b.0.set("camera.shutter_open", shutter[0]).unwrap();
    b.0.set("camera.shutter_close", shutter[1]).unwrap();
    b
}

/// A square of edge 1 that goes from -1 to 3 covers the origin for a quarter of the way, from 1/8 to 3/8.
#[test]
fn a_square_that_moves_covers_its_share_of_time() {
    let at = |x: f32| {
        Transform::translate(Vector3::new(x, 0.0, 0.0)) * Transform::scale(Vector3::new(0.5, 0.5, 1.0))
    };
    for (shutter, covered) in [
        (["0", "1"], 0.25),
        (["0", "0.5"], 0.5),
        (["0.4", "0.5"], 0.0),
        (["-1", "0.25"], 0.1),
        (["2", "3"], 0.0),
    ] {
        for integrator in ["path", "direct", "whitted"] {
            moving_square([at(-1.0), at(3.0)], shutter).expect(integrator, &[], 1.0 - covered);
        }
    }
}

/// A bar that turns by a right angle covers a place as long as it passes by: the turn is even.
#[test]
fn a_bar_that_turns_covers_its_share_of_time() {
    let (half_width, distance) = (0.1_f64, 0.5_f64);
    let away = Vector3::new(-1.0, -1.0, 0.0) * (distance as f32 * 0.5_f32.sqrt());
    let bar = |angle: f64| {
        Transform::translate(away)
            * Transform::rotate(Vector3::Z, angle)
            * Transform::scale(Vector3::new(1.0, half_width as f32, 1.0))
    };
    let covered = 2.0 * (half_width / distance).asin().to_degrees() / 90.0;
    moving_square([bar(0.0), bar(90.0)], ["0", "1"]).expect("path", &[], 1.0 - covered);
}

/// A camera that passes a square sees what it sees of a square that passes it.
#[test]
fn a_camera_that_moves_passes_by() {
    for kind in ["perspective", "orthographic"] {
        let place = Transform::scale(Vector3::new(0.5, 0.5, 1.0));
        let mut b = moving_square([place, place], ["0", "1"]);
        let (from, to) = (Point3::new(1.0, 0.0, 4.0), Point3::new(1.0, 0.0, 0.0));
        // Narrow also where rays are parallel.
        let start = Transform::look_at(from, to, Vector3::Y).unwrap()
            * Transform::scale(Vector3::new(1e-3, 1e-3, 1.0));
        let end = Transform::translate(Vector3::new(-4.0, 0.0, 0.0)) * start;
        let camera = b.0.cameras[0];
        b.0[camera].kind = kind.into();
        for (name, place) in [("world_from_camera", start), ("world_from_camera_end", end)] {
            b.0[camera].params.push(name, Value::Transform(place), Span::NONE);
        }
        if kind == "orthographic" {
            b.0[camera].params.remove("fov");
        }
        b.expect("path", &[], 0.75);
    }
}

/// Shadow rays know the time: what passes before a lamp takes its share of light.
#[test]
fn a_shadow_that_moves_takes_its_share() {
    let at = |x: f32| {
        Transform::translate(Vector3::new(x, 0.0, 1.0)) * Transform::scale(Vector3::new(0.5, 0.5, 1.0))
    };
    for integrator in ["path", "direct", "whitted"] {
        let mut b = moving_square([at(-1.0), at(3.0)], ["0", "1"]);
        b.0.lights.clear();
        b.0.cameras.clear();
        let grey = b.diffuse(0.5);
        b.shape("rectangle", Params::new().with("bsdf", grey));
        let lamp =
            Params::new().with("position", Value::Vec3([0.0, 0.0, 2.0])).with("intensity", Value::Float(3.0));
        b.light("point", lamp);
        b.camera([0.5, 0.0, 0.5], [0.0; 3], Vector3::Z);
        b.0.set("camera.shutter_close", "1").unwrap();
        b.expect(integrator, &[], 0.75 * 0.5 / std::f64::consts::PI * 3.0 / 4.0);
    }
}

/// Inside a closed shining shell every direction sees E / (1 - albedo).
#[test]
fn inside_a_shining_shell() {
    for kind in ["sphere", "cube"] {
        let mut b = Builder::new();
        let grey = b.diffuse(0.5);
        let emission = b.node(Family::Light, "area", Params::new().with("radiance", Value::Float(1.0)));
        let inside_out = Params::new()
            .with("bsdf", grey)
            .with("emission", emission)
            .with("flip_normals", Value::Bool(true));
        b.shape(kind, inside_out);
        b.camera([0.2, 0.1, 0.0], [0.3, 0.2, 1.0], Vector3::Y);
        b.expect("path", &[], 2.0);
    }
}

/// The same, where the material shines by itself.
#[test]
fn inside_a_shell_that_glows() {
    let mut b = Builder::new();
    let glowing = [("base_color", 0.4), ("specular_weight", 0.0), ("emission_luminance", 1.2)];
    let glowing = glowing.map(|(name, value)| (name, Value::Float(value)));
    let params = glowing.into_iter().fold(Params::new(), |params, (name, value)| params.with(name, value));
    let glowing = b.node(Family::Bsdf, "open_pbr", params);
    b.shape("sphere", Params::new().with("bsdf", glowing).with("flip_normals", Value::Bool(true)));
    b.camera([0.2, 0.1, 0.0], [0.3, 0.2, 1.0], Vector3::Y);
    b.expect("path", &[], 2.0);
}

/// Light that is seen straight through a surface is seen directly: it is hidden with the lights that are. What is seen in
/// glass is not.
#[test]
fn lights_are_hidden_behind_what_changes_nothing() {
    for (kind, expected) in [("null", 0.0), ("dielectric", 1.0)] {
        let mut b = Builder::new();
        let bsdf = b.node(Family::Bsdf, kind, Params::new());
        b.shape("sphere", Params::new().with("bsdf", bsdf));
        b.light("constant", Params::new().with("radiance", Value::Float(1.0)));
        b.camera([0.1, 0.2, 3.0], [0.0; 3], Vector3::Y);
        // What the glass reflects at once is there as well: all of it together is one.
        b.expect("path", &[("integrator.hide_emitters", "true")], expected);
    }
}

/// Depth-limited, the same shell is a geometric series: 1 + 1/2 + 1/4.
#[test]
fn path_lengths_are_counted_in_segments() {
    let mut b = Builder::new();
    let grey = b.diffuse(0.5);
    let emission = b.node(Family::Light, "area", Params::new().with("radiance", Value::Float(1.0)));
    let inside_out =
        Params::new().with("bsdf", grey).with("emission", emission).with("flip_normals", Value::Bool(true));
    b.shape("sphere", inside_out);
    b.camera([0.2, 0.1, 0.0], [0.3, 0.2, 1.0], Vector3::Y);
    b.expect("path", &[("integrator.max_depth", "3")], 1.75);
}

/// Lossless glass in even surroundings cannot be seen.
#[test]
fn glass_in_even_surroundings_is_invisible() {
    for kind in ["dielectric", "thin_dielectric"] {
        let mut b = Builder::new();
        let glass = b.node(Family::Bsdf, kind, Params::new().with("int_ior", Value::Float(1.5)));
        b.shape("sphere", Params::new().with("bsdf", glass));
        b.light("constant", Params::new());
        b.camera([0.0, 0.0, 4.0], [0.3, 0.2, 0.0], Vector3::Y);
        b.expect("path", &[("integrator.rr_depth", "100")], 1.0);
    }
}

/// A stack of panes makes a tree of rays that doubles at each: it is cut where it no longer matters.
#[test]
fn whitteds_tree_does_not_explode() {
    let mut b = Builder::new();
    let glass = b.node(Family::Bsdf, "thin_dielectric", Params::new().with("int_ior", Value::Float(1.5)));
    for i in 0..24 {
        let place = Transform::translate(Vector3::new(0.0, 0.0, i as f32 * 0.1));
        b.shape(
            "rectangle",
            Params::new().with("bsdf", glass.clone()).with("world_from_object", Value::Transform(place)),
        );
    }
    b.light("constant", Params::new());
    b.camera([0.0, 0.0, 9.0], [0.0, 0.0, 0.0], Vector3::Y);
    b.0.set("integrator.max_depth", "-1").unwrap();
    let scene = compile(&b.0, &CompileOptions::default(), &mut Report::default()).unwrap();
    let options =
        RenderOptions { spp: Some(1), integrator: Some("whitted".into()), ..RenderOptions::default() };
    let rendered = render(&scene, &options, &Silent).unwrap();
    assert!(rendered.stats.rays < 64 * 100_000, "{} rays for 64 samples", rendered.stats.rays);
}

#[test]
fn threads_do_not_change_a_bit() {
    let mut b = ball_in_the_fog(0.6, 2.0);
    b.0.set("film.width", "50").unwrap();
    b.0.set("film.height", "37").unwrap();
    let scene = compile(&b.0, &CompileOptions::default(), &mut Report::default()).unwrap();
    let image = |threads| {
        let options = RenderOptions { spp: Some(5), threads, ..RenderOptions::default() };
        render(&scene, &options, &Silent).unwrap().image
    };
    let one = image(1);
    assert!([2, 3, 8].into_iter().all(|threads| image(threads).data() == one.data()));
}
