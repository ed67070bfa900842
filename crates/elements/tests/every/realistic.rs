//! The `realistic` camera against closed forms of geometrical optics, in double precision.

use std::f64::consts::PI;

use aureole_desc::{Family, Node, Params, Span, Value};
use aureole_elements::Camera;
use aureole_elements::camera::{CameraRay, CameraSample};
use aureole_math::{Pcg32, Point2};

use crate::world::{World, params, word};

/// The glass: radii of curvature, thickness, refractive index.
const R1: f64 = 55.0;
const R2: f64 = -80.0;
const THICKNESS: f64 = 6.0;
const INDEX: f64 = 1.6;
/// From the rear surface to the stop.
const GAP: f64 = 4.0;
/// Of the film, in millimetres; it is twice as wide as high, and 256 pixels wide.
const DIAGONAL: f64 = 20.0;
const FILM: [f64; 2] = [256.0, 128.0];
/// From the film to what is sharp, in metres.
const FOCUS: f64 = 0.8;

/// One glass before the stop.
fn lens() -> (&'static str, Value) {
    let rows = [R1, THICKNESS, INDEX, 30.0, R2, GAP, 1.0, 30.0, 0.0, 1.0, 0.0, 20.0];
    ("lens", Value::Floats(rows.map(|x| x as f32).into()))
}

fn build(params: Params) -> Result<Camera, String> {
    let node = Node::new(Family::Camera, "realistic", params, Span::NONE);
    Camera::build(&node, &mut World::default()).map_err(|error| error.to_string())
}

/// The camera with a stop of a diameter in millimetres.
pub(crate) fn camera(aperture: f64, others: &[(&str, Value)]) -> Camera {
    let ours = params([
        lens(),
        ("aperture_diameter", Value::Float(aperture)),
        ("focus_distance", Value::Float(FOCUS)),
        ("film_diagonal", Value::Float(DIAGONAL)),
    ]);
    let all = others.iter().fold(ours, |params, (name, value)| params.with(*name, value.clone()));
    build(all).unwrap_or_else(|error| panic!("{error}"))
}

/// A ray to a place on the film, in metres from its middle.
fn ray(camera: &Camera, x: f64, y: f64, lens: Point2) -> CameraRay {
    let pixel = 1e-3 * DIAGONAL / FILM[0].hypot(FILM[1]);
    let film = Point2::new((0.5 * FILM[0] + x / pixel) as f32, (0.5 * FILM[1] + y / pixel) as f32);
    camera.generate_ray(&CameraSample { film, lens, time: 0.0 })
}

/// A thick lens by the lensmaker's and Gauss's equations, in metres [Hecht 2017, sections 5.2 and 6.1].
struct ThickLens {
    /// From the film to the principal plane on its side.
    image: f64,
    /// From the principal plane on the scene's side to what is sharp.
    object: f64,
    /// From the film.
    stop: f64,
}

fn thick_lens() -> ThickLens {
    let [r1, r2, d, gap] = [R1, R2, THICKNESS, GAP].map(|mm| mm / 1000.0);
    let n = INDEX;
    let f = 1.0 / ((n - 1.0) * (1.0 / r1 - 1.0 / r2 + (n - 1.0) * d / (n * r1 * r2)));
    // Principal planes from the front and the rear vertex, towards the film.
    let (front, rear) = (-f * (n - 1.0) * d / (n * r2), -f * (n - 1.0) * d / (n * r1));
    let between = d + rear - front;
    // 1/a + 1/b = 1/f with a + b known: the smaller root is the image's side.
    let sum = FOCUS - between;
    let image = (sum - (sum * sum - 4.0 * f * sum).sqrt()) / 2.0;
    ThickLens { image, object: sum - image, stop: image - (gap - rear) }
}

/// Rays of one place on the film meet in the plane of focus, where the magnification puts them.
#[test]
fn rays_meet_where_gauss_puts_the_image() {
    let camera = camera(1.0, &[]);
    let ThickLens { image, object, .. } = thick_lens();
    let mut rng = Pcg32::new(1);
    for [x, y] in [[0.0, 0.0], [2e-4, 0.0], [-3e-4, 5e-4], [1e-3, -1e-3]] {
        let mut seen = 0;
        for _ in 0..400 {
            let CameraRay { ray, weight } = ray(&camera, x, y, rng.point2());
            if weight == 0.0 {
                continue;
            }
            seen += 1;
            let [ox, oy, oz] = ray.origin.to_array().map(f64::from);
            let [dx, dy, dz] = ray.direction.to_array().map(f64::from);
            let t = (FOCUS - oz) / dz;
            for (found, film) in [(ox + t * dx, x), (oy + t * dy, y)] {
                // The image is upside down. Aberrations of a stop at f/48 stay within a tenth of a millimetre.
                let expected = -film * object / image;
                assert!((found - expected).abs() < 1e-4 + 2e-3 * expected.abs(), "{found} {expected}");
            }
        }
        assert!(seen > 200, "{seen}");
    }
}

/// Irradiance from unit radiance: nothing stands between film and stop, which is a disk seen from the film.
fn irradiance(off_axis: f64, radius: f64, height: f64) -> f64 {
    // Over rings of the disk: the integral of cos⁴ / h² over the angle has a closed form.
    const N: i32 = 2000;
    let ring = |i: i32| {
        let r = (f64::from(i) + 0.5) / f64::from(N) * radius;
        let [a, b] = [off_axis * off_axis + r * r + height * height, 2.0 * off_axis * r];
        2.0 * PI * height * height * a / (a * a - b * b).powf(1.5) * r * radius / f64::from(N)
    };
    (0..N).map(ring).sum()
}

/// The mean weight is what a film gets under a bright sky, on the axis π sin² θ of the stop.
#[test]
fn exposure_is_that_of_the_stop_seen_from_the_film() {
    let stop = thick_lens().stop;
    for (aperture, off_axis) in [(2.0, 0.0), (16.0, 0.0), (5.0, 4e-3), (12.0, 9e-3), (1.0, 9.9e-3)] {
        let camera = camera(aperture, &[]);
        let radius = aperture / 2000.0;
        let expected = irradiance(off_axis, radius, stop);
        if off_axis == 0.0 {
            assert!((expected / (PI / (1.0 + (stop / radius).powi(2))) - 1.0).abs() < 1e-5);
        }
        // Along the width and askew: bounds of the pupil turn with the place on the film.
        for [cos, sin] in [[1.0, 0.0], [-0.96, 0.28]] {
            const N: u32 = 200;
            let cell = |i: u32| (i as f32 + 0.5) / N as f32;
            let lens = |i: u32| Point2::new(cell(i % N), cell(i / N));
            let sum: f64 = (0..N * N)
                .map(|i| f64::from(ray(&camera, cos * off_axis, sin * off_axis, lens(i)).weight))
                .sum();
            let mean = sum / f64::from(N * N);
            assert!((mean / expected - 1.0).abs() < 4e-3, "{aperture} {off_axis}: {mean} {expected}");
        }
    }
}

/// A stop of any shape passes as much light wherever on the film it arrives around the axis.
#[test]
fn shapes_of_the_stop_do_not_turn_with_the_film() {
    for shape in ["circular", "gaussian", "square", "pentagon", "star"] {
        let camera = camera(10.0, &[("aperture", word(shape))]);
        let mean = |angle: f64| {
            const N: u32 = 300;
            let cell = |i: u32| (i as f32 + 0.5) / N as f32;
            let lens = |i: u32| Point2::new(cell(i % N), cell(i / N));
            let [x, y] = [1e-3 * angle.cos(), 1e-3 * angle.sin()];
            (0..N * N).map(|i| f64::from(ray(&camera, x, y, lens(i)).weight)).sum::<f64>() / f64::from(N * N)
        };
        let circle = irradiance(1e-3, 5e-3, thick_lens().stop);
        for angle in [0.0, 0.4, PI / 4.0, 2.0, 4.0] {
            let found = mean(angle) / circle;
            assert!((found - 1.0).abs() < 0.015, "{shape} at {angle}: {found}");
        }
    }
}

/// The image's left is seen towards +X, its top towards +Y.
#[test]
fn images_are_upright() {
    let camera = camera(2.0, &[]);
    let mut rng = Pcg32::new(5);
    let mut seen = |x: f64, y: f64| loop {
        let CameraRay { ray, weight } = ray(&camera, x, y, rng.point2());
        if weight > 0.0 {
            break ray.direction;
        }
    };
    assert!(seen(-4e-3, 0.0).x > 0.05 && seen(4e-3, 0.0).x < -0.05);
    assert!(seen(0.0, -2e-3).y > 0.02 && seen(0.0, 2e-3).y < -0.02);
}

#[test]
fn lenses_that_cannot_be_are_refused() {
    let with = |rows: &[f32]| params([("lens", Value::Floats(rows.into()))]);
    let glass = [50.0, 5.0, 1.5, 20.0, -50.0, 40.0, 1.0, 20.0];
    let changed = |i: usize, x: f32| {
        let mut rows = glass;
        rows[i] = x;
        with(&rows)
    };
    assert!(build(with(&glass)).is_ok());
    for (params, words) in [
        (Params::new(), "lens"),
        (with(&[]), "rows of four"),
        (with(&glass[..7]), "rows of four"),
        (with(&vec![1.0; 4 * 257]), "at most 256"),
        (changed(0, f32::NAN), "surface 1"),
        (changed(0, -40.0), "does not gather light"),
        (changed(2, 1.0), "does not gather light"),
        (changed(1, -1.0), "thickness"),
        (changed(2, 0.01), "refractive index"),
        (changed(7, 0.0), "surface 2 of the lens: the diameter"),
        // Four focal lengths of 50.85 mm, and 1.61 mm between the principal planes.
        (with(&glass).with("focus_distance", Value::Float(0.05)), "only beyond 0.2050"),
        (with(&glass).with("aperture", word("round")), "pentagon"),
    ] {
        let error = build(params).expect_err(words);
        assert!(error.contains(words), "{error}");
    }
}
