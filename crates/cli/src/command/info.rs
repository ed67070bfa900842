//! `aureole info`: what a scene consists of.

use std::collections::BTreeMap;
use std::fmt::Write;

use aureole::accel::Stats;
use aureole::desc::{Family, NodeId, SceneDesc};
use serde::Serialize;

use crate::args::InfoArgs;
use crate::diagnostics::Painter;
use crate::exit::{Exit, Failure};
use crate::memory;
use crate::output::print;
use crate::progress::{duration, quantity};
use crate::session::{self, Session};

/// What is told about a scene.
#[derive(Debug, Serialize)]
struct Info {
    width: u32,
    height: u32,
    /// x, y, width, height of the part that is rendered.
    crop: [u32; 4],
    samples_per_pixel: u32,
    integrator: String,
    sampler: String,
    filter: String,
    shapes: usize,
    primitives: usize,
    groups: usize,
    instances: usize,
    materials: usize,
    textures: usize,
    /// How many elements of which kind the files describe, by family.
    kinds: BTreeMap<&'static str, BTreeMap<String, usize>>,
    cameras: Vec<String>,
    lights: usize,
    /// Corners of the box around everything that has one.
    bounds: Option<[[f32; 3]; 2]>,
    load_seconds: f64,
    build_seconds: f64,
    /// The top level, then each group that is instanced.
    accel: Vec<Accel>,
    /// What reading, building and rendering is expected to take at once, by estimate.
    predicted_memory_bytes: u64,
    /// The most that the process has had at once while it read and built the scene, where the system tells.
    peak_memory_bytes: Option<u64>,
    warnings: Vec<String>,
}

/// The acceleration structures of a level.
#[derive(Debug, Serialize)]
struct Accel {
    bytes: usize,
    bytes_a_primitive: f32,
    nodes: usize,
    leaves: usize,
    mean_children: f32,
    depth: usize,
    primitives: usize,
    /// Primitives, counted once for each leaf that holds them.
    references: usize,
    sah_cost: f32,
}

impl Accel {
    fn new(stats: &Stats) -> Self {
        Self {
            bytes: stats.bytes,
            bytes_a_primitive: stats.bytes_a_primitive(),
            nodes: stats.nodes,
            leaves: stats.leaves,
            mean_children: stats.mean_children(),
            depth: stats.depth,
            primitives: stats.primitives,
            references: stats.references,
            sah_cost: stats.sah_cost,
        }
    }

    /// Its row in the table.
    fn row(&self) -> String {
        format!(
            "{:>10} {:>11} {:>8} {:>8} {:>6} {:>9.2} {:>8.1} {:>7.2}",
            self.primitives,
            self.references,
            self.nodes,
            self.leaves,
            self.depth,
            self.mean_children,
            self.bytes_a_primitive,
            self.sah_cost
        )
    }
}

/// The table's head: what [`Accel::row`] tells.
const ACCEL_HEAD: &str = "primitives  references    nodes   leaves  depth  children    bytes    cost";

/// Runs the command.
pub(crate) fn run(args: &InfoArgs, painter: &Painter) -> Result<Exit, Failure> {
    let session = session::open(&args.scene, args.loudness, painter)?;
    let info = Info::new(&session);
    print(if args.json { super::json_line(&info)? } else { info.to_text(args.accel) })?;
    Ok(Exit::Done)
}

/// The families whose kinds are counted.
const COUNTED: [Family; 6] =
    [Family::Shape, Family::Bsdf, Family::Texture, Family::Light, Family::Medium, Family::Camera];

impl Info {
    fn new(session: &Session) -> Self {
        let Session { desc, scene, .. } = session;
        let counts = scene.counts();
        let crop = scene.film.crop;
        let bounds = scene.bounds();
        let root = |node: Option<NodeId>, default: &str| {
            node.map_or_else(|| default.to_owned(), |id| desc[id].kind.clone())
        };
        Self {
            width: scene.film.full.width,
            height: scene.film.full.height,
            crop: [crop.x, crop.y, crop.width, crop.height],
            samples_per_pixel: scene.sampler.sample_count(),
            integrator: scene.integrator.kind.clone(),
            sampler: root(desc.sampler, "sobol"),
            filter: root(desc.filter, "box"),
            shapes: counts.shapes,
            primitives: counts.primitives,
            groups: counts.groups,
            instances: counts.instances,
            materials: counts.materials,
            textures: counts.textures,
            kinds: COUNTED.iter().map(|&family| (family.name(), kinds(desc, family))).collect(),
            cameras: desc.cameras.iter().map(|&id| camera_name(desc, id)).collect(),
            lights: counts.lights,
            bounds: (!bounds.is_empty()).then(|| [bounds.min.to_array(), bounds.max.to_array()]),
            load_seconds: session.load_seconds,
            build_seconds: session.build_seconds,
            accel: scene.accel_stats().iter().map(Accel::new).collect(),
            predicted_memory_bytes: session.estimate.peak(),
            peak_memory_bytes: memory::peak(),
            warnings: session.report.warnings.iter().map(|warning| warning.message.clone()).collect(),
        }
    }

    fn to_text(&self, with_accel: bool) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<12} {value}"); // writing to a string cannot fail
        };
        let [x, y, width, height] = self.crop;
        let whole = (x, y, width, height) == (0, 0, self.width, self.height);
        let crop = if whole { String::new() } else { format!(", of which {width} x {height} at {x}, {y}") };
        line("image", format!("{} x {} pixels{crop}", self.width, self.height));
        let (spp, sampler) = (self.samples_per_pixel, &self.sampler);
        line("sampling", format!("{spp} samples a pixel, {sampler}, {} filter", self.filter));
        line("integrator", self.integrator.clone());
        line("cameras", self.cameras.join(", "));
        line("lights", format!("{}{}", self.lights, listed(&self.kinds["light"])));
        line("shapes", format!("{}{}", self.shapes, listed(&self.kinds["shape"])));
        line("primitives", self.primitives.to_string());
        line("instances", format!("{} of {} groups", self.instances, self.groups));
        line("materials", format!("{}{}", self.materials, listed(&self.kinds["bsdf"])));
        line("textures", format!("{}{}", self.textures, listed(&self.kinds["texture"])));
        line("bounds", self.bounds.map_or("none".into(), |[low, high]| format!("{low:?} to {high:?}")));
        let memory =
            self.peak_memory_bytes.map_or("?".into(), |bytes| format!("{}B", quantity(bytes as f64)));
        let predicted = quantity(self.predicted_memory_bytes as f64);
        line("memory", format!("{predicted}B to render it, by estimate; {memory} so far"));
        let bytes: usize = self.accel.iter().map(|level| level.bytes).sum();
        line("acceleration", format!("{}B", quantity(bytes as f64)));
        if with_accel {
            line("  level", ACCEL_HEAD.into());
            for (i, level) in self.accel.iter().enumerate() {
                line(&if i == 0 { "  top".into() } else { format!("  group {i}") }, level.row());
            }
            line("", "children a node, bytes a primitive, expected visits and tests a ray (SAH)".into());
        }
        line(
            "time",
            format!("{} to read, {} to build", duration(self.load_seconds), duration(self.build_seconds)),
        );
        line("warnings", self.warnings.len().to_string());
        text
    }
}

/// How many elements of a family there are of which kind.
fn kinds(desc: &SceneDesc, family: Family) -> BTreeMap<String, usize> {
    let mut kinds = BTreeMap::new();
    for (_, node) in desc.nodes().filter(|(_, node)| node.family == family) {
        *kinds.entry(node.kind.clone()).or_default() += 1;
    }
    kinds
}

fn listed(kinds: &BTreeMap<String, usize>) -> String {
    if kinds.is_empty() {
        return String::new();
    }
    let items: Vec<_> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    format!(" ({})", items.join(", "))
}

fn camera_name(desc: &SceneDesc, id: NodeId) -> String {
    let node = &desc[id];
    node.name.as_ref().map_or_else(|| node.kind.clone(), |name| format!("{} `{name}`", node.kind))
}
