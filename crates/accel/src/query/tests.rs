//! Instruction sets find the same hits.

use aureole_math::{Pcg32, Point3, Vector3};

use super::*;
use crate::simd::Portable;
use crate::{Config, Geometry, NoUserShapes};

fn mesh(rng: &mut Pcg32) -> Geometry {
    let positions = (0..3000).map(|_| [rng.next_f32(), rng.next_f32(), rng.next_f32() * 0.2]).collect();
    // Neighbours share vertices; some triangles are degenerate.
    let indices = (0..4000)
        .map(|_| {
            let first = rng.next_u32() % 2990;
            [first, first + rng.next_u32() % 4, first + rng.next_u32() % 9]
        })
        .collect();
    Geometry::Triangles { positions, indices }
}

fn same<T: TriangleTest>(world: &World, rays: &[Ray]) {
    let empty = vec![Hit::NONE; rays.len()];
    let (mut wide, mut portable) = (empty.clone(), empty);
    simd::run(Closest::<_, T>(world, rays, &mut wide, &NoUserShapes, PhantomData));
    Closest::<_, T>(world, rays, &mut portable, &NoUserShapes, PhantomData).run::<Portable>();
    assert_eq!(wide, portable);
    for (ray, hit) in rays.iter().zip(wide) {
        assert_eq!(ClosestOne::<_, T>(world, ray, &NoUserShapes, PhantomData).run::<Portable>(), hit);
    }
    let (mut wide, mut portable) = (vec![false; rays.len()], vec![false; rays.len()]);
    simd::run(Occluded::<_, T>(world, rays, &mut wide, &NoUserShapes, PhantomData));
    Occluded::<_, T>(world, rays, &mut portable, &NoUserShapes, PhantomData).run::<Portable>();
    assert_eq!(wide, portable);
    for (ray, &blocked) in rays.iter().zip(&wide) {
        assert_eq!(OccludedOne::<_, T>(world, ray, &NoUserShapes, PhantomData).run::<Portable>(), blocked);
    }
    assert!(wide.iter().filter(|hit| **hit).count() > rays.len() / 20);
}

#[test]
fn wide_and_portable_rays_find_the_same_hits() {
    let mut rng = Pcg32::new(31);
    let geometry = mesh(&mut rng);
    // Packets of sixteen neighbours, then rays that have nothing in common.
    let rays: Vec<Ray> = (0..8000)
        .map(|i| {
            let mut point = |size: f32| Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * size;
            let (origin, spread) =
                if i < 4000 { (Point3::new(0.3, 0.4, 2.0), 0.1) } else { (point(1.0), 1.0) };
            let corner = Vector3::new((i / 16 % 10) as f32, (i / 160 % 10) as f32, 0.0) * 0.1;
            Ray::new(origin, point(spread) + corner - origin)
        })
        .collect();
    for accuracy in [Accuracy::Watertight, Accuracy::Fast] {
        let config = Config { accuracy, ..Config::default() };
        let world = World::build(vec![geometry.clone()], 0, &config).expect("the geometry is sound");
        match accuracy {
            Accuracy::Watertight => same::<Watertight>(&world, &rays),
            Accuracy::Fast => same::<Fast>(&world, &rays),
        }
    }
}
