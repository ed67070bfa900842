//! Builds and rays, over meshes made here.

use std::hint::black_box;

use aureole_accel::{Accuracy, Config, Geometry, Hit, NoUserShapes, Quality, Structure, World};
use aureole_math::{Pcg32, Point3, Ray};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// Triangles of a size that fills the unit cube with about the same density however many there are.
fn soup(n: usize) -> Geometry {
    let mut rng = Pcg32::new(1);
    let size = 0.6 / (n as f32).sqrt();
    let mut positions = Vec::new();
    for _ in 0..n {
        let center = [0; 3].map(|_| rng.next_f32());
        positions.extend([0; 3].map(|_| center.map(|c| c + (rng.next_f32() - 0.5) * size * 3.0)));
    }
    let indices = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Geometry::Triangles { positions: positions.into(), indices }
}

/// Tiles of a camera's rays, or rays from anywhere to anywhere.
fn rays(coherent: bool) -> Vec<Ray> {
    let mut rng = Pcg32::new(2);
    let eye = Point3::new(0.5, 0.4, -2.0);
    (0..16 * 1024)
        .map(|i| {
            let mut point = || Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            if coherent {
                let (tile, pixel) = (i / 16, i % 16);
                let at = |tile: usize, pixel: usize| (tile * 4 + pixel) as f32 / 128.0;
                Ray::new(eye, Point3::new(at(tile % 32, pixel % 4), at(tile / 32, pixel / 4), 0.5) - eye)
            } else {
                let (from, to) = (point(), point());
                Ray::new(from, to - from)
            }
        })
        .collect()
}

fn world(n: usize, config: Config) -> World {
    World::build(vec![soup(n)], 0, &config).expect("finite triangles build")
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    for n in [1_000, 100_000] {
        group.throughput(Throughput::Elements(n as u64));
        for quality in [Quality::Fast, Quality::Medium, Quality::High] {
            let config = Config { quality, ..Config::default() };
            group
                .bench_function(BenchmarkId::new(format!("{quality:?}"), n), |b| b.iter(|| world(n, config)));
        }
        for structure in [Structure::Grid, Structure::Binary] {
            let config = Config { structure, ..Config::default() };
            group.bench_function(BenchmarkId::new(format!("{structure:?}"), n), |b| {
                b.iter(|| world(n, config))
            });
        }
    }
    let geometry = [soup(100_000)];
    let mut world = World::build(geometry.to_vec(), 0, &Config::default()).expect("finite triangles build");
    group.bench_function("refit/100000", |b| b.iter(|| world.refit(&geometry).expect("the same geometry")));
    group.finish();
}

fn trace(c: &mut Criterion) {
    let n = 100_000;
    let [camera, random] = [rays(true), rays(false)];
    let mut hits = vec![Hit::NONE; camera.len()];
    let mut group = c.benchmark_group("trace");
    group.sample_size(20).throughput(Throughput::Elements(camera.len() as u64));
    for structure in [Structure::Hierarchy, Structure::Binary, Structure::Grid] {
        for accuracy in [Accuracy::Watertight, Accuracy::Fast] {
            let world = world(n, Config { structure, accuracy, ..Config::default() });
            let name = |kind: &str| format!("{structure:?}/{accuracy:?}/{kind}");
            group.bench_function(name("single"), |b| {
                b.iter(|| random.iter().filter_map(|ray| world.closest_hit(ray, &NoUserShapes)).count());
            });
            group.bench_function(name("occluded"), |b| {
                b.iter(|| random.iter().filter(|ray| world.occluded(ray, &NoUserShapes)).count());
            });
            group.bench_function(name("stream"), |b| {
                b.iter(|| world.closest_hits(&camera, black_box(&mut hits), &NoUserShapes));
            });
        }
    }
    // The list tests everything: few triangles.
    let world = world(300, Config { structure: Structure::List, ..Config::default() });
    group.bench_function("List/Watertight/single", |b| {
        b.iter(|| random.iter().filter_map(|ray| world.closest_hit(ray, &NoUserShapes)).count());
    });
    group.finish();
}

criterion_group!(benches, build, trace);
criterion_main!(benches);
