//! Rounding lets no surface shadow itself, and no light through a closed one.

use std::sync::Arc;

use aureole_desc::{Family, Mesh, Node, NodeId, Params, Report, SceneDesc, Span, Value};
use aureole_elements::SurfacePoint;
use aureole_math::{Pcg32, Point3, Ray, Transform, Vector3, warp};
use aureole_scene::{CompileOptions, Scene, compile};

/// A surface of several shapes, each of a kind and with parameters.
type Body = Vec<(&'static str, Params)>;

fn floats(list: &[[f32; 3]]) -> Value {
    Value::Floats(list.concat().into())
}

fn mesh(positions: Vec<[f32; 3]>, faces: &[Vec<u32>]) -> Params {
    let mut mesh = Mesh { positions, ..Mesh::default() };
    faces.iter().for_each(|face| {
        mesh.add_face(face);
    });
    Params::new().with("mesh", Value::Mesh(Arc::new(mesh)))
}

/// A ball of flat faces: the sides of a cube, each a grid, blown up.
fn ball() -> (Vec<[f32; 3]>, Vec<Vec<u32>>) {
    const N: u32 = 8;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for side in 0..6 {
        let first = positions.len() as u32;
        for i in 0..(N + 1) * (N + 1) {
            let at = |k: u32| 2.0 * k as f32 / N as f32 - 1.0;
            let (u, v) = (at(i % (N + 1)), at(i / (N + 1)));
            let w = match side % 3 {
                0 => Vector3::new(1.0, u, v),
                1 => Vector3::new(v, 1.0, u),
                _ => Vector3::new(u, v, 1.0),
            };
            let w = if side < 3 { w } else { Vector3::new(-w.x, -w.y, -w.z) };
            positions.push(w.normalized().to_array());
        }
        for i in 0..N * N {
            let a = first + i % N + i / N * (N + 1);
            let mut face = vec![a, a + 1, a + N + 2, a + N + 1];
            if side >= 3 {
                face.reverse();
            }
            faces.push(face);
        }
    }
    (positions, faces)
}

/// Surfaces in the plane z = 0.
fn flat() -> Vec<(&'static str, Body)> {
    let square = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let patch = floats(&[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.9, 1.2, 0.0]]);
    vec![
        ("mesh", vec![("mesh", mesh(square, &[vec![0, 1, 2, 3]]))]),
        ("rectangle", vec![("rectangle", Params::new())]),
        ("disk", vec![("disk", Params::new())]),
        ("patch", vec![("bilinear_mesh", Params::new().with("positions", patch))]),
    ]
}

/// Closed convex surfaces around the origin.
fn closed() -> Vec<(&'static str, Body)> {
    let (positions, faces) = ball();
    let corners: Vec<i32> = faces.iter().flat_map(|f| [f[0], f[1], f[3], f[2]]).map(|i| i as i32).collect();
    let patches =
        Params::new().with("positions", floats(&positions)).with("indices", Value::Ints(corners.into()));
    let lid = |z: f64| Params::new().with("height", Value::Float(z));
    let tube =
        Params::new().with("p0", Value::Vec3([0.0, 0.0, -1.0])).with("p1", Value::Vec3([0.0, 0.0, 1.0]));
    vec![
        ("sphere", vec![("sphere", Params::new())]),
        ("cube", vec![("cube", Params::new())]),
        ("mesh", vec![("mesh", mesh(positions, &faces))]),
        ("patches", vec![("bilinear_mesh", patches)]),
        ("can", vec![("cylinder", tube), ("disk", lid(-1.0)), ("disk", lid(1.0))]),
    ]
}

fn places() -> Vec<(&'static str, Transform)> {
    let scale = |s: f32| Transform::scale(Vector3::splat(s));
    let turned = Transform::rotate(Vector3::new(0.3, -1.0, 0.6), 77.0);
    vec![
        ("at the origin", Transform::IDENTITY),
        ("in the plane x = 0", Transform::rotate(Vector3::Y, 90.0)),
        ("in the plane y = 0", Transform::rotate(Vector3::X, 90.0)),
        ("turned", turned),
        ("tiny", scale(1e-3)),
        ("tiny and turned", turned * scale(1e-5)),
        ("huge", turned * scale(1e5)),
        ("mirrored", turned * Transform::scale(Vector3::new(-1.3, 0.8, 1.1))),
        ("far away", Transform::translate(Vector3::new(1000.0, -3000.0, 200.0)) * turned),
        (
            "beside a plane",
            Transform::translate(Vector3::new(70.0, 0.0, 0.0)) * Transform::rotate(Vector3::X, 90.0),
        ),
    ]
}

/// A body alone in the world, or as an instance of a group.
fn scene(body: &Body, place: &Transform, is_instance: bool) -> Scene {
    let mut desc = SceneDesc::default();
    let place = Value::Transform(*place);
    let shapes: Vec<NodeId> = body
        .iter()
        .map(|(kind, params)| {
            let mut params = params.clone();
            if !is_instance {
                params = params.with("world_from_object", place.clone());
            }
            desc.add(Node::new(Family::Shape, *kind, params, Span::NONE))
        })
        .collect();
    if is_instance {
        let group = Params::new().with("shapes", Value::Nodes(shapes));
        let group = desc.add(Node::new(Family::Shape, "group", group, Span::NONE));
        let params = Params::new().with("group", Value::Node(group)).with("world_from_object", place);
        let instance = desc.add(Node::new(Family::Shape, "instance", params, Span::NONE));
        desc.shapes.push(instance);
    } else {
        desc.shapes = shapes;
    }
    compile(&desc, &CompileOptions::default(), &mut Report::default()).expect("is sound")
}

/// For every body, place and way: how many of the rays that leave it, as `leave` makes them, are wrong.
fn for_each(
    bodies: &[(&'static str, Body)],
    mut wrong: impl FnMut(&Scene, &Transform, &mut Pcg32) -> [u32; 2],
) {
    let mut failures = Vec::new();
    for (label, body) in bodies {
        for (whereabouts, place) in places() {
            for is_instance in [false, true] {
                let scene = scene(body, &place, is_instance);
                let [wrong, tested] = wrong(&scene, &place, &mut Pcg32::new(1));
                assert!(tested > 1000, "{label} {whereabouts}: {tested}");
                if wrong > 0 {
                    failures.push(format!("{label} {whereabouts} ({is_instance}): {wrong} of {tested}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn hit(scene: &Scene, ray: &Ray) -> Option<SurfacePoint> {
    scene.closest_hit(ray).map(|hit| scene.interaction(ray, &hit).surface)
}

#[test]
fn nothing_flat_shadows_itself() {
    for_each(&flat(), |scene, place, rng| {
        let mut counts = [0, 0];
        for _ in 0..4000 {
            let target = Point3::new(rng.next_f32() * 2.0 - 1.0, rng.next_f32() * 2.0 - 1.0, 0.0);
            let from = (warp::square_to_uniform_sphere(rng.point2()) * 3.0).to_point();
            let ray = Ray::new(place.point(from), place.point(target) - place.point(from));
            let Some(surface) = hit(scene, &ray) else { continue };
            let w = warp::square_to_uniform_sphere(rng.point2());
            counts[0] += u32::from(scene.occluded(&surface.spawn_ray(w, 0.0)));
            counts[1] += 1;
        }
        counts
    });
}

#[test]
fn closed_bodies_are_dark_inside_and_lit_outside() {
    for_each(&closed(), |scene, place, rng| {
        let mut counts = [0, 0];
        for _ in 0..4000 {
            let inner = warp::square_to_uniform_sphere(rng.point2()) * 0.6;
            let w = warp::square_to_uniform_sphere(rng.point2());
            let ray = Ray::new(place.point(inner.to_point()), place.vector(w));
            let Some(surface) = hit(scene, &ray) else {
                counts[0] += 1;
                continue;
            };
            // Across the edges between two triangles, or over a bent patch, the ball is not quite convex.
            const DENT: f32 = 0.1;
            let outside = place.point((warp::square_to_uniform_sphere(rng.point2()) * 3.0).to_point());
            let towards = outside - surface.p;
            let goes_in = towards.dot(surface.ng) * ray.direction.dot(surface.ng) < 0.0;
            if !goes_in && towards.dot(surface.ng).abs() < DENT * towards.length() {
                continue;
            }
            let leaving = surface.spawn_ray(towards, 0.0).until(1.0 - 1e-5);
            counts[0] += u32::from(scene.occluded(&leaving) != goes_in);
            counts[1] += 1;
        }
        counts
    });
}
