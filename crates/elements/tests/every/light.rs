//! Lights: draws, densities, radiance and power agree with each other.

use std::f32::consts::PI;

use aureole_desc::{Family, Value};
use aureole_elements::light::{Area, LightContext};
use aureole_elements::{Light, Shape, SurfacePoint};
use aureole_math::{Bounds3, Id, Pcg32, Point2, Point3, Ray, Transform, Vector3, warp};
use aureole_spectrum::{Wavelengths, luminance};
use aureole_testkit::{Chi2Config, chi2_sphere, mean_with_error, sidak, z_test, z_test_between};

use crate::shape::all_hits;
use crate::world::{World, params, rgb, word};

use Value::Float;

/// A light to test.
struct Example {
    label: &'static str,
    light: Light,
    /// The shape that shines, if one does.
    shape: Option<Id<Shape>>,
    is_two_sided: bool,
    /// Where the shape's group is.
    place: Option<Transform>,
}

fn turned() -> Value {
    Value::Transform(
        Transform::translate(Vector3::new(0.5, 1.0, -0.3))
            * Transform::rotate(Vector3::new(1.0, 0.3, 2.0), 50.0),
    )
}

fn examples(world: &mut World) -> Vec<Example> {
    let picture = || Value::Path("sky.exr".into());
    let slide = world.add(Family::Texture, "bitmap", [("filename", picture())]);
    let glow =
        world.add(Family::Texture, "bilerp", [("v00", rgb(1.0, 0.2, 0.1)), ("v11", rgb(0.1, 3.0, 0.5))]);
    let rotation = || Value::Transform(Transform::rotate(Vector3::new(0.2, 1.0, 0.6), 40.0));
    let free = [
        (
            "point",
            "point",
            params([("intensity", rgb(2.0, 1.0, 0.5)), ("position", Value::Vec3([0.1, 0.2, 0.3]))]),
        ),
        ("spot", "spot", params([("world_from_light", turned()), ("cutoff_angle", Float(35.0))])),
        ("smooth spot", "spot", {
            params([
                ("cutoff_angle", Float(60.0)),
                ("beam_width", Float(10.0)),
                ("falloff", word("smoothstep")),
            ])
        }),
        ("spot with a picture", "spot", params([("texture", slide.clone())])),
        (
            "directional",
            "directional",
            params([("irradiance", rgb(1.0, 2.0, 3.0)), ("world_from_light", turned())]),
        ),
        ("constant", "constant", params([("radiance", rgb(0.5, 0.6, 0.7))])),
        ("sky", "envmap", params([("filename", picture()), ("world_from_light", rotation())])),
        ("square sky", "envmap", {
            params([("filename", picture()), ("mapping", word("equal_area")), ("scale", Float(2.0))])
        }),
        ("sky behind a window", "portal_envmap", {
            // Before all points of reference, so that all see something of it.
            let corners = [-1.5, -1.0, 4.0, -1.5, 2.0, 4.0, 2.5, 2.0, 4.0, 2.5, -1.0, 4.0];
            params([("filename", picture()), ("portal", Value::Floats(corners.map(|x: f32| x).into()))])
        }),
        ("sky of texels", "envmap", {
            params([("filename", picture()), ("mapping", word("equal_area")), ("filter", word("nearest"))])
        }),
        ("resampled sky behind a window", "portal_envmap", {
            let corners = [-1.5, -1.0, 4.0, -1.5, 2.0, 4.0, 2.5, 2.0, 4.0, 2.5, -1.0, 4.0];
            params([("filename", picture()), ("portal", Value::Floats(corners.map(|x: f32| x).into()))])
                .with("filter", word("nearest"))
                .with("mapping", word("equal_area"))
        }),
        ("even light behind a window", "portal_envmap", {
            let corners = [-1.5, -1.0, 4.0, -1.5, 2.0, 4.0, 2.5, 2.0, 4.0, 2.5, -1.0, 4.0];
            params([("tint", rgb(0.5, 0.6, 0.7)), ("portal", Value::Floats(corners.map(|x: f32| x).into()))])
        }),
        ("sky of known illuminance", "envmap", {
            params([("filename", picture()), ("mapping", word("equal_area")), ("illuminance", Float(3.0))])
        }),
        ("projector", "projector", {
            params([("irradiance", slide), ("world_from_light", turned()), ("fov", Float(60.0))])
        }),
        ("goniometric picture", "goniometric", {
            params([
                ("filename", picture()),
                ("world_from_light", turned()),
                ("intensity", rgb(1.0, 2.0, 0.5)),
            ])
        }),
        ("luminaire", "goniometric", {
            params([
                ("vertical", Value::Floats([0.0, 30.0, 60.0, 90.0].into())),
                ("horizontal", Value::Floats([0.0, 90.0, 180.0].into())),
                (
                    "candela",
                    Value::Floats(
                        [50.0, 40.0, 10.0, 0.0, 50.0, 60.0, 30.0, 1.0, 50.0, 20.0, 20.0, 0.0].into(),
                    ),
                ),
                ("power", Float(7.0)),
                ("world_from_light", turned()),
            ])
        }),
        ("projector by intensity", "projector", {
            params([
                ("irradiance", glow.clone()),
                ("measure", word("intensity")),
                ("fov", Float(70.0)),
                ("power", Float(3.0)),
            ])
        }),
        // A sun that is large and dim enough for tests that look around.
        ("sun and sky", "sunsky", {
            params([
                ("sun_direction", Value::Vec3([0.5, 0.8, 0.6])),
                ("sun_aperture", Float(40.0)),
                ("turbidity", Float(4.5)),
                ("world_from_light", rotation()),
            ])
        }),
        ("sky without a sun", "sunsky", params([("sun_scale", Float(0.0)), ("hour", Float(9.5))])),
    ];
    let mut examples: Vec<Example> = free
        .into_iter()
        .map(|(label, kind, params)| Example {
            label,
            light: world.light(kind, params, None),
            shape: None,
            is_two_sided: false,
            place: None,
        })
        .collect();

    let shining = world.add(Family::Light, "area", []);
    let place = ("world_from_object", turned());
    let shapes = [
        (
            "shining ball",
            "sphere",
            params([("radius", Float(0.4)), ("emission", shining.clone()), place.clone()]),
        ),
        ("shining panel", "rectangle", params([("emission", shining.clone()), place.clone()])),
        ("shining tube", "cylinder", params([("emission", shining), place, ("radius", Float(0.2))])),
    ];
    for (label, kind, shape) in shapes {
        let shape = Some(world.shape(kind, shape));
        for is_two_sided in [false, true] {
            let params = params([("radiance", glow.clone()), ("two_sided", Value::Bool(is_two_sided))]);
            examples.push(Example {
                label,
                light: world.light("area", params, shape),
                shape,
                is_two_sided,
                place: None,
            });
        }
    }
    for is_two_sided in [false, true] {
        let node = world.add(
            Family::Bsdf,
            "open_pbr",
            [
                ("emission_luminance", Float(3.0)),
                ("emission_color", glow.clone()),
                ("coat_weight", Float(0.8)),
                ("coat_color", rgb(0.9, 0.5, 0.4)),
                ("fuzz_weight", Float(0.3)),
                ("geometry_thin_walled", Value::Bool(is_two_sided)),
            ],
        );
        let material = world.material_of(&node);
        let shape = world.shape("sphere", params([("radius", Float(0.7)), ("emission", node)]));
        let light = Area::of_material(shape, material).into();
        let label = "ball of a material that shines";
        examples.push(Example { label, light, shape: Some(shape), is_two_sided, place: None });
    }
    // In groups, whose instances may stretch and mirror them.
    let squeeze = Transform::translate(Vector3::new(0.2, 0.1, 0.4))
        * Transform::rotate(Vector3::new(1.0, 2.0, 0.3), 35.0)
        * Transform::scale(Vector3::new(0.8, -1.3, 0.6));
    let placed: Vec<Example> = examples
        .iter()
        .filter_map(|example| {
            let light = example.light.placed(&squeeze);
            let is_placed = example.shape.is_some();
            is_placed.then_some(Example { light, place: Some(squeeze), ..*example })
        })
        .collect();
    let bright = params([("radiance", glow.clone()), ("power", Float(5.0))]);
    let pieces = bright.clone().with("power_of", Value::String("primitive".into()));
    let shape = examples.last().and_then(|example| example.shape);
    for (label, given) in
        [("shining tube of known power", bright), ("shining tube whose pieces have a known power", pieces)]
    {
        let light = world.light("area", given, shape);
        examples.push(Example { label, light, shape, is_two_sided: false, place: None });
    }
    examples.extend(placed);
    examples
}

fn context(world: &World) -> LightContext<'_> {
    LightContext {
        textures: &world.textures,
        shapes: &world.shapes,
        materials: &world.materials,
        wavelengths: Wavelengths::RGB,
    }
}

const REFERENCES: [Point3; 3] =
    [Point3::new(0.0, -1.5, 0.4), Point3::new(3.0, 2.0, 1.0), Point3::new(0.4, 0.8, -1.5)];

#[test]
fn every_kind_has_an_example() {
    let mut world = World::default();
    examples(&mut world);
    world.assert_complete(Family::Light, Light::KINDS);
}

#[test]
fn draws_carry_what_their_direction_sees() {
    let mut world = World::default();
    let examples = examples(&mut world);
    let at = context(&world);
    for example in &examples {
        let light = &example.light;
        let mut rng = Pcg32::new(1);
        let mut drawn = 0;
        for _ in 0..400 {
            let w = warp::square_to_uniform_sphere(rng.point2());
            let reference = Point3::ORIGIN + w * (1.5 + 2.0 * rng.next_f32());
            for _ in 0..10 {
                let Some(s) = light.sample(&at, reference, rng.point2()) else { continue };
                drawn += 1;
                let label = example.label;
                assert!((s.wi.length() - 1.0).abs() < 1e-4, "{label}: {s:?}");
                assert!(
                    s.radiance.is_finite() && s.pdf_omega > 0.0 && s.pdf_omega.is_finite(),
                    "{label}: {s:?}"
                );
                if let Some(target) = s.target {
                    let towards = (target - reference).normalized();
                    assert!(towards.dot(s.wi) > 0.9999, "{label}: {s:?}");
                }
                if s.is_delta {
                    assert_eq!(s.pdf_omega, 1.0, "{label}");
                    continue;
                }
                // A ray finds the same radiance and the same density.
                let ray = Ray::new(reference, s.wi);
                let (radiance, pdf) = match example.shape {
                    None => {
                        (light.environment(&at, reference, s.wi), light.pdf_omega(&at, reference, s.wi, None))
                    }
                    Some(id) => {
                        let points = example.hits(&world.shapes[id], &ray).into_iter();
                        let target = s.target.expect("an area light has a place");
                        let nearest =
                            points.min_by(|a, b| (a.p - target).length().total_cmp(&(b.p - target).length()));
                        let Some(point) = nearest.filter(|p| p.ng.abs_dot(s.wi) > 0.1) else { continue };
                        let pdf = light.pdf_omega(&at, reference, s.wi, Some(&point));
                        (light.emitted(&at, &point, -s.wi), pdf)
                    }
                };
                assert!((pdf / s.pdf_omega - 1.0).abs() < 2e-2, "{label}: {pdf} {s:?}");
                let error = (radiance - s.radiance).map(f32::abs).max_element();
                assert!(error < 2e-2 * s.radiance.max_element() + 1e-3, "{label}: {radiance:?} {s:?}");
            }
        }
        assert!(drawn > 0, "{}", example.label);
    }
}

/// False alarm of all environments together: one in a hundred seeds.
#[test]
fn skies_are_drawn_by_their_density() {
    let mut world = World::default();
    let examples = examples(&mut world);
    let at = context(&world);
    // What is seen through a window has hard edges, which no quadrature likes: its density has a test of its own.
    let is_whole = |e: &&Example| e.light.is_environment() && !e.label.ends_with("behind a window");
    let skies: Vec<_> = examples.iter().filter(is_whole).collect();
    assert_eq!(skies.len(), 7);
    let config = Chi2Config { test_count: skies.len(), ..Chi2Config::default() };
    for example in skies {
        let sample = |rng: &mut Pcg32| Some(example.light.sample(&at, Point3::ORIGIN, rng.point2())?.wi);
        let pdf = |wi: Vector3| example.light.pdf_omega(&at, Point3::ORIGIN, wi, None);
        if let Err(error) = chi2_sphere(&config, sample, pdf) {
            panic!("{}: {error}", example.label);
        }
    }
}

/// Irradiance by drawing lights equals irradiance by looking around. False alarm: one in a hundred seeds.
#[test]
fn drawing_and_looking_agree() {
    let mut world = World::default();
    let examples = examples(&mut world);
    let at = context(&world);
    let threshold = sidak(0.01, examples.len() * REFERENCES.len());
    for example in &examples {
        let light = &example.light;
        for reference in REFERENCES {
            if light.sample(&at, reference, Point2::new(0.5, 0.5)).is_some_and(|s| s.is_delta) {
                continue;
            }
            let drawn = mean_with_error(20_000, 2, |rng| match light.sample(&at, reference, rng.point2()) {
                Some(s) if example.is_seen(&world, reference, s.wi, s.target) => {
                    f64::from(luminance(s.radiance.rgb()) / s.pdf_omega)
                }
                _ => 0.0,
            });
            let seen = mean_with_error(100_000, 3, |rng| {
                let wi = warp::square_to_uniform_sphere(rng.point2());
                let ray = Ray::new(reference, wi);
                let radiance = match example.shape {
                    None => light.environment(&at, reference, wi),
                    Some(id) => {
                        let hits = example.hits(&world.shapes[id], &ray);
                        let nearest = hits
                            .into_iter()
                            .min_by(|a, b| (a.p - reference).length().total_cmp(&(b.p - reference).length()));
                        let Some(point) = nearest else { return 0.0 };
                        light.emitted(&at, &point, -wi)
                    }
                };
                f64::from(luminance(radiance.rgb()) / warp::UNIFORM_SPHERE_PDF)
            });
            let p = z_test_between(&drawn, &seen);
            assert!(p > threshold, "{} from {reference:?}: {drawn:?} {seen:?}, p = {p:.2e}", example.label);
        }
    }
}

impl Example {
    /// Whether the light's own shape does not hide the point that was drawn.
    fn is_seen(&self, world: &World, reference: Point3, wi: Vector3, target: Option<Point3>) -> bool {
        let (Some(id), Some(target)) = (self.shape, target) else { return true };
        let hits = self.hits(&world.shapes[id], &Ray::new(reference, wi));
        let distance = (target - reference).length() - 2e-3;
        hits.iter().all(|hit| (hit.p - reference).length() > distance)
    }

    /// All hits of a ray with the shape, where it is.
    fn hits(&self, shape: &Shape, ray: &Ray) -> Vec<SurfacePoint> {
        let local = self.place.map_or(*ray, |place| place.inverse().ray(ray));
        let surfaces = all_hits(shape, local).into_iter().map(|hit| shape.surface(&local, &hit));
        surfaces.map(|s| self.place.map_or(s, |place| s.transformed(&place))).collect()
    }
}

/// Power is the flux through a large sphere around a light of finite extent, or the flux onto the scene's disk. It only
/// guides the choice among lights: within 15 % is good, and what shines into itself counts as well.
#[test]
fn power_is_the_flux() {
    let mut world = World::default();
    let examples = examples(&mut world);
    let at = context(&world);
    let scene = Bounds3::new(Point3::splat(-1.0), Point3::splat(1.0));
    for example in &examples {
        let light = &example.light;
        if example.label.ends_with("behind a window") {
            continue; // its power is what comes through, not what reaches the scene's disk
        }
        let power = f64::from(light.power(&at, &scene));
        let radius = 50.0;
        let flux = if light.is_environment() {
            // Radiance from everywhere onto a disk of the scene's radius.
            let mean = mean_with_error(100_000, 4, |rng| {
                let w = warp::square_to_uniform_sphere(rng.point2());
                f64::from(luminance(light.environment(&at, Point3::ORIGIN, w).rgb()))
            });
            mean.value * 4.0 * f64::from(PI) * f64::from(PI) * f64::from(scene.radius()).powi(2)
        } else if example.label == "directional" {
            let s = light.sample(&at, Point3::ORIGIN, Point2::new(0.5, 0.5)).expect("always shines");
            f64::from(luminance(s.radiance.rgb()) * PI) * f64::from(scene.radius()).powi(2)
        } else {
            let mean = mean_with_error(60_000, 5, |rng| {
                let w = warp::square_to_uniform_sphere(rng.point2());
                let p = Point3::ORIGIN + w * radius;
                match light.sample(&at, p, rng.point2()) {
                    Some(s) if example.is_seen(&world, p, s.wi, s.target) => {
                        f64::from(luminance(s.radiance.rgb()) / s.pdf_omega * -s.wi.dot(w))
                    }
                    _ => 0.0,
                }
            });
            mean.value * 4.0 * f64::from(PI) * f64::from(radius).powi(2)
        };
        let may_hide = example.is_two_sided && example.label != "shining panel";
        let range = if may_hide { 0.9..2.2 } else { 0.85..1.15 };
        let is_close = range.contains(&(power / flux));
        assert!(is_close, "{}: power {power}, flux {flux}", example.label);
    }
}

/// A point light's intensity, seen from everywhere, is its irradiance times the square of the distance.
#[test]
fn irradiance_falls_with_the_square() {
    let mut world = World::default();
    let light = world.light("point", params([("intensity", rgb(4.0, 4.0, 4.0))]), None);
    let at = context(&world);
    let mean = mean_with_error(1000, 6, |rng| {
        let p = Point3::ORIGIN + warp::square_to_uniform_sphere(rng.point2()) * (1.0 + 9.0 * rng.next_f32());
        let s = light.sample(&at, p, rng.point2()).expect("always shines");
        f64::from(s.radiance.rgb()[0] * (p - Point3::ORIGIN).length_squared())
    });
    assert!(z_test(&mean, 4.0) > 1e-4, "{mean:?}");
}
