//! `aureole bench rays`: millions of rays a second.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use aureole::accel::{Accuracy, Config, Hit, Layout, NoUserShapes, Quality, Structure, Width, World};
use clap::{Args, ValueEnum};
use serde::Serialize;

use super::clock::{Chunks, Outcome, median, pass};
use super::ray_file::{CHUNK, KINDS, RaySet, ray, read_mesh, read_rays};
use crate::command::json_line;
use crate::exit::{Exit, Failure};
use crate::output::print;

/// Which rays against which mesh.
#[derive(Args, Clone, Debug)]
pub(crate) struct RaysArgs {
    /// The mesh file (TRIMESH1)
    #[arg(long, value_name = "FILE")]
    pub mesh: PathBuf,
    /// The ray file (RAYSETS1)
    #[arg(long, value_name = "FILE")]
    pub rays: PathBuf,
    /// Time with this many threads; may be given several times
    #[arg(long, value_name = "N", default_values_t = [1, 2], value_delimiter = ',')]
    pub threads: Vec<usize>,
    /// The structures
    #[arg(long, value_enum, default_values_t = [Accel::Hierarchy], value_delimiter = ',')]
    pub accel: Vec<Accel>,
    /// The triangle tests
    #[arg(long, value_enum, default_values_t = [Test::Fast, Test::Watertight], value_delimiter = ',')]
    pub test: Vec<Test>,
    /// How rays are handed over
    #[arg(long, value_enum, default_values_t = [Mode::Single, Mode::Stream], value_delimiter = ',')]
    pub mode: Vec<Mode>,
    /// How much time the build takes for how good a hierarchy
    #[arg(long, value_enum, default_value_t = BuildQuality::Medium)]
    pub quality: BuildQuality,
    /// Children of a hierarchy's node
    #[arg(long, value_enum, default_value_t = NodeWidth::Auto)]
    pub width: NodeWidth,
    /// What a hierarchy keeps in memory
    #[arg(long, value_enum, default_value_t = NodeLayout::Fast)]
    pub layout: NodeLayout,
    /// Time only the first of every N runs of 4096 rays
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
    /// Passes of which the median is taken
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
    /// Write each ray's t (or 1 and 0 where any hit will do) as a float to PREFIX.NAME.f32 instead of timing
    #[arg(long, value_name = "PREFIX")]
    pub dump: Option<PathBuf>,
    /// Print one JSON object a line
    #[arg(long)]
    pub json: bool,
}

/// The structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Accel {
    /// Every triangle
    List,
    /// Equal cells
    Grid,
    /// A hierarchy of boxes, two in a box
    Binary,
    /// A hierarchy of boxes, eight in a box
    Hierarchy,
}

/// Children of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum NodeWidth {
    /// What was faster where it was measured
    Auto,
    /// Eight
    #[value(name = "8")]
    Eight,
    /// Sixteen
    #[value(name = "16")]
    Sixteen,
}

/// Speed or memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum NodeLayout {
    /// Everything ready for rays
    Fast,
    /// A seventh of the memory
    Compact,
}

/// The triangle test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Test {
    /// The fewest operations
    Fast,
    /// No ray slips through along an edge
    Watertight,
}

/// How rays are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Mode {
    /// One by one
    Single,
    /// Hundreds at once
    Stream,
}

/// The quality of the hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BuildQuality {
    /// Along a space-filling curve
    Fast,
    /// By the surface-area heuristic
    Medium,
    /// Optimised afterwards
    High,
}

/// Measures and prints.
pub(crate) fn run(args: &RaysArgs) -> Result<(), Failure> {
    let mesh = read_mesh(&args.mesh)?;
    let sets = read_rays(&args.rays, args.every as usize)?;
    for &accel in &args.accel {
        for &test in &args.test {
            let config = config(accel, test, args);
            let start = Instant::now();
            let world = World::build(vec![mesh.clone()], 0, &config)
                .map_err(|error| Failure::new(Exit::Scene, format!("`{}`: {error}", args.mesh.display())))?;
            let build_seconds = start.elapsed().as_secs_f64();
            for &mode in &args.mode {
                let tracer = Tracer { world: &world, mode };
                let name = name(accel, test, mode, args);
                match &args.dump {
                    Some(prefix) => dump(&tracer, &sets, prefix, &name)?,
                    None => report(args, &tracer, &sets, &name, build_seconds)?,
                }
            }
        }
    }
    Ok(())
}

fn config(accel: Accel, test: Test, args: &RaysArgs) -> Config {
    Config {
        structure: match accel {
            Accel::List => Structure::List,
            Accel::Grid => Structure::Grid,
            Accel::Binary => Structure::Binary,
            Accel::Hierarchy => Structure::Hierarchy,
        },
        accuracy: match test {
            Test::Fast => Accuracy::Fast,
            Test::Watertight => Accuracy::Watertight,
        },
        quality: match args.quality {
            BuildQuality::Fast => Quality::Fast,
            BuildQuality::Medium => Quality::Medium,
            BuildQuality::High => Quality::High,
        },
        width: match args.width {
            NodeWidth::Auto => Width::Auto,
            NodeWidth::Eight => Width::Eight,
            NodeWidth::Sixteen => Width::Sixteen,
        },
        layout: match args.layout {
            NodeLayout::Fast => Layout::Fast,
            NodeLayout::Compact => Layout::Compact,
        },
        ..Config::default()
    }
}

fn name(accel: Accel, test: Test, mode: Mode, args: &RaysArgs) -> String {
    let of = |value: &dyn Fn() -> Option<clap::builder::PossibleValue>| {
        value().map_or_else(String::new, |value| value.get_name().to_owned())
    };
    let mut name = format!("aureole-{}", of(&|| test.to_possible_value()));
    if accel != Accel::Hierarchy {
        let _ = write!(name, "-{}", of(&|| accel.to_possible_value()));
    }
    if args.width != NodeWidth::Auto {
        let _ = write!(name, "-wide{}", of(&|| args.width.to_possible_value()));
    }
    if args.layout != NodeLayout::Fast {
        let _ = write!(name, "-{}", of(&|| args.layout.to_possible_value()));
    }
    if mode != Mode::Single {
        let _ = write!(name, "-{}", of(&|| mode.to_possible_value()));
    }
    name
}

/// Rays in a stream: with their hits, they stay in the nearest cache.
const BATCH: usize = 512;

/// Asks a world about rays.
struct Tracer<'a> {
    world: &'a World,
    mode: Mode,
}

impl Tracer<'_> {
    /// The ray parameter of each hit; infinite where there is none.
    fn trace(&self, set: &RaySet, chunk: usize, mut result: impl FnMut(f32)) {
        // As for other libraries, making a ray of a record is part of what is measured.
        let records = &set.rays[chunk * CHUNK..set.rays.len().min((chunk + 1) * CHUNK)];
        let hit_or_miss = |blocked: bool| if blocked { 1.0 } else { f32::INFINITY };
        match (self.mode, set.any) {
            (Mode::Single, false) => {
                for record in records {
                    result(
                        self.world
                            .closest_hit(&ray(record), &NoUserShapes)
                            .map_or(f32::INFINITY, |hit| hit.t),
                    );
                }
            }
            (Mode::Single, true) => {
                for record in records {
                    result(hit_or_miss(self.world.occluded(&ray(record), &NoUserShapes)));
                }
            }
            (Mode::Stream, false) => {
                let mut rays = Vec::with_capacity(BATCH);
                let mut hits = [Hit::NONE; BATCH];
                for records in records.chunks(BATCH) {
                    rays.clear();
                    rays.extend(records.iter().map(ray));
                    let hits = &mut hits[..records.len()];
                    self.world.closest_hits(&rays, hits, &NoUserShapes);
                    hits.iter().for_each(|hit| result(hit.t));
                }
            }
            (Mode::Stream, true) => {
                let mut rays = Vec::with_capacity(BATCH);
                let mut blocked = [false; BATCH];
                for records in records.chunks(BATCH) {
                    rays.clear();
                    rays.extend(records.iter().map(ray));
                    let blocked = &mut blocked[..records.len()];
                    self.world.occluded_many(&rays, blocked, &NoUserShapes);
                    blocked.iter().for_each(|&blocked| result(hit_or_miss(blocked)));
                }
            }
        }
    }
}

/// A set of rays for a tracer.
struct Work<'a>(&'a Tracer<'a>, &'a RaySet);

impl Chunks for Work<'_> {
    fn count(&self) -> usize {
        self.1.rays.len().div_ceil(CHUNK)
    }

    fn run(&self, chunk: usize) -> Outcome {
        let mut outcome = Outcome::default();
        self.0.trace(self.1, chunk, |t| {
            if t < f32::INFINITY {
                outcome.hits += 1;
                outcome.sum_t += f64::from(t);
            }
        });
        if self.1.any {
            outcome.sum_t = 0.0;
        }
        outcome
    }
}

fn report(
    args: &RaysArgs,
    tracer: &Tracer<'_>,
    sets: &[RaySet],
    name: &str,
    build_seconds: f64,
) -> Result<(), Failure> {
    let mib = tracer.world.stats().bytes as f64 / f64::from(1 << 20);
    let mesh = args.mesh.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let mut line = Line { lib: name, mesh, build_s: build_seconds, mib, busy: 1.0, ..Line::default() };
    let mut text = format!("{name}: built in {build_seconds:.3} s, {mib:.1} MiB\n");
    for set in sets.iter().filter(|set| !set.rays.is_empty()) {
        let work = Work(tracer, set);
        let warm = pass(&work, 1, 1);
        let mut rates = BTreeMap::new();
        for &threads in &args.threads {
            let (seconds, share) = median(&work, threads.max(1), &warm, args.samples as usize);
            line.busy = line.busy.min(share);
            let rate = set.rays.len() as f64 / 1e6 / seconds;
            rates.insert(format!("t{threads}"), rate);
            let _ = writeln!(
                text,
                "  {:8} {threads:3} threads {rate:9.2} million rays a second",
                KINDS[set.kind]
            );
        }
        let Outcome { hits, sum_t } = warm.outcome;
        let entry = Some(Entry { rays: set.rays.len(), hits, sum_t, rates });
        match set.kind {
            0 => line.primary = entry,
            1 => line.shadow = entry,
            2 => line.ao = entry,
            _ => line.diffuse = entry,
        }
    }
    print(&if args.json { json_line(&line)? } else { text })
}

/// What the harness prints for a library, in its order.
#[derive(Default, Serialize)]
struct Line<'a> {
    lib: &'a str,
    mesh: String,
    build_s: f64,
    mib: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    primary: Option<Entry>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shadow: Option<Entry>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ao: Option<Entry>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diffuse: Option<Entry>,
    /// The least share of their cores that the threads had.
    busy: f64,
}

/// What it prints for a kind of rays.
#[derive(Serialize)]
struct Entry {
    rays: usize,
    hits: u64,
    sum_t: f64,
    /// Millions of rays a second, by number of threads.
    #[serde(flatten)]
    rates: BTreeMap<String, f64>,
}

/// Writes the result of each ray.
fn dump(tracer: &Tracer<'_>, sets: &[RaySet], prefix: &Path, name: &str) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    for set in sets {
        for chunk in 0..set.rays.len().div_ceil(CHUNK) {
            tracer.trace(set, chunk, |t| {
                let value = if set.any && t == f32::INFINITY { 0.0 } else { t };
                bytes.extend_from_slice(&value.to_le_bytes());
            });
        }
    }
    let mut path = prefix.as_os_str().to_owned();
    path.push(format!(".{name}.f32"));
    let path = PathBuf::from(path);
    std::fs::write(&path, bytes).map_err(|error| Failure::write(&path, &error))
}
