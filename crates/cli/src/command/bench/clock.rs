//! Fair timing: passes during which the threads had their cores to themselves.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Work that threads take in numbered chunks.
pub(super) trait Chunks: Sync {
    /// How many there are.
    fn count(&self) -> usize;
    /// Does one.
    fn run(&self, chunk: usize) -> Outcome;
}

/// What came out: enough to compare libraries by, and to keep the work from being optimised away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    /// Rays that hit something.
    pub hits: u64,
    /// Sum of the ray parameters of the hits.
    pub sum_t: f64,
}

/// One pass over all chunks, or several.
pub(super) struct Pass {
    pub outcome: Outcome,
    /// Wall time of one pass.
    pub seconds: f64,
    /// Processor time over wall time: less than one when something else took a core.
    pub busy: f64,
}

/// Passes that are fewer than this share of the time on their cores do not count, where others do.
const BUSY: f64 = 0.97;
/// Shortest time of a measurement and thread.
const LEAST_SECONDS: f64 = 0.06;

/// Does all chunks `repeats` times with some threads.
pub(super) fn pass(work: &dyn Chunks, threads: usize, repeats: usize) -> Pass {
    let next = AtomicUsize::new(0);
    let chunks = work.count();
    let total = Mutex::new((Outcome::default(), 0.0));
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                let mut sum = Outcome::default();
                loop {
                    let chunk = next.fetch_add(1, Ordering::Relaxed);
                    if chunk >= chunks * repeats {
                        break;
                    }
                    let outcome = work.run(chunk % chunks);
                    sum.hits += outcome.hits;
                    sum.sum_t += outcome.sum_t;
                }
                let mut total = total.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                total.0.hits += sum.hits;
                total.0.sum_t += sum.sum_t;
                total.1 += thread_seconds();
            });
        }
    });
    let seconds = start.elapsed().as_secs_f64();
    let (outcome, processor) = total.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    Pass {
        outcome: Outcome { hits: outcome.hits / repeats as u64, sum_t: outcome.sum_t / repeats as f64 },
        seconds: seconds / repeats as f64,
        busy: processor / (seconds * threads as f64),
    }
}

/// The median time of `samples` undisturbed passes, and the least share of their cores that the threads had in them. After
/// four times as many tries the least disturbed ones are taken.
pub(super) fn median(work: &dyn Chunks, threads: usize, warm: &Pass, samples: usize) -> (f64, f64) {
    let repeats = (LEAST_SECONDS * threads as f64 / warm.seconds).ceil().max(1.0) as usize;
    pass(work, threads, 1);
    let mut all: Vec<(f64, f64)> = Vec::new();
    while all.iter().filter(|pass| pass.1 >= BUSY).count() < samples && all.len() < 4 * samples {
        let pass = pass(work, threads, repeats);
        all.push((pass.seconds, pass.busy));
        if pass.busy < BUSY {
            std::thread::sleep(Duration::from_millis(50));
        }
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(samples);
    let busy = all.last().map_or(0.0, |pass| pass.1);
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    (all.get(all.len() / 2).map_or(f64::NAN, |pass| pass.0), busy)
}

/// Processor time of this thread; zero where the system does not tell.
fn thread_seconds() -> f64 {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    }
    #[cfg(not(unix))]
    0.0
}
