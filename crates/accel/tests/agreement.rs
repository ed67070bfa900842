//! The hierarchy finds exactly what testing every primitive finds.

use std::sync::Arc;

use aureole_accel::{
    AccelError, Accuracy, Config, Geometry, GridConfig, Hit, Layout, NoUserShapes, Quality, Structure,
    UserHit, UserShapes, Width, World,
};
use aureole_math::{Bounds3, Pcg32, Point3, Ray, Transform, Vector3, warp};

fn soup(n: usize, size: f32, seed: u64) -> Geometry {
    let mut rng = Pcg32::new(seed);
    let mut positions = Vec::new();
    for _ in 0..n {
        let center = [rng.next_f32(), rng.next_f32(), rng.next_f32()];
        for _ in 0..3 {
            positions.push(center.map(|c| c + (rng.next_f32() - 0.5) * size));
        }
    }
    let indices = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Geometry::Triangles { positions: positions.into(), indices }
}

fn rays(n: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Pcg32::new(seed);
    let random = |rng: &mut Pcg32| {
        let mut c = || rng.next_f32() * 1.6 - 0.3;
        Point3::new(c(), c(), c())
    };
    (0..n)
        .map(|i| {
            let origin = random(&mut rng);
            // Every fourth ray runs along an axis, where slabs are hardest.
            let direction = match i % 4 {
                0 => [Vector3::X, -Vector3::Y, Vector3::Z][i / 4 % 3],
                _ => warp::square_to_uniform_sphere(rng.point2()),
            };
            Ray::new(origin, direction).until(if i % 3 == 0 { 0.5 } else { f32::INFINITY })
        })
        .collect()
}

/// Balls in boxes, to stand for user shapes.
struct Balls(Vec<(Point3, f32)>);

impl UserShapes for Balls {
    fn intersect(&self, level: u32, _: u32, primitive: u32, ray: &Ray) -> Option<UserHit> {
        let (center, radius) = self.0[primitive as usize];
        let radius = if level == 0 { radius } else { radius * 0.5 };
        let v = ray.origin - center;
        let a = ray.direction.length_squared();
        let b = v.dot(ray.direction);
        let d = b * b - a * (v.length_squared() - radius * radius);
        if d < 0.0 {
            return None;
        }
        let near = (-b - d.sqrt()) / a;
        let far = (-b + d.sqrt()) / a;
        let inside = |t: &f32| *t > ray.t_min && *t < ray.t_max;
        [near, far].into_iter().find(inside).map(|t| UserHit { t, u: 0.0, v: 0.0 })
    }
}

/// Every structure but the list, every width, every layout.
fn configs() -> Vec<Config> {
    let of = |structure| Config { structure, ..Config::default() };
    let mut configs = [Structure::Grid, Structure::Binary, Structure::Hierarchy].map(of).to_vec();
    configs.extend([Width::Eight, Width::Sixteen].map(|width| Config { width, ..Config::default() }));
    configs.push(Config { layout: Layout::Compact, ..Config::default() });
    configs
}

fn agree<U: UserShapes>(geometries: &[Geometry], user: &U, n: usize) {
    let build =
        |config: &Config| World::build(geometries.to_vec(), 0, config).expect("the geometry is sound");
    let list = build(&Config { structure: Structure::List, ..Config::default() });
    let others: Vec<_> = configs().into_iter().map(|config| (config, build(&config))).collect();
    let mut hits = 0;
    for ray in rays(n, 77) {
        let expected = list.closest_hit(&ray, user);
        assert_eq!(list.occluded(&ray, user), expected.is_some());
        for (config, world) in &others {
            assert_eq!(world.closest_hit(&ray, user), expected, "{config:?} {ray:?}");
            assert_eq!(world.occluded(&ray, user), expected.is_some(), "{config:?} {ray:?}");
        }
        hits += usize::from(expected.is_some());
    }
    assert!(hits > n / 400, "the test hits something");
}

#[test]
fn soups_of_many_sizes() {
    for (n, size) in [(1, 1.0), (7, 0.8), (100, 0.5), (3000, 0.1)] {
        agree(&[soup(n, size, n as u64)], &NoUserShapes, 2000);
    }
}

#[test]
fn everything_together() {
    let mut rng = Pcg32::new(4);
    let balls: Vec<_> =
        (0..50).map(|_| (Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()), 0.05)).collect();
    let boxes: Vec<_> =
        balls.iter().map(|(c, r)| Bounds3::new(*c - Vector3::splat(*r), *c + Vector3::splat(*r))).collect();
    let inner =
        World::build(vec![soup(60, 0.2, 1), Geometry::User(boxes.clone())], 1, &Config::default()).unwrap();
    let level = Arc::new(inner);
    let instance = |x: f32, degrees: f64| Geometry::Instance {
        level: level.clone(),
        world_from_object: Arc::new(
            Transform::translate(Vector3::new(x, 0.1, 0.0))
                * Transform::rotate(Vector3::new(1.0, 2.0, 0.5), degrees)
                * Transform::scale(Vector3::splat(0.4)),
        ),
    };
    let geometries = [soup(200, 0.2, 2), instance(0.0, 20.0), Geometry::User(boxes), instance(0.5, 70.0)];
    agree(&geometries, &Balls(balls), 3000);
}

#[test]
fn coincident_triangles_give_the_smallest_number() {
    let one = soup(1, 1.0, 9);
    let Geometry::Triangles { positions, .. } = &one else { unreachable!() };
    let indices: Arc<[[u32; 3]]> = vec![[0, 1, 2]; 3000].into();
    let many = Geometry::Triangles { positions: positions.clone(), indices };
    let world = World::build(vec![many], 0, &Config::default()).unwrap();
    let hit = rays(5000, 3).iter().find_map(|ray| world.closest_hit(ray, &NoUserShapes)).unwrap();
    assert_eq!(hit.primitive, 0);
}

#[test]
fn nothing_and_nonsense() {
    let empty = World::build(Vec::new(), 0, &Config::default()).unwrap();
    assert!(empty.closest_hit(&Ray::new(Point3::ORIGIN, Vector3::Z), &NoUserShapes).is_none());
    let broken =
        Geometry::Triangles { positions: Arc::from([[f32::NAN; 3]; 3]), indices: Arc::from([[0, 1, 2]]) };
    let error = World::build(vec![broken], 0, &Config::default()).unwrap_err();
    assert_eq!(error, AccelError::NonFinite { geometry: 0, count: 3 });
    let beyond = Geometry::Triangles { positions: Arc::from([[0.0; 3]; 3]), indices: Arc::from([[0, 1, 3]]) };
    assert!(matches!(World::build(vec![beyond], 0, &Config::default()), Err(AccelError::BadIndex { .. })));
    let world = World::build(vec![soup(100, 0.3, 1)], 0, &Config::default()).unwrap();
    for bad in [f32::NAN, f32::INFINITY, 0.0] {
        world.closest_hit(&Ray::new(Point3::ORIGIN, Vector3::splat(bad)), &NoUserShapes);
        world.closest_hit(&Ray::new(Point3::splat(bad), Vector3::Z).until(bad), &NoUserShapes);
    }
}

/// No ray from inside a closed mesh gets out, not even through edges and vertices.
#[test]
fn a_closed_mesh_is_watertight() {
    let n = 24_u32;
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for i in 1..n {
        for j in 0..n {
            let theta = i as f32 / n as f32 * std::f32::consts::PI;
            let phi = j as f32 / n as f32 * std::f32::consts::TAU;
            positions.push(aureole_math::spherical_direction(theta, phi).to_array());
        }
    }
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == n => 1,
        i => 2 + (i - 1) * n + j % n,
    };
    let quads = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let indices: Vec<[u32; 3]> = quads
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2])
        .collect();
    let mesh = Geometry::Triangles { positions: positions.clone().into(), indices: indices.clone().into() };
    let world = World::build(vec![mesh], 0, &Config::default()).unwrap();
    let mut rng = Pcg32::new(8);
    for k in 0..60_000 {
        let origin = Point3::new(rng.next_f32() * 0.4, rng.next_f32() * 0.4, rng.next_f32() * 0.4);
        // Straight at vertices and at points of edges.
        let t = indices[k % indices.len()].map(|i| Point3::from(positions[i as usize]));
        let target = t[0].lerp(t[1], if k % 2 == 0 { 0.0 } else { rng.next_f32() });
        assert!(
            world.closest_hit(&Ray::new(origin, target - origin), &NoUserShapes).is_some(),
            "leak at {target:?}"
        );
    }
}

/// Copies of one triangle in many leaves: rounding of a box's entry must not hide the copy with the smallest number.
#[test]
fn ties_across_leaves_go_to_the_smallest_number() {
    let mut rng = Pcg32::new(21);
    for round in 0..40 {
        let mut positions = Vec::new();
        // Flat in one axis, so that the box is entered exactly where the triangle is.
        let (axis, at) = (round % 3, rng.next_f32());
        for _ in 0..3 {
            let mut p = [rng.next_f32(), rng.next_f32(), rng.next_f32()];
            p[axis] = at;
            positions.push(p);
        }
        let indices: Arc<[[u32; 3]]> = vec![[0, 1, 2]; 200].into();
        agree_somewhere(&[Geometry::Triangles { positions: positions.into(), indices }], round as u64);
    }
}

/// The hierarchy and the list agree on oblique rays from near and far.
fn agree_somewhere(geometries: &[Geometry], seed: u64) {
    let build =
        |config: &Config| World::build(geometries.to_vec(), 0, config).expect("finite triangles build");
    let list = build(&Config { structure: Structure::List, ..Config::default() });
    let trees: Vec<_> = configs().iter().map(build).collect();
    let mut rng = Pcg32::new(seed);
    for _ in 0..4000 {
        let direction = warp::square_to_uniform_sphere(rng.point2());
        let target = Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let ray = Ray::new(target - direction * (rng.next_f32() * 40.0), direction);
        let expected = list.closest_hit(&ray, &NoUserShapes);
        for tree in &trees {
            assert_eq!(tree.closest_hit(&ray, &NoUserShapes), expected, "{ray:?}");
        }
    }
}

/// Rays of a camera that looks at the unit cube, neighbours together.
fn camera(n: usize, eye: Point3) -> Vec<Ray> {
    let mut rng = Pcg32::new(9);
    (0..n)
        .map(|i| {
            let (tile, pixel) = (i / 16, i % 16);
            let mut at =
                |cell: usize, fine: usize| (cell as f32 + (fine as f32 + rng.next_f32()) / 4.0) / 16.0;
            let (x, y) = (at(tile % 16, pixel % 4), at(tile / 16 % 16, pixel / 4));
            let target = Point3::new(x, y, rng.next_f32() * 0.01);
            Ray::new(eye, target - eye)
        })
        .collect()
}

#[test]
fn packets_find_what_single_rays_find() {
    for (n, size) in [(1, 1.0), (40, 0.7), (5000, 0.1)] {
        for accuracy in [Accuracy::Watertight, Accuracy::Fast] {
            for eye in [Point3::new(0.4, 0.3, 3.0), Point3::new(-2.0, 0.5, 0.5), Point3::new(0.5, 0.5, 0.5)] {
                let config = Config { accuracy, ..Config::default() };
                let world = World::build(vec![soup(n, size, 4)], 0, &config).expect("the geometry is sound");
                let mut rays = camera(16 * 256, eye);
                // Odd ones among them disturb no others: with no numbers, with an end, along an axis.
                rays[7].direction.x = f32::NAN;
                rays[39].t_max = f32::NAN;
                (300..330).for_each(|i| rays[i] = rays[i].until(if i % 2 == 0 { 1.0 } else { 0.8 }));
                rays[400..432].iter_mut().for_each(|ray| ray.direction = Vector3::new(-0.0, 0.0, -1.0));
                let mut hits = vec![Hit::NONE; rays.len()];
                world.closest_hits(&rays, &mut hits, &NoUserShapes);
                let mut blocked = vec![false; rays.len()];
                world.occluded_many(&rays, &mut blocked, &NoUserShapes);
                for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(blocked) {
                    assert_eq!(
                        hit.is_some().then_some(*hit),
                        world.closest_hit(ray, &NoUserShapes),
                        "{ray:?}"
                    );
                    assert_eq!(hit.is_some(), blocked, "{ray:?}");
                }
                assert!(hits.iter().any(Hit::is_some) || n == 1);
            }
        }
    }
}

#[test]
fn the_fast_test_finds_the_same_in_every_structure() {
    let build = |config: Config| {
        let config = Config { accuracy: Accuracy::Fast, ..config };
        World::build(vec![soup(3000, 0.1, 8)], 0, &config).expect("the geometry is sound")
    };
    let list = build(Config { structure: Structure::List, ..Config::default() });
    let others: Vec<_> = configs().into_iter().map(build).collect();
    for ray in rays(3000, 5) {
        let expected = list.closest_hit(&ray, &NoUserShapes);
        for world in &others {
            assert_eq!(world.closest_hit(&ray, &NoUserShapes), expected);
        }
    }
}

#[test]
fn qualities_and_overlap_tests_change_no_hit() {
    let geometry = [soup(3000, 0.1, 8), soup(20, 2.0, 9)];
    let build = |config: Config| World::build(geometry.to_vec(), 0, &config).expect("the geometry is sound");
    let expected = build(Config::default());
    let mut configs =
        [Quality::Fast, Quality::High].map(|quality| Config { quality, ..Config::default() }).to_vec();
    for (density, exact, crowded) in
        [(0.1, true, 2), (0.1, false, 32), (1.0, false, usize::MAX), (30.0, true, 2)]
    {
        let grid = GridConfig { density, exact, crowded };
        configs.push(Config { structure: Structure::Grid, grid, ..Config::default() });
    }
    for config in configs {
        let world = build(config);
        for ray in rays(2000, 6) {
            let hit = world.closest_hit(&ray, &NoUserShapes);
            assert_eq!(hit, expected.closest_hit(&ray, &NoUserShapes), "{config:?}");
        }
    }
}

#[test]
fn a_compact_layout_takes_less_memory() {
    let bytes = |config: Config| {
        let world = World::build(vec![soup(20_000, 0.02, 8)], 0, &config).expect("the geometry is sound");
        world.stats().bytes
    };
    let (fast, compact) =
        (bytes(Config::default()), bytes(Config { layout: Layout::Compact, ..Config::default() }));
    assert!(compact * 4 < fast, "{compact} {fast}");
}
