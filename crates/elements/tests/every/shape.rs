//! Shapes: samples, hits, areas, boxes and derivatives agree with each other.

use std::sync::Arc;

use aureole_desc::{Family, Mesh, Params, Value};
use aureole_elements::Shape;
use aureole_elements::shape::{Geometry, ShapeHit};
use aureole_math::{Bounds3, Frame, Id, Pcg32, Point2, Point3, Ray, Transform, Vector3, warp};
use aureole_testkit::{Chi2Config, chi2_square, mean_with_error, sidak, z_test, z_test_between};

use crate::world::{World, params, word};

use Value::{Float, Floats, Ints};

/// A shape to test.
pub(crate) struct Example {
    pub(crate) label: &'static str,
    pub(crate) shape: Id<Shape>,
}

/// Turned, moved and grown evenly.
fn moved() -> Transform {
    Transform::translate(Vector3::new(0.3, -0.2, 0.5))
        * Transform::rotate(Vector3::new(1.0, 2.0, -0.5), 70.0)
        * Transform::scale(Vector3::splat(1.3))
}

/// Mirrored and stretched unevenly.
fn stretched() -> Transform {
    Transform::rotate(Vector3::new(0.2, 1.0, 0.4), 130.0) * Transform::scale(Vector3::new(1.5, -0.7, 1.0))
}

/// A bumpy closed surface with vertex normals and texture coordinates.
fn blob() -> Mesh {
    const N: u32 = 8;
    let mut mesh = Mesh::default();
    for j in 0..=N {
        for i in 0..=2 * N {
            let (u, v) = (i as f32 / (2 * N) as f32, j as f32 / N as f32);
            let w = aureole_math::spherical_direction(v * std::f32::consts::PI, u * std::f32::consts::TAU);
            let r = 1.0 + 0.2 * (3.0 * w.x).sin() * (2.0 * w.y).cos();
            mesh.positions.push((w * r).to_array());
            mesh.normals.push(w.to_array());
            mesh.uvs.push([u, v]);
        }
    }
    let row = 2 * N + 1;
    for j in 0..N {
        for i in 0..2 * N {
            let a = j * row + i;
            if j > 0 {
                mesh.indices.push([a, a + row, a + 1]);
            }
            if j + 1 < N {
                mesh.indices.push([a + 1, a + row, a + row + 1]);
            }
        }
    }
    mesh
}

/// A box without a lid, of quadrilaterals.
fn open_box() -> Mesh {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(|b| b as f32 * 1.6 - 0.8);
    let mut mesh = Mesh { positions: (0..8).map(corner).collect(), ..Mesh::default() };
    mesh.uvs = mesh.positions.iter().map(|p| [p[0] + 0.5 * p[2], p[1] - 0.3 * p[2]]).collect();
    for face in [[0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        mesh.add_face(&face);
    }
    mesh
}

/// Distances to a ball of radius 0.35 in the unit cube.
fn ball_grid() -> [(&'static str, Value); 2] {
    const N: usize = 20;
    let at = |i: usize| i as f32 / (N - 1) as f32 - 0.5;
    let value = |i: usize| Vector3::new(at(i % N), at(i / N % N), at(i / N / N)).length() - 0.35;
    let values: Vec<f32> = (0..N * N * N).map(value).collect();
    [("values", Floats(values.into())), ("resolution", Ints([N as i32; 3].into()))]
}

/// Control points of strips.
fn strip() -> Value {
    let Floats(points) = curve_points() else { return Value::Bool(false) };
    Floats(points.chunks_exact(4).take(7).flat_map(|p| p[..3].to_vec()).collect())
}

/// Control points of tubes, with radii.
fn curve_points() -> Value {
    let points: [[f32; 4]; 8] = [
        [-1.5, 0.0, 0.0, 0.2],
        [-1.0, 0.2, 0.1, 0.25],
        [-0.3, -0.1, 0.2, 0.2],
        [0.4, 0.1, 0.0, 0.25],
        [0.9, -0.1, -0.1, 0.2],
        [1.5, 0.1, 0.0, 0.2],
        [2.1, 0.3, 0.1, 0.25],
        [2.7, 0.2, 0.3, 0.2],
    ];
    Floats(points.concat().into())
}

/// Shapes of every kind, each also mirrored and stretched.
pub(crate) fn examples(world: &mut World) -> Vec<Example> {
    let patch = Floats([-1.0, -1.0, 0.0, 1.0, -1.0, 0.4, -1.0, 1.0, 0.3, 1.0, 1.2, -0.3].into());
    let two =
        [-1.0, -1.0, 0.0, 0.0, -1.0, 0.3, -1.0, 1.0, 0.3, 0.0, 1.0, 0.0, 1.0, -1.0, 0.0, 1.2, 1.0, 0.5_f32];
    let picture = world.add(Family::Texture, "bitmap", [("filename", Value::Path("heights.png".into()))]);
    let bumps = world.add(Family::Texture, "dots", [("inside", Float(0.1)), ("outside", Float(0.0))]);
    let list: Vec<(&'static str, &str, Params)> = vec![
        ("sphere", "sphere", params([("radius", Float(0.8)), ("center", Value::Vec3([0.1, 0.2, -0.1]))])),
        ("part of a sphere", "sphere", {
            params([("z_min", Float(-0.4)), ("z_max", Float(0.9)), ("phi_max", Float(250.0))])
        }),
        ("sphere, v upwards", "sphere", params([("flip_v", Value::Bool(true))])),
        ("plane", "plane", params([("normal", Value::Vec3([0.1, -0.2, 2.0])), ("offset", Float(0.3))])),
        ("disk", "disk", params([("radius", Float(0.7)), ("height", Float(0.2))])),
        ("ring", "disk", params([("inner_radius", Float(0.4)), ("phi_max", Float(200.0))])),
        ("pbrt's disk", "disk", params([("uv", word("angle_radius"))])),
        ("rectangle", "rectangle", params([])),
        ("cube", "cube", params([])),
        ("cylinder", "cylinder", { params([("p1", Value::Vec3([0.3, 0.4, 1.0])), ("radius", Float(0.5))]) }),
        ("gutter", "cylinder", params([("radius", Float(0.6)), ("phi_max", Float(150.0))])),
        ("bilinear patch", "bilinear_mesh", params([("positions", patch)])),
        ("bilinear patches", "bilinear_mesh", {
            params([("positions", Floats(two.into())), ("indices", Ints([0, 1, 2, 3, 1, 4, 3, 5].into()))])
        }),
        ("turned patches, drawn alike", "bilinear_mesh", {
            // Their texture coordinates are not their own parameters: sheared and turned.
            params([("positions", Floats(two.into())), ("indices", Ints([0, 1, 2, 3, 1, 4, 3, 5].into()))])
                .with("uvs", Floats([0.0, 1.0, 0.1, 0.5, 1.0, 1.2, 1.1, 0.6, 0.2, 0.0, 1.2, 0.0].into()))
                .with("drawn", word("each_alike"))
        }),
        ("mesh", "mesh", params([("mesh", Value::Mesh(Arc::new(blob())))])),
        ("mesh, drawn alike", "mesh", {
            let bare = Mesh { uvs: Vec::new(), ..blob() };
            params([("mesh", Value::Mesh(Arc::new(bare))), ("drawn", word("each_alike"))])
                .with("default_uvs", word("half_square"))
        }),
        ("faceted mesh", "mesh", {
            params([("mesh", Value::Mesh(Arc::new(blob()))), ("face_normals", Value::Bool(true))])
        }),
        ("subdivided box", "mesh", {
            params([("mesh", Value::Mesh(Arc::new(open_box()))), ("subdivision", word("catmull_clark"))])
                .with("levels", Value::Int(1))
        }),
        ("creased box", "mesh", {
            params([("mesh", Value::Mesh(Arc::new(open_box()))), ("subdivision", word("catmull_clark"))])
                .with("levels", Value::Int(1))
                .with("crease_edges", Ints([0, 1, 1, 3].into()))
                .with("crease_sharpness", Floats([2.5].into()))
        }),
        ("displaced mesh", "mesh", {
            params([("mesh", Value::Mesh(Arc::new(open_box()))), ("displacement", bumps)])
                .with("edge_length", Float(0.9))
        }),
        ("height field", "height_field", {
            let heights =
                (0..42).map(|i| 0.2 * ((i % 6) as f32).sin() + 0.1 * ((i / 6) as f32).cos()).collect();
            params([("heights", Floats(heights)), ("resolution", Ints([6, 7].into()))])
                .with("height_scale", Float(1.2))
        }),
        ("pictured field", "height_field", {
            params([("texture", picture), ("height_scale", Float(0.05)), ("face_normals", Value::Bool(true))])
                .with("resolution", Ints([6, 5].into()))
        }),
        ("grid", "sdf_grid", params(ball_grid())),
        ("tube", "tube", params([("points", curve_points())])),
        ("tubes, Catmull-Rom", "tube", {
            params([("points", curve_points()), ("basis", word("catmull_rom")), ("counts", Ints([8].into()))])
        }),
        (
            "flat strip",
            "curve",
            params([("points", strip()), ("width0", Float(0.3)), ("width1", Float(0.5))]),
        ),
        ("round strip", "curve", {
            params([("points", strip()), ("width0", Float(0.5)), ("style", word("cylinder"))])
                .with("basis", word("bspline"))
                .with("width1", Float(0.4))
        }),
        ("ribbon", "curve", {
            params([("points", strip()), ("style", word("ribbon")), ("width0", Float(0.8))])
                .with("width1", Float(0.6))
                .with("normals", Floats([0.0, 0.2, 1.0, 0.3, 0.0, 1.0, -0.2, 0.4, 1.0].into()))
        }),
        ("chains", "tube", {
            params([("points", curve_points()), ("basis", word("linear")), ("counts", Ints([5, 3].into()))])
        }),
    ];
    let mut examples = Vec::new();
    for (label, kind, params) in list {
        for place in [moved(), stretched()] {
            let mut params = params.clone().with("world_from_object", Value::Transform(place));
            if ["mesh", "tube", "height_field"].contains(&kind) {
                // Only shining meshes and tubes prepare to be sampled; the light itself is not looked at.
                let light = world.add(Family::Light, "area", []);
                params = params.with("emission", light);
            }
            examples.push(Example { label, shape: world.shape(kind, params) });
        }
    }
    examples
}

/// The nearest hit of a ray, by trying every primitive.
pub(crate) fn closest_hit(shape: &Shape, ray: &Ray) -> Option<ShapeHit> {
    let hits: Vec<ShapeHit> = match shape.geometry() {
        Geometry::Triangles { positions, indices } => {
            let triangle = |(i, corners): (usize, &[u32; 3])| {
                hit_triangle(ray, corners.map(|c| Point3::from(positions[c as usize])), i as u32)
            };
            indices.iter().enumerate().filter_map(triangle).collect()
        }
        _ => (0..shape.primitive_count() as u32).filter_map(|i| shape.intersect(ray, i)).collect(),
    };
    hits.into_iter().min_by(|a, b| a.t.total_cmp(&b.t))
}

/// Möller and Trumbore's test, in double precision.
fn hit_triangle(ray: &Ray, [a, b, c]: [Point3; 3], primitive: u32) -> Option<ShapeHit> {
    let wide = |v: Vector3| v.to_array().map(f64::from);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (e1, e2, d, s) = (wide(b - a), wide(c - a), wide(ray.direction), wide(ray.origin - a));
    let p = cross(d, e2);
    let det = dot(e1, p);
    let u = dot(s, p) / det;
    if !(0.0..=1.0).contains(&u) {
        return None; // most of them, at half the cost
    }
    let q = cross(s, e1);
    let (v, t) = (dot(d, q) / det, dot(e2, q) / det);
    let inside = v >= 0.0 && u + v <= 1.0 && t > f64::from(ray.t_min) && t < f64::from(ray.t_max);
    inside.then_some(ShapeHit { t: t as f32, primitive, uv: [u as f32, v as f32] })
}

/// All hits along a ray.
pub(crate) fn all_hits(shape: &Shape, mut ray: Ray) -> Vec<ShapeHit> {
    let mut hits = Vec::new();
    while let Some(hit) = closest_hit(shape, &ray) {
        hits.push(hit);
        ray.t_min = hit.t + 1e-4;
    }
    hits
}

/// A line through a ball, uniform over all lines that meet it.
fn random_line(center: Point3, radius: f32, rng: &mut Pcg32) -> Ray {
    let w = warp::square_to_uniform_sphere(rng.point2());
    let d = warp::square_to_disk_concentric(rng.point2());
    let frame = Frame::from_normal(w);
    Ray::new(center + (frame.s * d.x + frame.t * d.y - w * 1.5) * radius, w)
}

/// A ball around a box, or one where the unbounded are met.
fn ball_around(bounds: &Bounds3) -> (Point3, f32) {
    if bounds.is_empty() { (Point3::ORIGIN, 2.0) } else { (bounds.centroid(), bounds.radius()) }
}

#[test]
fn every_kind_has_an_example() {
    let mut world = World::default();
    examples(&mut world);
    world.assert_complete(Family::Shape, Shape::KINDS);
}

#[test]
fn hits_lie_on_the_surface() {
    let mut world = World::default();
    let mut rng = Pcg32::new(1);
    for example in examples(&mut world) {
        let shape = &world.shapes[example.shape];
        let (center, radius) = ball_around(&shape.bounds());
        let mut count = 0;
        for _ in 0..8000 {
            let ray = random_line(center, radius, &mut rng);
            let Some(hit) = closest_hit(shape, &ray) else { continue };
            count += 1;
            let s = shape.surface(&ray, &hit);
            let label = example.label;
            assert!((s.p - ray.at(hit.t)).length() < 1e-4 * (1.0 + hit.t), "{label}: {s:?} {hit:?}");
            for unit in [s.ng, s.frame.s, s.frame.t, s.frame.n] {
                assert!((unit.length() - 1.0).abs() < 1e-4, "{label}: {s:?}");
            }
            assert!(s.frame.s.cross(s.frame.t).dot(s.frame.n) > 0.999, "{label}: {s:?}");
            assert!(s.ng.dot(s.frame.n) > 0.0, "{label}: {s:?}");
            for tangent in [s.dp_du, s.dp_dv] {
                assert!(s.ng.dot(tangent).abs() < 2e-3 * tangent.length() + 1e-6, "{label}: {s:?}");
            }
            let bounds = shape.bounds();
            let slack = Vector3::splat(1e-5);
            let inside =
                bounds.is_empty() || Bounds3::new(bounds.min - slack, bounds.max + slack).contains(s.p);
            assert!(inside, "{label}: {s:?} {bounds:?}");
            // A ray that leaves the surface does not meet it at once.
            let away = s.spawn_ray(s.ng.face_forward(-ray.direction), 0.0);
            if let Some(again) = closest_hit(shape, &away) {
                assert!(again.t > 1e-4, "{label}: {s:?} {again:?}");
            }
        }
        assert!(count > 100, "{}: {count} hits", example.label);
    }
}

/// Nearby hits differ by ∂p/∂u Δu + ∂p/∂v Δv.
#[test]
fn derivatives_follow_the_surface() {
    let mut world = World::default();
    let mut rng = Pcg32::new(2);
    // A grid has no parameters; strips are met at their curve's depth, however they pretend to be turned; v stands still on
    // the round joints of chains.
    let without = ["grid", "flat strip", "round strip", "ribbon", "chains"];
    for example in examples(&mut world).into_iter().filter(|example| !without.contains(&example.label)) {
        let shape = &world.shapes[example.shape];
        let (center, radius) = ball_around(&shape.bounds());
        let (mut tested, mut wrong) = (0, 0);
        for _ in 0..10_000 {
            let ray = random_line(center, radius, &mut rng);
            let shift = warp::square_to_uniform_sphere(rng.point2()) * (2e-3 * radius);
            let beside = Ray::new(ray.origin + shift, ray.direction);
            let (Some(a), Some(b)) = (closest_hit(shape, &ray), closest_hit(shape, &beside)) else {
                continue;
            };
            let (a, b) = (shape.surface(&ray, &a), shape.surface(&beside, &b));
            let step = b.p - a.p;
            // Leave out seams, edges and silhouettes.
            let near = step.length() < 8e-3 * radius && a.primitive == b.primitive && a.ng.dot(b.ng) > 0.999;
            if !near || (b.uv - a.uv).length() > 0.2 || a.ng.dot(ray.direction).abs() < 0.2 {
                continue;
            }
            tested += 1;
            let duv = b.uv - a.uv;
            let predicted = a.dp_du * duv.x + a.dp_dv * duv.y;
            wrong += u32::from((predicted - step).length() > 0.1 * step.length());
        }
        // Near poles and centres the second derivative rules.
        assert!(tested > 50 && wrong * 50 <= tested, "{}: {wrong} of {tested}", example.label);
    }
}

/// Cauchy and Crofton: a surface of area A is met A / (2πR²) times by a uniform line through a ball of radius R
/// around it. False alarm of all shapes together: one in a thousand seeds.
#[test]
fn areas_are_those_that_lines_see() {
    let mut world = World::default();
    let examples = examples(&mut world);
    for example in &examples {
        let shape = &world.shapes[example.shape];
        if !shape.area().is_finite() {
            continue;
        }
        let (center, radius) = ball_around(&shape.bounds());
        let mean =
            mean_with_error(20_000, 3, |rng| all_hits(shape, random_line(center, radius, rng)).len() as f64);
        let expected = f64::from(shape.area() / (std::f32::consts::TAU * radius * radius));
        assert!(
            z_test(&mean, expected) > 1e-3 / examples.len() as f64,
            "{}: {mean:?} {expected}",
            example.label
        );
    }
}

#[test]
fn samples_lie_on_the_surface() {
    let mut world = World::default();
    for example in examples(&mut world) {
        let shape = &world.shapes[example.shape];
        let mut rng = Pcg32::new(4);
        let mut inverse = 0.0_f64;
        for _ in 0..5000 {
            let Some(s) = shape.sample_area(rng.point2()) else { continue };
            inverse += 1.0 / f64::from(s.pdf) / 5000.0;
            // Seen from just above, along the normal.
            let ray = Ray::new(s.p + s.ng * 0.01, -s.ng);
            let hit = closest_hit(shape, &ray).map(|hit| shape.surface(&ray, &hit));
            let Some(hit) = hit else {
                // Rounding may put a sample on an edge just outside.
                continue;
            };
            assert!((hit.p - s.p).length() < 1e-3, "{}: {s:?} {hit:?}", example.label);
            assert!(hit.ng.dot(s.ng) > 0.99, "{}: {s:?} {hit:?}", example.label);
            let near = (hit.uv - s.uv).length() < 2e-2 || (hit.uv - s.uv).length() > 0.98;
            let pole = hit.dp_du.length() < 0.3;
            assert!(near || pole, "{}: {s:?} {hit:?}", example.label);
        }
        // The mean of 1/pdf is the area, here within five standard errors of a spread of at most a quarter.
        if inverse > 0.0 {
            let area = f64::from(shape.area());
            assert!((inverse / area - 1.0).abs() < 0.02, "{}: {inverse} {area}", example.label);
        }
    }
}

/// Directions drawn towards a shape, weighted by 1 over their density, cover solid angles evenly: sums over draws and
/// over uniform directions agree for several functions of the direction. Hits are counted with their number along the
/// ray, since a sampler may choose points that others hide. All tests together raise a false alarm in one of a hundred seeds.
#[test]
fn directions_follow_their_density() {
    let mut world = World::default();
    let examples = examples(&mut world);
    let references = [Point3::new(2.5, 1.0, 1.5), Point3::new(0.25, -0.1, 0.4)];
    let functions: [fn(Vector3) -> f32; 4] =
        [|_| 1.0, |w| 1.0 + w.x, |w| 1.0 + w.y * w.z, |w| (3.0 * w.z).cos()];
    let threshold = sidak(0.01, examples.len() * references.len() * functions.len());
    let mut failures = Vec::new();
    for example in &examples {
        let shape = &world.shapes[example.shape];
        if shape.sample_area(Point2::new(0.5, 0.5)).is_none() {
            continue;
        }
        for (reference, f) in references.into_iter().flat_map(|r| functions.map(|f| (r, f))) {
            let drawn = mean_with_error(10_000, 5, |rng| {
                let Some(s) = shape.sample_towards(reference, rng.point2()) else { return 0.0 };
                let wi = (s.p - reference).normalized();
                f64::from(f(wi) / s.pdf)
            });
            let pdf = |ray: &Ray, hit: &ShapeHit| {
                shape.pdf_towards(reference, ray.direction, &shape.surface(ray, hit))
            };
            let seen = mean_with_error(40_000, 6, |rng| {
                let ray = Ray::new(reference, warp::square_to_uniform_sphere(rng.point2()));
                let hits = all_hits(shape, ray);
                // A ball seen from outside is drawn by its cone: by the near side alone.
                let is_cone = hits.len() == 2 && pdf(&ray, &hits[0]) == pdf(&ray, &hits[1]);
                let count = if is_cone { 1 } else { hits.len() };
                f64::from(f(ray.direction) / warp::UNIFORM_SPHERE_PDF) * count as f64
            });
            let p = z_test_between(&drawn, &seen);
            if p < threshold {
                failures
                    .push(format!("{} from {reference:?}: {drawn:?} {seen:?}, p = {p:.2e}", example.label));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The density that a sample carries is the one that its direction is given when a ray finds it.
#[test]
fn both_densities_agree() {
    let mut world = World::default();
    let mut rng = Pcg32::new(7);
    let reference = Point3::new(2.5, 1.0, 1.5);
    for example in examples(&mut world) {
        let shape = &world.shapes[example.shape];
        let (mut tested, mut wrong) = (0, 0);
        for _ in 0..1000 {
            let Some(s) = shape.sample_towards(reference, rng.point2()) else { continue };
            let ray = Ray::new(reference, (s.p - reference).normalized());
            let found = all_hits(shape, ray).into_iter().map(|hit| shape.surface(&ray, &hit));
            let Some(found) = found.min_by(|a, b| (a.p - s.p).length().total_cmp(&(b.p - s.p).length()))
            else {
                continue;
            };
            // Near the silhouette the density has no bound, and rounding rules.
            if (found.p - s.p).length() < 1e-3 && found.ng.abs_dot(ray.direction) > 0.1 {
                let pdf = shape.pdf_towards(reference, ray.direction, &found);
                tested += 1;
                wrong += u32::from((pdf / s.pdf - 1.0).abs() > 2e-2);
            }
        }
        let is_sampled = shape.sample_area(Point2::new(0.5, 0.5)).is_some();
        assert!(!is_sampled || tested > 300, "{}: {tested}", example.label);
        assert!(wrong * 100 <= tested, "{}: {wrong} of {tested}", example.label);
    }
}

/// Panels and triangles nearby are drawn evenly by solid angle: on their own parameters, whose edges are straight, draws
/// follow the density. False alarm of all together: one in a hundred seeds.
#[test]
fn near_panels_follow_their_density() {
    let mut world = World::default();
    let triangle = Mesh {
        positions: vec![[-1.0, -1.0, 0.0], [1.2, -0.8, 0.0], [0.3, 1.0, 0.0]],
        indices: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let light = world.add(Family::Light, "area", []);
    let flat = |kind: &str| match kind {
        "mesh" => params([("mesh", Value::Mesh(Arc::new(triangle.clone()))), ("emission", light.clone())]),
        _ => params([("emission", light.clone())]),
    };
    let references = [Point3::new(0.5, 0.1, 1.2), Point3::new(-1.5, -1.0, 0.3), Point3::new(0.1, -0.2, -0.2)];
    let cases: Vec<_> = ["rectangle", "mesh"].into_iter().flat_map(|k| references.map(|r| (k, r))).collect();
    for (kind, local) in &cases {
        for place in [moved(), stretched()] {
            let placed = flat(kind).with("world_from_object", Value::Transform(place));
            let id = world.shape(kind, placed);
            let shape = &world.shapes[id];
            let reference = place.point(*local);
            let corner = |i: usize| match *kind {
                "mesh" => place.point(Point3::from(triangle.positions[i])),
                _ => place.point(
                    [Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, -1.0, 0.0), Point3::new(-1.0, 1.0, 0.0)]
                        [i],
                ),
            };
            let (p, du, dv) = (corner(0), corner(1) - corner(0), corner(2) - corner(0));
            let sample = |rng: &mut Pcg32| Some(shape.sample_towards(reference, rng.point2())?.uv);
            let density = |uv: Point2| {
                let target = p + du * uv.x + dv * uv.y;
                let ray = Ray::new(reference, (target - reference).normalized());
                let Some(hit) = closest_hit(shape, &ray) else { return 0.0 };
                let surface = shape.surface(&ray, &hit);
                let cos = surface.ng.abs_dot(ray.direction);
                let per_area = cos / (target - reference).length_squared() * du.cross(dv).length();
                shape.pdf_towards(reference, ray.direction, &surface) * per_area
            };
            let config = Chi2Config { test_count: 2 * cases.len(), columns: 20, ..Chi2Config::default() };
            if let Err(error) = chi2_square(&config, sample, density) {
                panic!("{kind} from {local:?}: {error}");
            }
        }
    }
}
