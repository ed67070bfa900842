//! Triangles against an oracle in double precision that shares no code with the kernels [Möller and Trumbore 1997].

use aureole_accel::{Accuracy, Config, Geometry, NoUserShapes, Structure, World};
use aureole_math::{Pcg32, Point3, Ray, warp};

type Vec3 = [f64; 3];

fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A ray's parameter on a triangle's plane and the least of the three barycentric coordinates there.
fn meet([a, b, c]: [Vec3; 3], origin: Vec3, direction: Vec3) -> (f64, f64) {
    let (e1, e2, s) = (sub(b, a), sub(c, a), sub(origin, a));
    let (p, q) = (cross(direction, e2), cross(s, e1));
    let scale = dot(e1, p).recip();
    let (u, v) = (dot(s, p) * scale, dot(direction, q) * scale);
    (dot(e2, q) * scale, u.min(v).min(1.0 - u - v))
}

/// Rays that pass an edge, the start or the end within a hundred-thousandth are left out: there rounding may decide.
#[test]
fn closest_hits_are_those_of_double_precision() {
    const CLOSE: f64 = 1e-5;
    let mut rng = Pcg32::new(21);
    for (count, size) in [(1, 1.0), (12, 0.6), (200, 0.3)] {
        let positions: Vec<[f32; 3]> = (0..count)
            .flat_map(|_| {
                let center = [rng.next_f32(), rng.next_f32(), rng.next_f32()];
                [(); 3].map(|()| center.map(|c| c + (rng.next_f32() - 0.5) * size))
            })
            .collect();
        let triangles: Vec<[Vec3; 3]> =
            positions.as_chunks::<3>().0.iter().map(|corners| corners.map(|p| p.map(f64::from))).collect();
        let indices = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let geometry = Geometry::Triangles { positions: positions.into(), indices };
        let worlds = [Structure::List, Structure::Hierarchy].into_iter().flat_map(|structure| {
            [Accuracy::Watertight, Accuracy::Fast].map(|accuracy| {
                let config = Config { structure, accuracy, ..Config::default() };
                World::build(vec![geometry.clone()], 0, &config).expect("the geometry is sound")
            })
        });
        let worlds: Vec<World> = worlds.collect();
        let (mut hits, mut tested) = (0, 0);
        for _ in 0..4000 {
            let mut c = || rng.next_f32() * 1.6 - 0.3;
            let ray = Ray::new(Point3::new(c(), c(), c()), warp::square_to_uniform_sphere(rng.point2()));
            let origin = ray.origin.to_array().map(f64::from);
            let direction = ray.direction.to_array().map(f64::from);
            let met: Vec<(f64, f64)> =
                triangles.iter().map(|&triangle| meet(triangle, origin, direction)).collect();
            if met.iter().any(|(t, edge)| edge.abs() < CLOSE || (t.abs() < CLOSE && *edge > 0.0)) {
                continue;
            }
            tested += 1;
            let inside = met.iter().enumerate().filter(|(_, (t, edge))| *t > 0.0 && *edge > 0.0);
            let expected = inside.min_by(|a, b| a.1.0.total_cmp(&b.1.0));
            hits += usize::from(expected.is_some());
            for world in &worlds {
                let found = world.closest_hit(&ray, &NoUserShapes);
                assert_eq!(found.is_some(), expected.is_some(), "{ray:?}: {found:?}, not {expected:?}");
                let (Some(found), Some((i, (t, _)))) = (found, expected) else { continue };
                assert!((f64::from(found.t) - t).abs() < 1e-4 * (1.0 + t), "{ray:?}: {found:?}, not {t}");
                // Of two that are as near, either will do.
                let twins = met.iter().filter(|(other, edge)| *edge > 0.0 && (other - t).abs() < 1e-4);
                assert!(found.primitive as usize == i || twins.count() > 1, "{ray:?}: {found:?}, not {i}");
            }
        }
        assert!(tested > 3000 && hits > 20, "{tested} {hits}");
    }
}
