//! Progress: a bar, only on a terminal and on standard error, so that it never ends up in a file; or lines for programs.

use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use aureole::render::{Film, Observer, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::checkpoint::Checkpoint;
use crate::diagnostics::Painter;
use crate::exit::Failure;
use crate::signals::Signals;

/// Milliseconds between two updates of the bar, and between two lines for programs.
const BAR_INTERVAL: u64 = 100;
const LINE_INTERVAL: u64 = 1000;
/// The bar's length stands for this many steps.
const STEPS: u64 = 1000;

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Show {
    /// Not at all.
    Nothing,
    /// A bar, if somebody can see it.
    Bar,
    /// A JSON object a line.
    Lines,
}

/// Shows a render's progress, keeps checkpoints, and lets signals end it.
pub(crate) struct Watch<'a> {
    signals: Signals,
    checkpoint: Option<&'a Checkpoint>,
    painter: &'a Painter,
    bar: Option<ProgressBar>,
    lines: bool,
    /// When a time limit decides rather than the number of samples.
    time: Option<Duration>,
    last_update: AtomicU64,
    /// Whether the last checkpoint could not be written.
    in_trouble: AtomicBool,
}

impl<'a> Watch<'a> {
    /// Watches for signals; shows progress as wanted.
    pub(crate) fn new(
        signals: Signals,
        show: Show,
        time: Option<Duration>,
        checkpoint: Option<&'a Checkpoint>,
        painter: &'a Painter,
    ) -> Self {
        let bar = (show == Show::Bar && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{bar:30.cyan/dim} {percent:>3} %  {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("━━─"));
            bar
        });
        let lines = show == Show::Lines;
        let (last_update, in_trouble) = (AtomicU64::new(0), AtomicBool::new(false));
        Self { signals, checkpoint, painter, bar, lines, time, last_update, in_trouble }
    }

    /// Takes the line away.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn done(&self, progress: &Progress) -> f64 {
        let samples = progress.samples_done as f64 / progress.samples_total.max(1) as f64;
        let time = self.time.map_or(0.0, |limit| progress.elapsed.as_secs_f64() / limit.as_secs_f64());
        samples.max(time).clamp(0.0, 1.0)
    }
}

impl Observer for Watch<'_> {
    fn progress(&self, progress: &Progress) {
        let interval = match (&self.bar, self.lines) {
            (Some(_), _) => BAR_INTERVAL,
            (None, true) => LINE_INTERVAL,
            (None, false) => return,
        };
        // Workers report after every tile: one of them, now and then, moves the bar.
        let now = progress.elapsed.as_millis() as u64;
        let last = self.last_update.load(Ordering::Relaxed);
        let is_due = now >= last + interval
            && self.last_update.compare_exchange(last, now, Ordering::Relaxed, Ordering::Relaxed).is_ok();
        if !is_due {
            return;
        }
        let done = self.done(progress);
        let seconds = progress.elapsed.as_secs_f64().max(1e-9);
        let left = if done > 0.0 { seconds * (1.0 - done) / done } else { f64::INFINITY };
        match &self.bar {
            Some(bar) => {
                bar.set_position((done * STEPS as f64) as u64);
                bar.set_message(format!(
                    "{}samples/s  {}rays/s  {} left",
                    quantity(progress.samples_done as f64 / seconds),
                    quantity(progress.rays as f64 / seconds),
                    duration(left),
                ));
            }
            None => print_line(&serde_json::json!({
                "event": "progress",
                "done": done,
                "samples": progress.samples_done,
                "rays": progress.rays,
                "seconds": seconds,
                "seconds_left": left.is_finite().then_some(left),
            })),
        }
    }

    fn should_stop(&self) -> bool {
        self.signals.received().is_some()
    }

    fn wants_film(&self) -> bool {
        self.checkpoint.is_some_and(Checkpoint::claim)
    }

    fn film(&self, film: Film) {
        let Some(checkpoint) = self.checkpoint else { return };
        let least = film.drawn()[0];
        match checkpoint.write(film) {
            // Trouble now may be over when the next one is due; the render is worth more. It is told once.
            Err(Failure::Plain { message, .. }) => {
                if !self.in_trouble.swap(true, Ordering::Relaxed) {
                    let help = "the render goes on, and the last checkpoint is as it was";
                    self.painter.warning(&message, Some(help));
                }
                return;
            }
            _ if self.lines => print_line(&serde_json::json!({
                "event": "checkpoint",
                "file": checkpoint.path().display().to_string(),
                "samples_per_pixel": least,
            })),
            _ => {}
        }
        self.in_trouble.store(false, Ordering::Relaxed);
    }
}

/// Writes an object as a line of standard error.
pub(crate) fn print_line(object: &serde_json::Value) {
    // Nobody is left to tell when standard error is closed.
    let _ = writeln!(std::io::stderr().lock(), "{object}");
}

/// A number with a metric prefix, three digits long: `1.23 M`. A unit follows directly.
pub(crate) fn quantity(x: f64) -> String {
    let prefixes = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")];
    match prefixes.iter().find(|(size, _)| x >= 0.9995 * size) {
        Some((size, prefix)) => format!("{} {prefix}", three_digits(x / size)),
        None => format!("{} ", three_digits(x)),
    }
}

fn three_digits(x: f64) -> String {
    let decimals = if x >= 99.95 || x.fract() == 0.0 {
        0
    } else if x >= 9.995 {
        1
    } else {
        2
    };
    format!("{x:.decimals$}")
}

/// A duration for people: `0.42 s`, `12.3 s`, `3 min 07 s`, `2 h 05 min`.
pub(crate) fn duration(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "?".to_owned();
    }
    let whole = seconds.round() as u64;
    match whole {
        0..=9 => format!("{seconds:.2} s"),
        10..=59 => format!("{seconds:.1} s"),
        60..=3599 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(quantity(0.0), "0 ");
        assert_eq!(quantity(999.0), "999 ");
        assert_eq!(quantity(1234.0), "1.23 k");
        assert_eq!(quantity(999_900.0), "1.00 M");
        assert_eq!(quantity(45_600_000.0), "45.6 M");
    }

    #[test]
    fn durations_read_well() {
        assert_eq!(duration(0.421), "0.42 s");
        assert_eq!(duration(12.34), "12.3 s");
        assert_eq!(duration(187.0), "3 min 07 s");
        assert_eq!(duration(7500.0), "2 h 05 min");
        assert_eq!(duration(f64::INFINITY), "?");
    }
}
