//! Every builder makes sound structures out of anything, and fits them to things that move.

use std::sync::Arc;

use aureole_accel::{
    AccelError, Accuracy, Config, Defect, Geometry, GridConfig, Hit, Layout, NoUserShapes, Quality, Stats,
    Structure, Width, World,
};
use aureole_math::{Bounds3, Pcg32, Point3, Ray, Transform, Vector3, warp};

type Vertices = Vec<[f32; 3]>;

fn configs() -> Vec<Config> {
    let mut configs = Vec::new();
    for accuracy in [Accuracy::Watertight, Accuracy::Fast] {
        for quality in [Quality::Fast, Quality::Medium, Quality::High] {
            configs.push(Config { accuracy, quality, ..Config::default() });
        }
        for structure in [Structure::List, Structure::Grid, Structure::Binary] {
            configs.push(Config { accuracy, structure, ..Config::default() });
        }
        configs.push(Config { accuracy, width: Width::Sixteen, ..Config::default() });
        configs.push(Config { accuracy, layout: Layout::Compact, ..Config::default() });
    }
    configs
}

/// Three vertices a triangle.
fn mesh(vertices: &Vertices) -> Geometry {
    let indices = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Geometry::Triangles { positions: vertices.clone().into(), indices }
}

fn soup(n: usize, size: f32, seed: u64) -> Vertices {
    let mut rng = Pcg32::new(seed);
    let mut vertices = Vec::new();
    for _ in 0..n {
        let center = [0; 3].map(|_| rng.next_f32());
        vertices.extend([0; 3].map(|_| center.map(|c| c + (rng.next_f32() - 0.5) * size)));
    }
    vertices
}

/// Long, thin triangles in all directions among small ones.
fn sticks(n: usize) -> Vertices {
    let mut rng = Pcg32::new(40);
    let mut vertices = soup(n, 0.02, 41);
    for t in vertices.chunks_exact_mut(3).step_by(5) {
        t[1] = [0; 3].map(|_| rng.next_f32());
    }
    vertices
}

fn rays(n: usize, bounds: &Bounds3, seed: u64) -> Vec<Ray> {
    let mut rng = Pcg32::new(seed);
    let size = bounds.diagonal();
    let mut point = |grow: f32| {
        let mut at = |axis: usize| bounds.min[axis] + size[axis] * (0.5 + grow * (rng.next_f32() - 0.5));
        Point3::new(at(0), at(1), at(2))
    };
    (0..n).map(|_| (point(3.0), point(1.0))).map(|(from, to)| Ray::new(from, to - from)).collect()
}

fn build(geometries: &[Geometry], config: &Config) -> World {
    World::build(geometries.to_vec(), 0, config).expect("the geometry is sound")
}

fn find(world: &World, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::NONE; rays.len()];
    world.closest_hits(rays, &mut hits, &NoUserShapes);
    for (ray, hit) in rays.iter().zip(&hits).step_by(7) {
        assert_eq!(world.closest_hit(ray, &NoUserShapes).unwrap_or(Hit::NONE), *hit);
        assert_eq!(world.occluded(ray, &NoUserShapes), hit.is_some());
    }
    hits
}

/// Sound, and the hits of the list, with every builder.
fn sound(vertices: &Vertices) {
    let geometries = [mesh(vertices)];
    for accuracy in [Accuracy::Watertight, Accuracy::Fast] {
        let list = build(&geometries, &Config { accuracy, structure: Structure::List, ..Config::default() });
        let rays = rays(600, &list.bounds(), 5);
        let expected = find(&list, &rays);
        for config in configs().into_iter().filter(|config| config.accuracy == accuracy) {
            let world = build(&geometries, &config);
            let stats = world.validate().unwrap_or_else(|defect| panic!("{config:?}: {defect}"));
            assert_eq!(stats.primitives, vertices.len() / 3, "{config:?}");
            assert!(stats.references >= stats.primitives && stats.bytes > 0 || vertices.is_empty());
            assert_eq!(find(&world, &rays), expected, "{config:?}");
        }
    }
}

#[test]
fn soups_are_sound() {
    for (n, size) in [(1, 1.0), (2, 1.0), (9, 0.5), (300, 0.5), (4000, 0.05)] {
        sound(&soup(n, size, n as u64));
    }
}

#[test]
fn long_triangles_are_sound() {
    sound(&sticks(2000));
}

#[test]
fn nothing_is_sound() {
    for config in configs() {
        for geometries in [vec![], vec![mesh(&Vec::new())], vec![Geometry::User(Vec::new())]] {
            let world = build(&geometries, &config);
            assert_eq!(world.validate().map(|stats| stats.primitives), Ok(0));
            assert!(world.bounds().is_empty());
            assert_eq!(world.closest_hit(&Ray::new(Point3::ORIGIN, Vector3::Z), &NoUserShapes), None);
        }
    }
}

#[test]
fn thousands_in_one_place_are_sound() {
    sound(&soup(1, 1.0, 3).repeat(3000));
    // With their centres in one place only.
    let nested = (1..2000).flat_map(|i| {
        let s = i as f32 * 1e-3;
        [[-s, -s, 0.5 * s], [s, -s, -0.2 * s], [0.0, 2.0 * s, -0.3 * s]]
    });
    sound(&nested.collect());
}

#[test]
fn degenerate_triangles_are_sound() {
    let mut vertices = soup(500, 0.3, 6);
    for (i, t) in vertices.chunks_exact_mut(3).enumerate() {
        match i % 4 {
            0 => t[2] = t[1],                                       // a line
            1 => (t[1], t[2]) = (t[0], t[0]),                       // a point
            2 => t[2] = [0, 1, 2].map(|a| 2.0 * t[1][a] - t[0][a]), // along one edge
            _ => {}
        }
    }
    sound(&vertices);
    sound(&vec![[0.3; 3]; 900]);
}

#[test]
fn huge_tiny_and_flat_things_are_sound() {
    let scaled = |scale: [f32; 3]| {
        soup(700, 0.2, 7).into_iter().map(|p| [0, 1, 2].map(|a| p[a] * scale[a])).collect::<Vertices>()
    };
    sound(&scaled([1e9; 3]));
    sound(&scaled([1e-9; 3]));
    sound(&scaled([1e6, 1e-4, 1.0]));
    sound(&scaled([1.0, 1.0, 0.0]));
    // Far beyond what areas and products can hold: no panic, whatever is hit.
    for scale in [1e-38, 1e25, 3e38] {
        let vertices = scaled([scale; 3]);
        for config in configs() {
            let world = build(&[mesh(&vertices)], &config);
            assert_eq!(world.validate().map(|stats| stats.primitives), Ok(700), "{config:?} {scale}");
            find(&world, &rays(50, &world.bounds(), 8));
        }
    }
}

#[test]
fn broken_vertices_are_counted() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut vertices = soup(100, 0.1, 1);
        for i in [5, 17, 299] {
            vertices[i][i % 3] = bad;
        }
        for config in configs() {
            let error = World::build(vec![mesh(&soup(3, 0.1, 2)), mesh(&vertices)], 0, &config).unwrap_err();
            assert_eq!(error, AccelError::NonFinite { geometry: 1, count: 3 });
        }
        let boxes = vec![Bounds3 { min: Point3::ORIGIN, max: Point3::splat(bad) }; 2];
        let error = World::build(vec![Geometry::User(boxes)], 0, &Config::default()).unwrap_err();
        assert_eq!(error, AccelError::NonFinite { geometry: 0, count: 2 });
    }
}

/// More triangles than references can number are refused, before anything is allocated for them.
#[test]
fn too_many_are_refused() {
    let million: Arc<[[u32; 3]]> = vec![[0, 1, 2]; 1 << 20].into();
    let positions: Arc<[[f32; 3]]> = vec![[0.0; 3]; 3].into();
    let mesh = Geometry::Triangles { positions, indices: million };
    let error = World::build(vec![mesh; 128], 0, &Config::default()).unwrap_err();
    assert_eq!(error, AccelError::TooMany(1 << 27));
}

#[test]
fn high_is_never_expected_to_cost_more_than_medium() {
    for vertices in [sticks(3000), soup(1000, 1.0, 3), soup(5000, 0.02, 4)] {
        let cost = |quality| build(&[mesh(&vertices)], &Config { quality, ..Config::default() }).stats();
        let (medium, high): (Stats, Stats) = (cost(Quality::Medium), cost(Quality::High));
        assert!(high.sah_cost < 1.02 * medium.sah_cost, "{high:?} {medium:?}");
        assert!(high.references <= 2 * high.primitives, "{high:?}");
    }
    let vertices = sticks(3000);
    let cost = |quality| build(&[mesh(&vertices)], &Config { quality, ..Config::default() }).stats().sah_cost;
    assert!(cost(Quality::High) < 0.9 * cost(Quality::Medium));
}

/// A mesh, boxes and instances at a time.
fn moving(time: f32, config: &Config) -> Vec<Geometry> {
    let wave = |p: [f32; 3]| [p[0] + 0.2 * time * (9.0 * p[1]).sin(), p[1], p[2] + 0.3 * time * p[0]];
    let vertices: Vertices = soup(1500, 0.1, 12).into_iter().map(wave).collect();
    let level = Arc::new(World::build(vec![mesh(&soup(50, 0.3, 9))], 1, config).expect("sound"));
    let mut all = vec![mesh(&vertices), mesh(&soup(20, 0.4, 15))];
    for i in 0..30 {
        let at =
            Vector3::new(i as f32 * 0.05, 0.5, 0.1) + Vector3::new(0.0, 0.3, 0.2) * (time * i as f32 * 0.1);
        let world_from_object = Transform::translate(at) * Transform::scale(Vector3::splat(0.1));
        all.push(Geometry::Instance { level: level.clone(), world_from_object: world_from_object.into() });
    }
    all
}

#[test]
fn refitted_worlds_find_what_new_ones_find() {
    for config in configs() {
        let mut world = build(&moving(0.0, &config), &config).with_masks(vec![1]);
        let before = world.validate().expect("sound");
        assert!((before.degradation() - 1.0).abs() < 1e-3);
        let is_built_anew = config.width == Width::Sixteen || config.layout == Layout::Compact;
        for time in [0.1, 0.5, 1.0, -1.0] {
            let now = moving(time, &config);
            world.refit(&now).expect("the same primitives");
            let fresh = build(&now, &config);
            assert_eq!(world.bounds(), fresh.bounds());
            let stats = world.validate().unwrap_or_else(|defect: Defect| panic!("{config:?}: {defect}"));
            if config.structure == Structure::Hierarchy && !is_built_anew {
                assert!(stats.nodes == before.nodes && stats.depth == before.depth, "{stats:?}");
                assert!(stats.sah_cost > 0.99 * fresh.stats().sah_cost, "{stats:?}");
            }
            let rays = rays(700, &fresh.bounds(), 3);
            assert_eq!(find(&world, &rays), find(&fresh, &rays), "{config:?} {time}");
        }
        // Back where it began, it is as good as new, but for what was cut.
        world.refit(&moving(0.0, &config)).expect("the same primitives");
        let ratio = world.validate().expect("sound").degradation();
        assert!((0.999..1.5).contains(&ratio), "{ratio}");
    }
}

#[test]
fn a_refit_tells_how_much_worse_it_is() {
    let vertices = soup(3000, 0.03, 8);
    for structure in [Structure::Hierarchy, Structure::Binary] {
        let mut world = build(&[mesh(&vertices)], &Config { structure, ..Config::default() });
        // All together move: nothing changes. They change places: everything does.
        let aside: Vertices = vertices.iter().map(|p| p.map(|x| x + 1.0)).collect();
        world.refit(&[mesh(&aside)]).expect("the same primitives");
        let ratio = world.stats().degradation();
        assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
        let other = soup(3000, 0.03, 9);
        world.refit(&[mesh(&other)]).expect("the same primitives");
        let ratio = world.stats().degradation();
        assert!(ratio > 3.0, "{ratio}");
    }
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let config = Config::default();
    let mut world = build(&moving(0.0, &config), &config);
    let rays = rays(300, &world.bounds(), 3);
    let before = find(&world, &rays);
    let mut other = moving(0.5, &config);
    other[1] = mesh(&soup(21, 0.4, 15));
    assert_eq!(world.refit(&other), Err(AccelError::Changed { geometry: 1 }));
    other.truncate(1);
    assert_eq!(world.refit(&other), Err(AccelError::Changed { geometry: 1 }));
    let mut broken = moving(0.5, &config);
    broken[1] = mesh(&vec![[f32::NAN; 3]; 60]);
    assert_eq!(world.refit(&broken), Err(AccelError::NonFinite { geometry: 1, count: 60 }));
    assert_eq!(find(&world, &rays), before);
}

#[test]
fn levels_are_told_apart() {
    let world = build(&moving(0.0, &Config::default()), &Config::default());
    let levels = world.stats_of_levels();
    let told: Vec<_> = levels.iter().map(|(tag, stats)| (*tag, stats.primitives)).collect();
    assert_eq!(told, [(0, 1520 + 30), (1, 50)]);
    assert!(levels[0].1.mean_children() > 4.0 && levels[0].1.bytes_a_primitive() > 30.0, "{levels:?}");
}

#[test]
fn grids_of_any_density_are_sound() {
    let vertices = soup(2000, 0.3, 2);
    for (density, exact) in [(0.01, true), (1.0, false), (40.0, true), (1000.0, false)] {
        let grid = GridConfig { density, exact, ..GridConfig::default() };
        let world =
            build(&[mesh(&vertices)], &Config { structure: Structure::Grid, grid, ..Config::default() });
        assert_eq!(world.validate().map(|stats| stats.primitives), Ok(2000));
    }
}

#[test]
fn a_teapot_in_a_stadium_has_a_grid_of_its_own() {
    let mut vertices = soup(2000, 0.1, 2);
    vertices.extend(soup(20, 0.1, 3).iter().map(|p| p.map(|x| (x - 0.5) * 1000.0)));
    let stats = |crowded| {
        let grid = GridConfig { crowded, ..GridConfig::default() };
        let world =
            build(&[mesh(&vertices)], &Config { structure: Structure::Grid, grid, ..Config::default() });
        world.validate().expect("a sound grid")
    };
    let (flat, nested) = (stats(usize::MAX), stats(32));
    // Without it, all the triangles are in a handful of cells.
    assert!(flat.references < 2 * 2020, "{flat:?}");
    assert!(nested.leaves > flat.leaves + 1000, "{nested:?}");
}

/// Random rays through everything against the list: small here, ten million in `examples/random_rays.rs`.
#[test]
fn random_rays_find_the_same() {
    let mut rng = Pcg32::new(99);
    let geometries = [mesh(&sticks(1500)), mesh(&soup(800, 0.3, 77))];
    let rays: Vec<Ray> = (0..20_000)
        .map(|_| {
            let origin =
                Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - Vector3::splat(0.5);
            Ray::new(origin, warp::square_to_uniform_sphere(rng.point2()))
        })
        .collect();
    for accuracy in [Accuracy::Watertight, Accuracy::Fast] {
        let of = |structure| build(&geometries, &Config { structure, accuracy, ..Config::default() });
        let expected = find(&of(Structure::List), &rays);
        for structure in [Structure::Grid, Structure::Binary, Structure::Hierarchy] {
            assert_eq!(find(&of(structure), &rays), expected, "{structure:?} {accuracy:?}");
        }
    }
}
