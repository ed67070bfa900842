//! `aureole bench lecture`: the frame of which a lecture says that it takes 109 hours.
//!
//! 1280 x 1024 pixels, 10 rays each, 3 levels, 1000 triangles: 39,321,600,000 tests, at 100,000 tests a second.

use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use aureole::accel::{Accuracy, Config, Geometry, Hit, NoUserShapes, Structure, World};
use aureole::math::{Pcg32, Point3, Ray, Vector3};
use clap::Args;
use serde::Serialize;

use crate::command::json_line;
use crate::exit::{Exit, Failure};
use crate::output::print;

const WIDTH: usize = 1280;
const HEIGHT: usize = 1024;
const RAYS_PER_PIXEL: usize = 10;
const LEVELS: usize = 3;
const TRIANGLES: usize = 1000;
/// What the slide comes to.
const SLIDE_SECONDS: f64 = (WIDTH * HEIGHT * RAYS_PER_PIXEL * LEVELS * TRIANGLES) as f64 / 100_000.0;
/// Pixels that are traced at once: a square, whose rays have about one direction.
const TILE: usize = 16;
/// Of how many tiles the list does one.
const LIST_TILES: usize = 128;

/// How to measure.
#[derive(Args, Clone, Debug)]
pub(crate) struct LectureArgs {
    /// Threads; 0 for as many as there are processors
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
    /// Print one JSON object a line
    #[arg(long)]
    pub json: bool,
}

/// What a structure achieves.
#[derive(Debug, Serialize)]
struct Row {
    structure: String,
    threads: usize,
    triangles: usize,
    rays: usize,
    build_seconds: f64,
    /// For the whole frame.
    seconds: f64,
    /// Whether only a part of the frame was traced.
    extrapolated: bool,
    million_rays_per_second: f64,
    /// Tests of a ray against a triangle, where their number is known.
    million_tests_per_second: Option<f64>,
    times_faster_than_slide: f64,
    /// Sum of the ray parameters of all hits.
    sum_t: f64,
}

/// Traces the frame with each structure.
pub(crate) fn run(args: &LectureArgs) -> Result<(), Failure> {
    let threads = match args.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    };
    let room = Room::new();
    let structures = [Structure::List, Structure::Grid, Structure::Binary, Structure::Hierarchy]
        .map(|s| (s, Accuracy::Watertight));
    for (structure, accuracy) in structures.into_iter().chain([(Structure::Hierarchy, Accuracy::Fast)]) {
        let config = Config { structure, accuracy, ..Config::default() };
        let start = Instant::now();
        let geometry =
            Geometry::Triangles { positions: room.positions.clone(), indices: room.indices.clone() };
        let world = World::build(vec![geometry], 0, &config)
            .map_err(|error| Failure::new(Exit::Failed, error.to_string()))?;
        let build_seconds = start.elapsed().as_secs_f64();
        let frame = Frame { world, room: &room };
        let every = if structure == Structure::List { LIST_TILES } else { 1 };
        let row = measure(&frame, threads, every, &format!("{structure:?}, {accuracy:?}"), build_seconds);
        print(&if args.json { json_line(&row)? } else { text(&row) })?;
    }
    Ok(())
}

fn text(row: &Row) -> String {
    let mut line = format!(
        "{:24} {:9.2} s  {:8.2} million rays a second  {:10.0} times faster than the slide's 109 hours",
        row.structure, row.seconds, row.million_rays_per_second, row.times_faster_than_slide,
    );
    if let Some(tests) = row.million_tests_per_second {
        let _ = write!(line, "  {tests:.0} million tests a second");
    }
    if row.extrapolated {
        line += "  (from a part of the frame)";
    }
    line + "\n"
}

/// A closed room with triangles in it, so that every ray hits something and every level is traced.
struct Room {
    positions: Arc<[[f32; 3]]>,
    indices: Arc<[[u32; 3]]>,
}

impl Room {
    fn new() -> Self {
        let mut rng = Pcg32::new(1000);
        let mut positions: Vec<[f32; 3]> =
            (0..8).map(|i| [0, 1, 2].map(|axis| if (i >> axis) & 1 == 1 { 2.0 } else { -2.0 })).collect();
        let walls = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let mut indices: Vec<[u32; 3]> =
            walls.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        while indices.len() < TRIANGLES {
            let center: [f32; 3] = std::array::from_fn(|_| rng.next_f32() * 2.0 - 1.0);
            let first = positions.len() as u32;
            positions.extend((0..3).map(|_| center.map(|x| x + (rng.next_f32() - 0.5) * 0.2)));
            indices.push([first, first + 1, first + 2]);
        }
        Self { positions: positions.into(), indices: indices.into() }
    }
}

struct Frame<'a> {
    world: World,
    room: &'a Room,
}

fn measure(frame: &Frame<'_>, threads: usize, every: usize, structure: &str, build_seconds: f64) -> Row {
    let tiles = (WIDTH / TILE) * (HEIGHT / TILE);
    let next = AtomicUsize::new(0);
    let start = Instant::now();
    let sums: Vec<(f64, usize)> = std::thread::scope(|scope| {
        let work = || {
            let mut sum = (0.0, 0);
            loop {
                let tile = next.fetch_add(every, Ordering::Relaxed);
                if tile >= tiles {
                    return sum;
                }
                let (t, rays) = frame.trace(tile);
                sum = (sum.0 + t, sum.1 + rays);
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().filter_map(|worker| worker.join().ok()).collect()
    });
    let traced: usize = sums.iter().map(|sum| sum.1).sum();
    let rays = WIDTH * HEIGHT * RAYS_PER_PIXEL * LEVELS;
    let seconds = start.elapsed().as_secs_f64() * rays as f64 / traced as f64;
    let rate = rays as f64 / 1e6 / seconds;
    Row {
        structure: structure.to_owned(),
        threads,
        triangles: frame.room.indices.len(),
        rays,
        build_seconds,
        seconds,
        extrapolated: traced < rays,
        million_rays_per_second: rate,
        million_tests_per_second: structure
            .starts_with("List")
            .then_some(rate * frame.room.indices.len() as f64),
        times_faster_than_slide: SLIDE_SECONDS / seconds,
        sum_t: sums.iter().map(|sum| sum.0).sum(),
    }
}

impl Frame<'_> {
    /// Traces the rays of a tile through all levels; the sum of the hits' t and the number of rays.
    fn trace(&self, tile: usize) -> (f64, usize) {
        let mut rays = camera_rays(tile);
        let mut hits = vec![Hit::NONE; rays.len()];
        let mut sum = 0.0;
        let mut count = 0;
        for level in 0..LEVELS {
            self.world.closest_hits(&rays, &mut hits, &NoUserShapes);
            count += rays.len();
            sum += hits.iter().filter(|hit| hit.is_some()).map(|hit| f64::from(hit.t)).sum::<f64>();
            if level + 1 < LEVELS {
                for (ray, hit) in rays.iter_mut().zip(&hits).filter(|(_, hit)| hit.is_some()) {
                    *ray = self.reflected(ray, hit);
                }
            }
        }
        (sum, count)
    }

    fn reflected(&self, ray: &Ray, hit: &Hit) -> Ray {
        let [a, b, c] =
            self.room.indices[hit.primitive as usize].map(|i| Point3::from(self.room.positions[i as usize]));
        let n = (b - a).cross(c - a).normalized();
        let direction = ray.direction - n * (2.0 * n.dot(ray.direction));
        Ray { t_min: 1e-4, ..Ray::new(ray.at(hit.t), direction) }
    }
}

/// The rays of a square of pixels, pixel by pixel.
fn camera_rays(tile: usize) -> Vec<Ray> {
    let mut rng = Pcg32::new(tile as u64);
    let corner = [tile % (WIDTH / TILE) * TILE, tile / (WIDTH / TILE) * TILE];
    let mut rays = Vec::with_capacity(TILE * TILE * RAYS_PER_PIXEL);
    for pixel in 0..TILE * TILE {
        let [x, y] = [corner[0] + pixel % TILE, corner[1] + pixel / TILE];
        for _ in 0..RAYS_PER_PIXEL {
            let across = (x as f32 + rng.next_f32() - 0.5 * WIDTH as f32) / WIDTH as f32;
            let down = (y as f32 + rng.next_f32() - 0.5 * HEIGHT as f32) / WIDTH as f32;
            let direction = Vector3::new(across, -down, 1.0).normalized();
            rays.push(Ray::new(Point3::new(0.0, 0.0, -1.9), direction));
        }
    }
    rays
}
