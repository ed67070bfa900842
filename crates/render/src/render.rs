//! The loop over passes and tiles.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use aureole_desc::SceneError;
use aureole_elements::camera::CameraSample;
use aureole_elements::sampler::SampleKey;
use aureole_image::{Image, Window};
use aureole_math::{Point2, Vector2};
use aureole_scene::{Crop, Scene};
use aureole_spectrum::Spectrum;

use crate::film::FilmTile;
use crate::integrator::{self, Batch, FIRST_FREE_DIMENSION, Integrator, PathStart};

/// Side of a tile in pixels.
const TILE: u32 = 16;
/// Paths that a worker advances together: their state fits into a second-level cache.
const BATCH: usize = 1024;
/// Samples per pixel of a pass, at most: between passes the whole image can be looked at.
const MAX_PASS: u32 = 16;

/// How a scene is rendered.
#[derive(Clone, Debug, Default)]
pub struct RenderOptions {
    /// Samples per pixel; the scene's own number by default.
    pub spp: Option<u32>,
    /// Stop after this time, whatever the number of samples.
    pub time: Option<Duration>,
    /// Another seed draws other samples.
    pub seed: u64,
    /// Threads; all processors when zero.
    pub threads: usize,
    /// Another integrator than the scene's, by name.
    pub integrator: Option<String>,
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Samples drawn.
    pub samples_done: u64,
    /// Samples to draw.
    pub samples_total: u64,
    /// Rays traced.
    pub rays: u64,
    /// Since the start.
    pub elapsed: Duration,
}

/// Watches a render, and may end it.
pub trait Observer: Sync {
    /// Called now and then, from any thread.
    fn progress(&self, _progress: &Progress) {}

    /// Whether to finish the tiles at work and give back what there is.
    fn should_stop(&self) -> bool {
        false
    }
}

/// An observer that does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}

/// An image and how it came to be.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Linear Rec. 709 in channels R, G, B.
    pub image: Image,
    /// Figures.
    pub stats: RenderStats,
}

/// Figures of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderStats {
    /// Samples drawn.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Time spent.
    pub seconds: f64,
    /// Samples that were not finite and left out.
    pub non_finite: u64,
    /// The first of them, by row, column and index: the same for any number of threads.
    pub first_non_finite: Option<SampleId>,
    /// Whether all samples that were asked for were drawn.
    pub complete: bool,
}

/// Names a sample: its pixel in the whole image, and its index there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SampleId {
    /// Row.
    pub y: u32,
    /// Column.
    pub x: u32,
    /// Index.
    pub sample: u32,
}

/// Renders a scene.
///
/// The image depends on the scene, the seed and the number of samples, not on threads or timing.
///
/// # Errors
/// An integrator that does not exist, or parameters that it does not take.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    observer: &dyn Observer,
) -> Result<Rendered, SceneError> {
    let integrator = integrator::build(scene, options.integrator.as_deref())?;
    let job = Job {
        scene,
        integrator: &*integrator,
        observer,
        spp: options.spp.unwrap_or_else(|| scene.sampler.sample_count()),
        seed: options.seed,
        start: Instant::now(),
        limit: options.time,
        samples: AtomicU64::new(0),
        rays: AtomicU64::new(0),
        first_non_finite: Mutex::new(None),
        stopped: AtomicBool::new(false),
    };
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    };
    Ok(job.run(threads.min(256)))
}

/// A render at work.
struct Job<'a> {
    scene: &'a Scene,
    integrator: &'a dyn Integrator,
    observer: &'a dyn Observer,
    spp: u32,
    seed: u64,
    start: Instant,
    limit: Option<Duration>,
    samples: AtomicU64,
    rays: AtomicU64,
    first_non_finite: Mutex<Option<SampleId>>,
    stopped: AtomicBool,
}

impl Job<'_> {
    fn run(&self, threads: usize) -> Rendered {
        let tiles: Vec<Mutex<FilmTile>> =
            tiles(&self.scene.film.crop).map(|area| Mutex::new(FilmTile::new(area))).collect();
        let mut first = 0;
        while first < self.spp && !self.stopped.load(Ordering::Relaxed) {
            // Passes grow, so that a first impression comes quickly.
            let count = first.clamp(1, MAX_PASS).min(self.spp - first);
            let next_tile = AtomicUsize::new(0);
            std::thread::scope(|scope| {
                for _ in 1..threads {
                    scope.spawn(|| self.work(&tiles, &next_tile, first, count));
                }
                self.work(&tiles, &next_tile, first, count);
            });
            first += count;
            tracing::debug!(
                samples_per_pixel = first,
                seconds = self.start.elapsed().as_secs_f64(),
                "pass done"
            );
        }
        self.report();
        self.finish(tiles)
    }

    /// One thread's part of a pass.
    fn work(&self, tiles: &[Mutex<FilmTile>], next_tile: &AtomicUsize, first: u32, count: u32) {
        let mut worker = Worker::default();
        while !self.stopped.load(Ordering::Relaxed) {
            let Some(tile) = tiles.get(next_tile.fetch_add(1, Ordering::Relaxed)) else { break };
            // Each tile is taken once in a pass, so nobody waits here.
            let mut tile = tile.lock().unwrap_or_else(PoisonError::into_inner);
            self.render_tile(&mut worker, &mut tile, first, count);
            self.report();
            let is_late = self.limit.is_some_and(|limit| self.start.elapsed() >= limit);
            if is_late || self.observer.should_stop() {
                self.stopped.store(true, Ordering::Relaxed);
            }
        }
    }

    fn render_tile(&self, worker: &mut Worker, tile: &mut FilmTile, first: u32, count: u32) {
        let pixels = tile.area.width * tile.area.height;
        let per_batch = (BATCH as u32 / pixels).max(1);
        let mut sample = first;
        while sample < first + count {
            let n = per_batch.min(first + count - sample);
            worker.clear();
            for s in sample..sample + n {
                for y in 0..tile.area.height {
                    for x in 0..tile.area.width {
                        let id = SampleId { x: tile.area.x + x, y: tile.area.y + y, sample: s };
                        worker.push(start_path(self.scene, self.seed, id));
                    }
                }
            }
            worker.radiance.clear();
            worker.radiance.resize(worker.starts.len(), Spectrum::ZERO);
            let rays = worker.batch.trace(self.integrator, self.scene, &worker.starts, &mut worker.radiance);
            for (i, radiance) in worker.radiance.iter().enumerate() {
                let place = i as u32 % pixels;
                let (x, y) = (place % tile.area.width, place / tile.area.width);
                if !tile.add(x, y, *radiance, worker.weights[i]) {
                    let id = SampleId {
                        x: tile.area.x + x,
                        y: tile.area.y + y,
                        sample: sample + i as u32 / pixels,
                    };
                    self.note_non_finite(id);
                }
            }
            self.samples.fetch_add(worker.starts.len() as u64, Ordering::Relaxed);
            self.rays.fetch_add(rays, Ordering::Relaxed);
            sample += n;
        }
    }

    /// Keeps the first of all samples that are not finite.
    #[cold]
    fn note_non_finite(&self, id: SampleId) {
        let mut first = self.first_non_finite.lock().unwrap_or_else(PoisonError::into_inner);
        *first = Some(first.map_or(id, |first| first.min(id)));
    }

    fn report(&self) {
        let crop = self.scene.film.crop;
        self.observer.progress(&Progress {
            samples_done: self.samples.load(Ordering::Relaxed),
            samples_total: u64::from(crop.width) * u64::from(crop.height) * u64::from(self.spp),
            rays: self.rays.load(Ordering::Relaxed),
            elapsed: self.start.elapsed(),
        });
    }

    fn finish(&self, tiles: Vec<Mutex<FilmTile>>) -> Rendered {
        let crop = self.scene.film.crop;
        let mut image = Image::new(crop.width as usize, crop.height as usize, &["R", "G", "B"]);
        let full = self.scene.film.full;
        let whole = Crop { x: 0, y: 0, width: full.width, height: full.height };
        image.window = (crop != whole).then_some(Window {
            x: crop.x as i32,
            y: crop.y as i32,
            full_width: full.width as usize,
            full_height: full.height as usize,
        });
        let mut non_finite = 0;
        for tile in tiles {
            let tile = tile.into_inner().unwrap_or_else(PoisonError::into_inner);
            non_finite += tile.dropped;
            for y in 0..tile.area.height {
                for x in 0..tile.area.width {
                    let (column, row) = (tile.area.x - crop.x + x, tile.area.y - crop.y + y);
                    image.pixel_mut(column as usize, row as usize).copy_from_slice(&tile.rgb(x, y));
                }
            }
        }
        let samples = self.samples.load(Ordering::Relaxed);
        let complete = !self.stopped.load(Ordering::Relaxed);
        let rays = self.rays.load(Ordering::Relaxed);
        let seconds = self.start.elapsed().as_secs_f64();
        let first_non_finite = *self.first_non_finite.lock().unwrap_or_else(PoisonError::into_inner);
        let stats = RenderStats { samples, rays, seconds, non_finite, first_non_finite, complete };
        Rendered { image, stats }
    }
}

/// The camera ray of a sample, and its weight from the filter.
#[inline]
pub(crate) fn start_path(scene: &Scene, seed: u64, id: SampleId) -> (PathStart, f32) {
    let key = SampleKey::new(seed, id.x, id.y, id.sample);
    let sampler = &scene.sampler;
    let filter = scene.filter.sample(sampler.get_2d(key, 0));
    let center = Point2::new(id.x as f32 + 0.5, id.y as f32 + 0.5);
    let film = center + Vector2::new(filter.offset.x, filter.offset.y);
    let camera_sample = CameraSample { film, lens: sampler.get_2d(key, 1), time: sampler.get_1d(key, 2) };
    const { assert!(FIRST_FREE_DIMENSION == 3) };
    (PathStart { ray: scene.camera.generate_ray(&camera_sample), key }, filter.weight)
}

/// A thread's memory, kept from batch to batch.
#[derive(Default)]
struct Worker {
    starts: Vec<PathStart>,
    weights: Vec<f32>,
    radiance: Vec<Spectrum>,
    batch: Batch,
}

impl Worker {
    fn clear(&mut self) {
        self.starts.clear();
        self.weights.clear();
    }

    #[inline]
    fn push(&mut self, (start, weight): (PathStart, f32)) {
        self.starts.push(start);
        self.weights.push(weight);
    }
}

/// The tiles of an area, row by row.
fn tiles(area: &Crop) -> impl Iterator<Item = Crop> {
    let Crop { x, y, width, height } = *area;
    (0..height).step_by(TILE as usize).flat_map(move |dy| {
        (0..width).step_by(TILE as usize).map(move |dx| Crop {
            x: x + dx,
            y: y + dy,
            width: TILE.min(width - dx),
            height: TILE.min(height - dy),
        })
    })
}
