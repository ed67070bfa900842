//! Lines for developers: what the crates tell through `tracing`, on standard error, plain or as JSON.

use std::fmt;
use std::io::Write;

use serde_json::{Map, Value};
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;

use crate::args::Loudness;

/// Starts to write lines, as many as the loudness asks for: none, `-v`, `-vv` or `-vvv`.
pub(crate) fn start(loudness: Loudness, json: bool) {
    let level = match loudness.verbose {
        0 => LevelFilter::OFF,
        1 => LevelFilter::INFO,
        2 => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    // What other people's crates have to tell is for other people.
    let filter = Targets::new().with_target("aureole", level);
    // It fails only where a program has one already, and this is the program.
    let _ = tracing_subscriber::registry().with(Lines { json }.with_filter(filter)).try_init();
}

/// Writes every event as a line.
struct Lines {
    json: bool,
}

impl<S: Subscriber> Layer<S> for Lines {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let mut fields = Fields::default();
        event.record(&mut fields);
        let meta = event.metadata();
        let line = if self.json {
            fields.to_json(meta.level(), meta.target())
        } else {
            format!("{:>5} {}: {}{}", meta.level(), meta.target(), fields.message, fields.to_text())
        };
        // Nobody is left to tell when standard error is closed.
        let _ = writeln!(std::io::stderr().lock(), "{line}");
    }
}

/// The fields of an event.
#[derive(Default)]
struct Fields {
    message: String,
    others: Map<String, Value>,
}

impl Fields {
    fn to_json(&self, level: &Level, target: &str) -> String {
        let level = level.as_str().to_lowercase();
        let fields = &self.others;
        serde_json::json!({ "event": "log", "level": level, "target": target, "message": self.message, "fields": fields })
            .to_string()
    }

    fn to_text(&self) -> String {
        self.others.iter().map(|(name, value)| format!(" {name}={value}")).collect()
    }

    fn set(&mut self, field: &Field, value: Value) {
        self.others.insert(field.name().to_owned(), value);
    }
}

impl Visit for Fields {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        match field.name() {
            "message" => self.message = format!("{value:?}"),
            _ => self.set(field, format!("{value:?}").into()),
        }
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        self.set(field, value.into());
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        self.set(field, value.into());
    }

    fn record_i64(&mut self, field: &Field, value: i64) {
        self.set(field, value.into());
    }

    fn record_f64(&mut self, field: &Field, value: f64) {
        self.set(field, value.into());
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        self.set(field, value.into());
    }
}
