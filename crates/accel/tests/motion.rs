//! Moving things are hit where they are at the ray's time, and masks hide whole geometries, in every structure alike.

use std::sync::Arc;

use aureole_accel::{
    AccelError, Accuracy, Config, Geometry, Hit, Masked, Structure, UserHit, UserShapes, World,
};
use aureole_math::{Bounds3, Motion, Pcg32, Point3, Ray, Transform, Vector3, warp};

const STRUCTURES: [Structure; 4] =
    [Structure::List, Structure::Grid, Structure::Binary, Structure::Hierarchy];
const TIMES: [f32; 9] = [-1.0, 0.0, 0.1, 0.25, 1.0 / 3.0, 0.5, 0.77, 1.0, 7.0];

type Vertices = Arc<[[f32; 3]]>;

/// Small triangles, at several places and with a size that changes.
fn keys(n: usize, keys: usize, rng: &mut Pcg32) -> (Vec<Vertices>, Arc<[[u32; 3]]>) {
    let mut point = |size: f32| [0; 3].map(|_| (rng.next_f32() - 0.5) * size);
    let start: Vec<[f32; 3]> = (0..n).map(|_| point(1.0)).collect();
    let end: Vec<[f32; 3]> = (0..n).map(|_| point(0.5)).collect();
    let shape: Vec<[f32; 3]> = (0..3 * n).map(|_| point(if n < 10 { 0.8 } else { 0.15 })).collect();
    let at = |key: usize| {
        let s = key as f32 / (keys - 1) as f32;
        let vertex =
            |i: usize| [0, 1, 2].map(|a| 0.5 + start[i / 3][a] + s * s * end[i / 3][a] + shape[i][a]);
        (0..3 * n).map(vertex).collect()
    };
    let indices = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    ((0..keys).map(at).collect(), indices)
}

/// The vertices at a time, as the documentation says.
fn vertices(keys: &[Vertices], time: f32) -> Vertices {
    let last = keys.len() - 2;
    let at = time.clamp(0.0, 1.0) * (keys.len() - 1) as f32;
    let i = (at as usize).min(last);
    let share = at - i as f32;
    let between = |a: f32, b: f32| (a + (b - a) * share).max(a.min(b)).min(a.max(b));
    keys[i]
        .iter()
        .zip(&keys[i + 1][..])
        .map(|(a, b)| [0, 1, 2].map(|axis| between(a[axis], b[axis])))
        .collect()
}

/// The same geometries at rest.
fn stopped(geometries: &[Geometry], time: f32) -> Vec<Geometry> {
    let stop = |geometry: &Geometry| match geometry {
        Geometry::MovingTriangles { keys, indices } => {
            Geometry::Triangles { positions: vertices(keys, time), indices: indices.clone() }
        }
        Geometry::MovingInstance { level, world_from_object } => {
            Geometry::Instance { level: level.clone(), world_from_object: world_from_object.at(time).into() }
        }
        still => still.clone(),
    };
    geometries.iter().map(stop).collect()
}

fn rays(n: usize, time: f32, rng: &mut Pcg32) -> Vec<Ray> {
    let eye = Point3::new(0.5, 0.4, -2.0);
    (0..n)
        .map(|i| {
            let mut number = || rng.next_f32() * 1.4 - 0.2;
            let target = Point3::new(number(), number(), number());
            let ray = match i / 16 % 2 {
                // Neighbours for the packets, then rays from anywhere to anywhere.
                0 => Ray::new(
                    eye,
                    Point3::ORIGIN + (target - Point3::ORIGIN) * 0.05 - eye + Vector3::splat(0.4),
                ),
                _ => Ray::new(target, warp::square_to_uniform_sphere(rng.point2())),
            };
            Ray { time, ..ray }
        })
        .collect()
}

/// What all tests ask with: each other kind would be compiled for all structures and instruction sets once more.
type Shapes<'a> = Masked<'a, Ball>;

const ALL: Shapes<'_> = Masked::new(u32::MAX, &Ball);

/// Every structure finds with moving things what the list finds with things at rest where they are then.
fn moves(geometries: &[Geometry], user: &Shapes<'_>, n: usize, masks: &[u32]) {
    let mut rng = Pcg32::new(11);
    let build = |geometries: Vec<Geometry>, structure, accuracy| {
        let config = Config { structure, accuracy, ..Config::default() };
        World::build(geometries, 0, &config).expect("the geometry is sound").with_masks(masks.to_vec())
    };
    for accuracy in [Accuracy::Watertight, Accuracy::Fast] {
        let worlds = STRUCTURES.map(|structure| build(geometries.to_vec(), structure, accuracy));
        let mut found = 0;
        for time in TIMES {
            let still = build(stopped(geometries, time), Structure::List, accuracy);
            let rays = rays(n, time, &mut rng);
            let expected: Vec<_> = rays.iter().map(|ray| still.closest_hit(ray, user)).collect();
            found += expected.iter().flatten().count();
            for (world, structure) in worlds.iter().zip(STRUCTURES) {
                let mut hits = vec![Hit::NONE; n];
                world.closest_hits(&rays, &mut hits, user);
                for ((ray, expected), hit) in rays.iter().zip(&expected).zip(hits) {
                    assert_eq!(world.closest_hit(ray, user), *expected, "{structure:?} {ray:?}");
                    assert_eq!(hit.is_some().then_some(hit), *expected, "{structure:?} {ray:?}");
                    assert_eq!(world.occluded(ray, user), expected.is_some(), "{structure:?} {ray:?}");
                }
            }
        }
        assert!(found > 5, "the test hits something: {found}");
    }
}

fn mesh(n: usize, count: usize, rng: &mut Pcg32) -> Geometry {
    let (keys, indices) = keys(n, count, rng);
    Geometry::MovingTriangles { keys, indices }
}

fn placed(rng: &mut Pcg32) -> Transform {
    let mut vector = || Vector3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
    Transform::translate(vector() * 0.8)
        * Transform::rotate(vector() - Vector3::splat(0.5), 120.0)
        * Transform::scale(vector() * 0.3 + Vector3::splat(0.2))
}

/// Two moving meshes with two keys and one with four, one at rest, and moving instances of moving things.
fn everything() -> Vec<Geometry> {
    let mut rng = Pcg32::new(3);
    let (positions, indices) = keys(40, 2, &mut rng);
    let still = Geometry::Triangles { positions: positions[0].clone(), indices };
    let inner =
        World::build(vec![mesh(30, 3, &mut rng), still.clone()], 1, &Config::default()).expect("sound");
    let level = Arc::new(inner);
    let moving = |rng: &mut Pcg32| Geometry::MovingInstance {
        level: level.clone(),
        world_from_object: Box::new(Motion::new(placed(rng), placed(rng)).expect("sound")),
    };
    vec![
        mesh(100, 2, &mut rng),
        moving(&mut rng),
        still,
        mesh(70, 4, &mut rng),
        moving(&mut rng),
        mesh(20, 2, &mut rng),
    ]
}

#[test]
fn meshes_move() {
    for (n, count) in [(1, 2), (5, 3), (600, 2), (200, 5)] {
        moves(&[mesh(n, count, &mut Pcg32::new(7))], &ALL, 16 * 40, &[]);
    }
}

#[test]
fn everything_moves() {
    moves(&everything(), &ALL, 16 * 60, &[]);
}

#[test]
fn masks_hide_geometries() {
    let geometries = everything();
    let masks = [1, 2, 3, 4, 5]; // the last one has none, and is always seen
    for mask in [1, 2, 4, 8, u32::MAX] {
        moves(&geometries, &Masked::new(mask, &Ball), 16 * 20, &masks);
    }
    // With a mask: what is found with the others taken away.
    let world = World::build(geometries.clone(), 0, &Config::default()).unwrap().with_masks(masks.to_vec());
    let hidden = |keep: u32| {
        let empty = Geometry::User(Vec::new());
        let seen = |i: usize| masks.get(i).is_none_or(|mask| mask & keep != 0);
        let list: Vec<_> = geometries
            .iter()
            .enumerate()
            .map(|(i, g)| if seen(i) { g.clone() } else { empty.clone() })
            .collect();
        World::build(list, 0, &Config::default()).unwrap()
    };
    let mut rng = Pcg32::new(2);
    for keep in [1, 2, 4, 8] {
        let (fewer, user) = (hidden(keep), Masked::new(keep, &Ball));
        let mut differs = false;
        for ray in rays(2000, 0.3, &mut rng) {
            let hit = world.closest_hit(&ray, &user);
            assert_eq!(hit, fewer.closest_hit(&ray, &ALL));
            differs |= hit != world.closest_hit(&ray, &ALL);
        }
        assert!(differs);
    }
}

/// Unit balls around the origin, cut out where u is small.
struct Ball;

impl UserShapes for Ball {
    const HAS_FILTER: bool = true;

    fn intersect(&self, _: u32, _: u32, _: u32, ray: &Ray) -> Option<UserHit> {
        let v = ray.origin.to_vector();
        let (a, b) = (ray.direction.length_squared(), v.dot(ray.direction));
        let d = b * b - a * (v.length_squared() - 1.0);
        let t = (-b - d.sqrt()) / a;
        (d >= 0.0 && t > ray.t_min && t < ray.t_max).then_some(UserHit { t, u: ray.at(t).x, v: 0.0 })
    }

    fn accept(&self, _: u32, hit: &Hit, _: &Ray) -> bool {
        hit.u > 0.1
    }
}

#[test]
fn filters_masks_and_user_shapes_go_together() {
    let mut rng = Pcg32::new(8);
    let unit = Bounds3::new(Point3::splat(-1.0), Point3::splat(1.0));
    let level =
        World::build(vec![Geometry::Balls(vec![unit]), Geometry::User(vec![unit])], 1, &Config::default());
    let level = Arc::new(level.unwrap().with_masks(vec![1, 2]));
    let mut geometries = everything();
    for _ in 0..5 {
        let world_from_object = Box::new(Motion::new(placed(&mut rng), placed(&mut rng)).unwrap());
        geometries.push(Geometry::MovingInstance { level: level.clone(), world_from_object });
    }
    for mask in [1, 3, 4] {
        moves(&geometries, &Masked::new(mask, &Ball), 16 * 20, &[7, 0, 7, 6]);
    }
}

#[test]
fn keys_that_do_not_fit_are_refused() {
    let indices: Arc<[[u32; 3]]> = Arc::from([[0, 1, 2]]);
    let key = |n: usize, x: f32| -> Vertices { vec![[x; 3]; n].into() };
    let build = |keys: Vec<Vertices>| {
        World::build(
            vec![Geometry::MovingTriangles { keys, indices: indices.clone() }],
            0,
            &Config::default(),
        )
    };
    assert_eq!(build(vec![]).unwrap_err(), AccelError::BadKeys { geometry: 0, keys: 0 });
    assert_eq!(build(vec![key(3, 0.0)]).unwrap_err(), AccelError::BadKeys { geometry: 0, keys: 1 });
    assert_eq!(
        build(vec![key(3, 0.0), key(4, 0.0)]).unwrap_err(),
        AccelError::BadKeys { geometry: 0, keys: 2 }
    );
    let broken = build(vec![key(3, 0.0), key(3, f32::NAN)]).unwrap_err();
    assert_eq!(broken, AccelError::NonFinite { geometry: 0, count: 3 });
    assert!(matches!(build(vec![key(2, 0.0), key(2, 0.0)]), Err(AccelError::BadIndex { .. })));
}
