//! Random rays by the million: grid, binary and wide hierarchies of every quality must find what the list finds.
//!
//! `cargo run --release -p aureole-accel --example random_rays [RAYS]`, ten million without a number.

#![expect(clippy::print_stdout, reason = "a program that tells what it found")]

use aureole_accel::{
    Accuracy, Config, Geometry, Hit, Layout, NoUserShapes, Quality, Structure, Width, World,
};
use aureole_math::{Pcg32, Point3, Ray, Vector3, warp};
use rayon::prelude::*;

/// Small triangles, long ones, some in one place, some in a plane, some that are none.
fn triangles(n: usize) -> Geometry {
    let mut rng = Pcg32::new(7);
    let mut positions: Vec<[f32; 3]> = Vec::new();
    for i in 0..n {
        let center = [0; 3].map(|_| rng.next_f32());
        let size = if i % 10 == 0 { 0.6 } else { 0.1 };
        let mut corners = [0; 3].map(|_| center.map(|c| c + (rng.next_f32() - 0.5) * size));
        match i % 50 {
            1 => corners = [0; 3].map(|_| [0.25, rng.next_f32(), rng.next_f32()]),
            2 => corners[2] = corners[1],
            3 if i > 50 => corners.copy_from_slice(&positions[3 * (i - 50)..3 * (i - 49)]),
            _ => {}
        }
        positions.extend(corners);
    }
    let indices = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Geometry::Triangles { positions: positions.into(), indices }
}

fn rays(count: usize, rng: &mut Pcg32) -> Vec<Ray> {
    let random = |rng: &mut Pcg32| Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        // Sixteen from one place into one direction, more or less; every other time into all of them.
        let (eye, target) = (random(rng) * 2.0 - Vector3::splat(0.5), random(rng));
        let spread = if rng.next_f32() < 0.5 { 0.02 } else { 10.0 };
        rays.extend((0..16).map(|_| {
            let aside = warp::square_to_uniform_sphere(rng.point2()) * spread;
            Ray::new(eye, target - eye + aside).until(if rng.next_f32() < 0.2 { 0.7 } else { f32::INFINITY })
        }));
    }
    rays
}

const BATCH: usize = 100_000;

/// How many rays hit something, and how many differences there are to the first world.
fn compare(worlds: &[(Config, World)], rays: &[Ray]) -> [usize; 2] {
    let (mut found, mut wrong) = (0, 0);
    let mut expected = Vec::new();
    for (config, world) in worlds {
        let mut hits = vec![Hit::NONE; rays.len()];
        world.closest_hits(rays, &mut hits, &NoUserShapes);
        if expected.is_empty() {
            found = hits.iter().filter(|hit| hit.is_some()).count();
            expected = hits;
            continue;
        }
        for ((ray, hit), expected) in rays.iter().zip(&hits).zip(&expected) {
            let single = world.closest_hit(ray, &NoUserShapes).unwrap_or(Hit::NONE);
            let blocked = world.occluded(ray, &NoUserShapes);
            if hit != expected || single != *expected || blocked != hit.is_some() {
                wrong += 1;
                println!("{config:?}: {hit:?} and {single:?} instead of {expected:?} for {ray:?}");
            }
        }
    }
    [found, wrong]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let count: usize = std::env::args().nth(1).map_or(Ok(10_000_000), |n| n.parse())?;
    let geometry = [triangles(600)];
    let worlds = |accuracy| -> Result<_, Box<dyn std::error::Error>> {
        let config = Config { accuracy, ..Config::default() };
        let structures = [Structure::List, Structure::Grid, Structure::Binary];
        let mut configs = structures.map(|structure| Config { structure, ..config }).to_vec();
        configs.extend(
            [Quality::Fast, Quality::Medium, Quality::High].map(|quality| Config { quality, ..config }),
        );
        configs.push(Config { width: Width::Sixteen, ..config });
        configs.push(Config { layout: Layout::Compact, ..config });
        let build = |config: Config| Ok((config, World::build(geometry.to_vec(), 0, &config)?));
        configs.into_iter().map(build).collect()
    };
    let kinds: [Vec<(Config, World)>; 2] = [worlds(Accuracy::Watertight)?, worlds(Accuracy::Fast)?];
    let of_batch = |batch: usize| {
        let rays = rays(BATCH.min(count - batch * BATCH), &mut Pcg32::new(batch as u64));
        kinds.iter().map(|worlds| compare(worlds, &rays)).fold([0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
    };
    let sum = |a: [usize; 2], b: [usize; 2]| [a[0] + b[0], a[1] + b[1]];
    let [found, wrong] = (0..count.div_ceil(BATCH)).into_par_iter().map(of_batch).reduce(|| [0; 2], sum);
    println!("{count} rays with two kinds of triangle tests, {found} hits, {wrong} differences");
    if wrong == 0 { Ok(()) } else { Err("structures disagree".into()) }
}
