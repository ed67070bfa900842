//! Bodies that scatter inside, against what energy, theory and independent walks say of them.
//!
//! Comparisons allow five standard errors of both sides, and what else is stated: fewer than one false alarm in a hundred
//! thousand seeds, and the seeds are fixed.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "subsurface/oracle.rs"]
mod oracle;

use aureole_desc::{Family, Node, Params, Report, SceneDesc, Span, Value};
use aureole_math::{Point3, Transform, Vector3};
use aureole_render::{RenderOptions, Silent, render};
use aureole_scene::{CompileOptions, compile};
use aureole_spectrum::SpectrumSource;
use oracle::{Ball, Estimate, half_space};

use Value::Float;

struct Builder(SceneDesc);

fn rgb(c: [f32; 3]) -> Value {
    Value::Spectrum(SpectrumSource::Rgb(c))
}

fn params<const N: usize>(list: [(&str, Value); N]) -> Params {
    list.into_iter().fold(Params::new(), |params, (name, value)| params.with(name, value))
}

impl Builder {
    /// Even surroundings of radiance one.
    fn new() -> Self {
        let mut b = Self::dark();
        let light = b.add(Family::Light, "constant", Params::new());
        b.0.lights.push(light);
        b
    }

    fn dark() -> Self {
        let mut desc = SceneDesc::default();
        for (name, value) in [("film.width", "8"), ("film.height", "8"), ("integrator.rr_depth", "64")] {
            desc.set(name, value).unwrap();
        }
        Self(desc)
    }

    fn add(&mut self, family: Family, kind: &str, params: Params) -> aureole_desc::NodeId {
        self.0.add(Node::new(family, kind, params, Span::NONE))
    }

    fn subsurface<const N: usize>(&mut self, list: [(&str, Value); N]) -> Value {
        Value::Node(self.add(Family::Bsdf, "subsurface", params(list)))
    }

    fn shape(&mut self, kind: &str, params: Params) {
        let id = self.add(Family::Shape, kind, params);
        self.0.shapes.push(id);
    }

    /// A narrow view from a point to another, or parallel rays of some width.
    fn camera(&mut self, from: [f32; 3], to: [f32; 3], parallel: Option<f32>) {
        let up = if from[2] == to[2] { Vector3::Z } else { Vector3::Y };
        let place = Transform::look_at(Point3::from(from), Point3::from(to), up).unwrap();
        let place = match parallel {
            Some(width) => place * Transform::scale(Vector3::splat(0.5 * width)),
            None => place,
        };
        let camera = params([("world_from_camera", Value::Transform(place)), ("near_clip", Float(1e-4))]);
        let id = match parallel {
            Some(_) => self.add(Family::Camera, "orthographic", camera),
            None => self.add(Family::Camera, "perspective", camera.with("fov", Float(0.2))),
        };
        self.0.cameras.push(id);
    }

    /// The mean of all pixels, by channel.
    fn render(&self, spp: u32) -> [Estimate; 3] {
        let scene = compile(&self.0, &CompileOptions::default(), &mut Report::default()).unwrap();
        let options =
            RenderOptions { spp: Some(spp), integrator: Some("path".into()), ..RenderOptions::default() };
        let rendered = render(&scene, &options, &Silent).unwrap();
        assert_eq!(rendered.stats.non_finite, 0);
        [0, 1, 2].map(|c| {
            let values = rendered.image.data().iter().skip(c).step_by(3);
            Estimate::of(values.map(|x| f64::from(*x)))
        })
    }
}

/// Whoever loses nothing cannot be seen in even surroundings: one walk after another comes out, whatever is inside.
#[test]
fn white_bodies_in_even_surroundings_are_invisible() {
    for exit in ["refracted", "diffuse"] {
        for (shape, g, eta) in [("sphere", 0.0, 1.33), ("cube", 0.7, 1.5), ("sphere", -0.4, 1.0)] {
            let mut b = Builder::new();
            let white = b.subsurface([
                ("sigma_s", rgb([0.5, 3.0, 9.0])),
                ("sigma_a", Float(0.0)),
                ("g", Float(g)),
                ("int_ior", Float(eta)),
                ("exit", Value::String(exit.into())),
            ]);
            b.shape(shape, params([("bsdf", white)]));
            b.camera([1.0, 2.0, 4.0], [0.1, 0.2, 0.0], None);
            for (c, mean) in b.render(64).into_iter().enumerate() {
                assert!(mean.is_near(1.0, 1e-3), "{exit} {shape} {eta}, channel {c}: {mean:?}");
            }
        }
    }
}

/// OpenPBR's bodies and cloudy glass lose nothing either, if they are white and smooth.
#[test]
fn white_open_pbr_in_even_surroundings_is_invisible() {
    let body = params([("subsurface_weight", Float(1.0)), ("subsurface_color", Float(1.0))]);
    let glass = params([
        ("transmission_weight", Float(1.0)),
        ("transmission_depth", Float(0.7)),
        ("transmission_scatter", Float(0.9)),
    ]);
    let prism = params([("transmission_weight", Float(1.0)), ("transmission_dispersion_scale", Float(1.0))]);
    for (list, spp) in [(body, 64), (glass, 64), (prism, 1024)] {
        let mut b = Builder::new();
        let list = list.with("specular_roughness", Float(0.0)).with("subsurface_radius", Float(0.3));
        let white = b.add(Family::Bsdf, "open_pbr", list);
        b.shape("sphere", params([("bsdf", Value::Node(white))]));
        b.camera([1.0, 2.0, 4.0], [0.1, 0.2, 0.0], None);
        for (c, mean) in b.render(spp).into_iter().enumerate() {
            assert!(mean.is_near(1.0, 1e-3), "channel {c}: {mean:?}");
        }
    }
}

/// Light that crosses glass has the square of its colour after twice its depth.
#[test]
fn glass_absorbs_by_depth() {
    let mut b = Builder::new();
    let color = [0.5, 0.8, 0.1];
    let glass = b.add(
        Family::Bsdf,
        "open_pbr",
        params([
            ("transmission_weight", Float(1.0)),
            ("transmission_color", rgb(color)),
            ("transmission_depth", Float(1.0)),
            ("specular_roughness", Float(0.0)),
            ("specular_ior", Float(1.0)),
        ]),
    );
    b.shape("cube", params([("bsdf", Value::Node(glass))]));
    b.camera([0.2, 0.1, 5.0], [0.2, 0.1, 0.0], None);
    for (mean, c) in b.render(16).into_iter().zip(color) {
        assert!(mean.is_near(f64::from(c * c), 1e-4), "{mean:?} for {c}");
    }
}

/// The same body as an instance that is turned, stretched and moved.
#[test]
fn placed_bodies_are_as_white() {
    let mut b = Builder::new();
    let white = b.subsurface([
        ("sigma_s", Float(4.0)),
        ("sigma_a", Float(0.0)),
        ("exit", Value::String("diffuse".into())),
    ]);
    let ball = b.add(Family::Shape, "sphere", params([("bsdf", white)]));
    let group = params([("shapes", Value::Nodes(vec![ball]))]);
    let group = b.add(Family::Shape, "group", group);
    let place = Transform::translate(Vector3::new(30.0, -20.0, 5.0))
        * Transform::rotate(Vector3::new(1.0, 1.0, 0.3), 40.0)
        * Transform::scale(Vector3::new(2.0, 1.0, 0.5));
    let instance = params([("group", Value::Node(group)), ("world_from_object", Value::Transform(place))]);
    b.shape("instance", instance);
    b.camera([30.5, -18.0, 15.0], [30.0, -20.0, 5.0], None);
    let [mean, ..] = b.render(64);
    assert!(mean.is_near(1.0, 1e-3), "{mean:?}");
}

/// A ball without a refracting boundary under a lamp, against a walk that knows nothing of this program: three colours of
/// their own extinction and albedo, anisotropic. Everything is found by walks.
#[test]
fn a_ball_under_a_lamp_is_what_an_independent_walk_sees() {
    let (absorption, scattering, g) = ([0.3, 1.0, 0.2], [1.5, 2.0, 6.0], 0.4);
    let mut b = Builder::dark();
    let medium = b.subsurface([
        ("sigma_a", rgb(absorption)),
        ("sigma_s", rgb(scattering)),
        ("g", Float(g)),
        ("int_ior", Float(1.0)),
        ("ext_ior", Float(1.0)),
    ]);
    b.shape("sphere", params([("bsdf", medium)]));
    let emission = b.add(Family::Light, "area", params([("radiance", Float(1.0))]));
    let lamp = Transform::translate(Vector3::new(0.0, 3.0, 0.0))
        * Transform::rotate(Vector3::X, 90.0)
        * Transform::scale(Vector3::splat(2.0));
    b.shape(
        "rectangle",
        params([("world_from_object", Value::Transform(lamp)), ("emission", Value::Node(emission))]),
    );
    b.camera([0.3, 0.2, 5.0], [0.3, 0.2, 0.0], None);
    for (c, mean) in b.render(4096).into_iter().enumerate() {
        let ball = Ball { absorption: absorption[c].into(), scattering: scattering[c].into(), g };
        let expected = ball.seen_under_a_lamp(400_000, c as u64);
        assert!(mean.agrees(&expected, 0.0), "channel {c}: {mean:?}, not {expected:?}");
    }
}

/// A flat, endless body from straight above and aslant, with and without a boundary, against Chandrasekhar's theory:
/// F + (1 - F) R.
#[test]
fn a_flat_body_reflects_what_theory_says() {
    for (albedo, eta, tilt) in [(0.9, 1.0, 0.0), (0.9, 1.0, 60.0), (0.99, 1.4, 0.0), (0.6, 1.5, 45.0)] {
        for exit in ["refracted", "diffuse"] {
            let mut b = Builder::new();
            let medium = b.subsurface([
                ("sigma_a", Float(1.0 - albedo)),
                ("sigma_s", Float(albedo)),
                ("int_ior", Float(eta)),
                ("ext_ior", Float(1.0)),
                ("exit", Value::String(exit.into())),
            ]);
            b.shape("plane", params([("bsdf", medium)]));
            let (sin, cos) = f32::to_radians(tilt).sin_cos();
            b.camera([9.0 * sin, 0.0, 9.0 * cos], [0.0; 3], None);
            let [mean, ..] = b.render(512);
            let expected = half_space(albedo, eta, cos.into());
            assert!(mean.is_near(expected, 1e-3), "{exit} {albedo} {eta} {tilt}: {mean:?}, not {expected}");
        }
    }
}

/// A body whose colour is given is of that colour: a large ball, seen whole by parallel rays, shows its albedo under all angles
/// as a diffuse light does. Within 0.5 % of what enters, 2 % for anisotropic scattering; and the curvature's part.
#[test]
fn a_wanted_reflectance_is_met() {
    let wanted = [0.8, 0.4, 0.1];
    for (eta, g, tolerance) in [(1.5, 0.0, 0.005), (1.33, 0.5, 0.02)] {
        let mut b = Builder::new();
        let medium = b.subsurface([
            ("reflectance", rgb(wanted)),
            ("mfp", Float(0.002)),
            ("int_ior", Float(eta)),
            ("ext_ior", Float(1.0)),
            ("g", Float(g)),
            ("exit", Value::String("diffuse".into())),
        ]);
        b.shape("sphere", params([("bsdf", medium)]));
        // The square of the image lies within the disk but for its corners: the whole disk in a square of its width.
        b.camera([0.0, 0.0, 5.0], [0.0; 3], Some(2.0));
        let mirror = oracle::mean_fresnel(eta);
        for (c, mean) in b.render(512).into_iter().enumerate() {
            let disk = std::f64::consts::FRAC_PI_4;
            let seen = (mean.value - (1.0 - disk)) / disk;
            let entered = (seen - mirror) / (1.0 - mirror);
            let error = 5.0 * mean.standard_error + tolerance;
            assert!((entered - f64::from(wanted[c])).abs() < error, "{eta} {g}, channel {c}: {entered}");
        }
    }
}

#[test]
fn walks_do_not_depend_on_threads_or_batches() {
    let mut b = Builder::new();
    let milk = b.subsurface([("scale", Float(3.0)), ("exit", Value::String("diffuse".into()))]);
    b.shape("sphere", params([("bsdf", milk)]));
    b.camera([0.0, 0.0, 5.0], [0.0; 3], Some(2.5));
    b.0.set("film.width", "40").unwrap();
    let scene = compile(&b.0, &CompileOptions::default(), &mut Report::default()).unwrap();
    let image = |threads, tile| {
        let options = RenderOptions { spp: Some(4), threads, tile, ..RenderOptions::default() };
        render(&scene, &options, &Silent).unwrap().image
    };
    let one = image(1, 16);
    assert!([(2, 16), (3, 8), (8, 32)].into_iter().all(|(t, size)| image(t, size).data() == one.data()));
}
