//! The loop over passes and tiles.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use aureole_desc::SceneError;
use aureole_elements::camera::{CameraRay, CameraSample};
use aureole_elements::sampler::SampleKey;
use aureole_image::Image;
use aureole_math::Point2;
use aureole_scene::{Crop, Scene};
use aureole_spectrum::Spectrum;

use crate::film::{Film, FilmTile, SampleValue};
use crate::integrator::{self, Batch, FIRST_FREE_DIMENSION, Integrator, PathStart};
use crate::splat::{Footprint, Splatter};

/// Side of a tile in pixels, unless another is wanted.
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
    /// Only these samples of every pixel, counted from zero, instead of the first `spp`.
    pub samples: Option<Range<u32>>,
    /// Threads; all processors when zero.
    pub threads: usize,
    /// Side of the tiles that threads work on, in pixels; 16 when zero. It does not change the image.
    pub tile: u32,
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

    /// Whether to show the film as it is now. Asked after every tile; the thread that hears yes calls
    /// [`film`](Self::film), while the others go on.
    fn wants_film(&self) -> bool {
        false
    }

    /// Shows the film. Every pixel is whole, but some have more samples than others.
    fn film(&self, _film: Film) {}
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
    /// The sums that it was made from: what [`resume`] goes on with.
    pub film: Film,
    /// Figures.
    pub stats: RenderStats,
}

/// Figures of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderStats {
    /// Samples drawn, without those that a resumed film already had.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Time spent.
    pub seconds: f64,
    /// Samples of the film that were not finite and left out.
    pub non_finite: u64,
    /// The first of them that was drawn now, by row, column and index: the same for any number of threads.
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
    resume(scene, options, Film::new(scene.film, options.samples(scene).start), observer)
}

/// Goes on with a film, such as one that was interrupted or should have more samples.
///
/// The image has the bits of a render that was never interrupted. The film must be of the same scene and seed, which only
/// the caller can know; see [`Fingerprint`](crate::Fingerprint).
///
/// # Errors
/// As [`render`], and for a film of another size or of other samples.
pub fn resume(
    scene: &Scene,
    options: &RenderOptions,
    film: Film,
    observer: &dyn Observer,
) -> Result<Rendered, SceneError> {
    let integrator = integrator::build(scene, options.integrator.as_deref())?;
    let samples = options.samples(scene);
    let layers = integrator.layers();
    let film = match film.samples() {
        0 => Film::with_layers(film.shape(), film.first, layers.to_vec()),
        _ => film,
    };
    if film.shape() != scene.film || film.first != samples.start || film.layer_names() != layers {
        let message = "the film is not one of this image and these samples";
        return Err(SceneError::invalid(message, aureole_desc::Span::NONE));
    }
    let job = Job {
        scene,
        integrator: &*integrator,
        observer,
        samples,
        tile: if options.tile == 0 { TILE } else { options.tile },
        splatter: Splatter::new(scene),
        seed: options.seed,
        start: Instant::now(),
        limit: options.time,
        drawn_before: film.samples(),
        drawn: AtomicU64::new(0),
        rays: AtomicU64::new(0),
        first_non_finite: Mutex::new(None),
        stopped: AtomicBool::new(false),
    };
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    };
    Ok(job.run(film, threads.min(256)))
}

impl RenderOptions {
    /// The samples that every pixel gets.
    pub fn samples(&self, scene: &Scene) -> Range<u32> {
        let all = 0..self.spp.unwrap_or_else(|| scene.sampler.sample_count());
        self.samples.clone().unwrap_or(all)
    }
}

/// A render at work.
struct Job<'a> {
    scene: &'a Scene,
    integrator: &'a dyn Integrator,
    observer: &'a dyn Observer,
    samples: Range<u32>,
    tile: u32,
    splatter: Splatter,
    seed: u64,
    start: Instant,
    limit: Option<Duration>,
    /// Samples that a resumed film came with.
    drawn_before: u64,
    drawn: AtomicU64,
    rays: AtomicU64,
    first_non_finite: Mutex<Option<SampleId>>,
    stopped: AtomicBool,
}

/// The film while it is worked on.
type Tiles = [Mutex<FilmTile>];

impl Job<'_> {
    fn run(&self, film: Film, threads: usize) -> Rendered {
        let area = self.scene.film.area();
        let areas = tiles(&area, self.tile);
        let tiles: Vec<Mutex<FilmTile>> = areas.map(|area| Mutex::new(film.tile(area))).collect();
        let [least, _] = film.drawn();
        drop(film);
        let mut first = self.samples.start.saturating_add(least);
        while first < self.samples.end && !self.stopped.load(Ordering::Relaxed) {
            // Passes grow, so that a first impression comes quickly.
            let count = (first - self.samples.start).clamp(1, MAX_PASS).min(self.samples.end - first);
            let next_tile = AtomicUsize::new(0);
            std::thread::scope(|scope| {
                for _ in 1..threads {
                    scope.spawn(|| self.work(&tiles, &next_tile, first..first + count));
                }
                self.work(&tiles, &next_tile, first..first + count);
            });
            first += count;
            tracing::debug!(
                samples_per_pixel = first,
                seconds = self.start.elapsed().as_secs_f64(),
                "pass done"
            );
        }
        self.report();
        self.finish(self.film(&tiles))
    }

    /// One thread's part of a pass.
    fn work(&self, tiles: &Tiles, next_tile: &AtomicUsize, pass: Range<u32>) {
        let mut worker = Worker::default();
        while !self.stopped.load(Ordering::Relaxed) {
            let Some(tile) = tiles.get(next_tile.fetch_add(1, Ordering::Relaxed)) else { break };
            // Each tile is taken once in a pass, so nobody waits here, but for somebody who copies it.
            self.render_tile(&mut worker, &mut lock(tile), pass.clone());
            self.report();
            if self.should_end() {
                self.stopped.store(true, Ordering::Relaxed);
            } else if self.observer.wants_film() {
                self.observer.film(self.film(tiles));
            }
        }
    }

    /// The film as it is now. Tiles come one after the other, each between two passes over it.
    fn film(&self, tiles: &Tiles) -> Film {
        let layers = self.integrator.layers().to_vec();
        let mut film = Film::with_layers(self.scene.film, self.samples.start, layers);
        tiles.iter().for_each(|tile| film.put(&lock(tile)));
        film
    }

    /// Draws those samples of a pass that the tile does not have yet, until the render is to end.
    fn render_tile(&self, worker: &mut Worker, tile: &mut FilmTile, pass: Range<u32>) {
        // Batches are parts of a tile and of a pass: however large both are, a request to end is soon heard.
        let Crop { width, height, .. } = tile.area;
        let per_batch = (BATCH as u32 / (width * height)).max(1);
        let rows = (BATCH as u32 / width).max(1);
        for sample in pass.clone().step_by(per_batch as usize) {
            let samples = sample..pass.end.min(sample.saturating_add(per_batch));
            for y in (0..height).step_by(rows as usize) {
                self.render_batch(worker, tile, &samples, y..height.min(y + rows));
                if self.should_end() {
                    return;
                }
            }
        }
    }

    /// Whether the time is over, or somebody wants the render to end.
    fn should_end(&self) -> bool {
        self.limit.is_some_and(|limit| self.start.elapsed() >= limit) || self.observer.should_stop()
    }

    /// Draws samples of some rows of a tile.
    fn render_batch(&self, worker: &mut Worker, tile: &mut FilmTile, samples: &Range<u32>, rows: Range<u32>) {
        let area = tile.area;
        worker.clear();
        for s in samples.clone() {
            for y in rows.clone() {
                for x in 0..area.width {
                    // A resumed film may have been stopped, or tiled, anywhere.
                    if tile.drawn(x, y) <= s - self.samples.start {
                        let id = SampleId { x: area.x + x, y: area.y + y, sample: s };
                        worker.push(id, start_path(self.scene, &self.splatter, self.seed, id));
                    }
                }
            }
        }
        worker.radiance.clear();
        worker.radiance.resize(worker.starts.len(), Spectrum::ZERO);
        let rays = worker.batch.trace(self.integrator, self.scene, &worker.starts, &mut worker.radiance);
        let layers = self.integrator.layers().len();
        for (i, &radiance) in worker.radiance.iter().enumerate() {
            let id = worker.ids[i];
            let radiance = self.scene.film.limited(radiance * worker.starts[i].weight);
            let value = SampleValue { radiance, layers: &worker.batch.layers()[i * layers..][..layers] };
            if !tile.add(id.x - area.x, id.y - area.y, value, &worker.footprints[i]) {
                self.note_non_finite(id);
            }
        }
        self.drawn.fetch_add(worker.starts.len() as u64, Ordering::Relaxed);
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }

    /// Keeps the first of all samples that are not finite.
    #[cold]
    fn note_non_finite(&self, id: SampleId) {
        let mut first = lock(&self.first_non_finite);
        *first = Some(first.map_or(id, |first| first.min(id)));
    }

    fn report(&self) {
        let area = self.scene.film.area();
        self.observer.progress(&Progress {
            samples_done: self.drawn.load(Ordering::Relaxed) + self.drawn_before,
            samples_total: u64::from(area.width) * u64::from(area.height) * self.samples.len() as u64,
            rays: self.rays.load(Ordering::Relaxed),
            elapsed: self.start.elapsed(),
        });
    }

    fn finish(&self, film: Film) -> Rendered {
        let stats = RenderStats {
            samples: self.drawn.load(Ordering::Relaxed),
            rays: self.rays.load(Ordering::Relaxed),
            seconds: self.start.elapsed().as_secs_f64(),
            non_finite: film.dropped(),
            first_non_finite: *lock(&self.first_non_finite),
            complete: film.drawn()[0] as usize >= self.samples.len(),
        };
        Rendered { image: film.image(), film, stats }
    }
}

/// What panics elsewhere is no reason to panic here.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The camera ray of a sample, and what it adds to the pixels around its own.
#[inline]
pub(crate) fn start_path(
    scene: &Scene,
    splatter: &Splatter,
    seed: u64,
    id: SampleId,
) -> (PathStart, Footprint) {
    let key = SampleKey::new(seed, id.x, id.y, id.sample);
    let sampler = &scene.sampler;
    let footprint = splatter.place(&scene.filter, sampler.get_2d(key, 0));
    let film = Point2::new(id.x as f32 + 0.5, id.y as f32 + 0.5) + footprint.offset;
    let camera_sample = CameraSample { film, lens: sampler.get_2d(key, 1), time: sampler.get_1d(key, 2) };
    const { assert!(FIRST_FREE_DIMENSION == 3) };
    let CameraRay { ray, weight } = scene.camera.generate_ray(&camera_sample);
    (PathStart { ray, weight, key }, footprint)
}

/// A thread's memory, kept from batch to batch.
#[derive(Default)]
struct Worker {
    ids: Vec<SampleId>,
    starts: Vec<PathStart>,
    footprints: Vec<Footprint>,
    radiance: Vec<Spectrum>,
    batch: Batch,
}

impl Worker {
    fn clear(&mut self) {
        self.ids.clear();
        self.starts.clear();
        self.footprints.clear();
    }

    #[inline]
    fn push(&mut self, id: SampleId, (start, footprint): (PathStart, Footprint)) {
        self.ids.push(id);
        self.starts.push(start);
        self.footprints.push(footprint);
    }
}

/// The tiles of an area, row by row.
fn tiles(area: &Crop, side: u32) -> impl Iterator<Item = Crop> {
    let Crop { x, y, width, height } = *area;
    (0..height).step_by(side as usize).flat_map(move |dy| {
        (0..width).step_by(side as usize).map(move |dx| Crop {
            x: x + dx,
            y: y + dy,
            width: side.min(width - dx),
            height: side.min(height - dy),
        })
    })
}
