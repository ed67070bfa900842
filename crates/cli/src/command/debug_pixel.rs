//! `aureole render --debug-pixel`: one sample's path, vertex by vertex.

use std::fmt::Write;

use aureole::desc::{NodeId, SceneDesc, Sources};
use aureole::render::replay::{Event, Replay, Vertex, replay};
use aureole::render::{RenderOptions, SampleId};
use aureole::scene::{Elements, Scene};

use crate::args::PixelArg;
use crate::exit::{Exit, Failure};
use crate::output::print;
use crate::session::Session;

/// Prints the path of one sample.
pub(crate) fn run(session: &Session, options: &RenderOptions, pixel: PixelArg) -> Result<Exit, Failure> {
    let id = SampleId { x: pixel.x, y: pixel.y, sample: pixel.sample };
    let replay = replay(&session.scene, options, id).map_err(|error| Failure::usage(error.to_string()))?;
    print(Teller::new(session).tell(&replay, id, options.seed))?;
    Ok(Exit::Done)
}

/// What to say about the first sample of a render that was not finite: where it went wrong, and how to look at it.
pub(crate) fn explain(session: &Session, options: &RenderOptions, id: SampleId) -> (String, String) {
    let SampleId { x, y, sample } = id;
    let mut text = format!("the first is sample {sample} of pixel {x},{y}");
    let found = replay(&session.scene, options, id).ok();
    if let Some((_, Some(vertex))) = found.as_ref().and_then(Replay::culprit) {
        let _ = write!(text, ", at {}", Teller::new(session).surface(&vertex.elements)); // cannot fail
    }
    (text, format!("`--debug-pixel {x},{y},{sample}` shows its path"))
}

/// Puts events into words; elements are named as their files name them.
struct Teller<'a> {
    scene: &'a Scene,
    desc: &'a SceneDesc,
    sources: &'a Sources,
}

impl<'a> Teller<'a> {
    fn new(session: &'a Session) -> Self {
        Self { scene: &session.scene, desc: &session.desc, sources: &session.sources }
    }

    /// The whole path.
    fn tell(&self, replay: &Replay, id: SampleId, seed: u64) -> String {
        let SampleId { x, y, sample } = id;
        let mut text =
            format!("pixel {x},{y}, sample {sample}, seed {seed}, integrator {}\n", replay.integrator);
        let culprit = replay.culprit().map(|(index, _)| index);
        let mut vertices = 0;
        for (i, event) in replay.events.iter().enumerate() {
            vertices += usize::from(matches!(event, Event::Vertex(_)));
            let mark = if culprit == Some(i) { "   <- not finite" } else { "" };
            for line in self.event(event, vertices).lines() {
                text.push_str(line);
                text.push_str(mark);
                text.push('\n');
            }
        }
        let _ = writeln!(text, "radiance     {}", rgb(replay.radiance.rgb())); // cannot fail
        text
    }

    fn event(&self, event: &Event, number: usize) -> String {
        match event {
            Event::Start { origin, direction, filter_weight } => format!(
                "camera       from {} towards {}, filter weight {filter_weight}",
                xyz(origin.to_array()),
                xyz(direction.to_array())
            ),
            Event::Vertex(vertex) => self.vertex(vertex, number),
            Event::Escape { direction } => format!("escape       towards {}", xyz(direction.to_array())),
            Event::Found { contribution } => format!("  found      adds {}", rgb(contribution.rgb())),
            Event::Light { light, wi, pdf_omega, contribution } => format!(
                "  light      {}, towards {}, density {pdf_omega}\n             would add {}",
                self.light(*light),
                xyz(wi.to_array()),
                rgb(contribution.rgb())
            ),
            Event::Unlit => "  light      none that adds anything".to_owned(),
            Event::Shadow { blocked: true } => "  shadow     blocked: adds nothing".to_owned(),
            Event::Shadow { blocked: false } => "  shadow     free: adds it".to_owned(),
            Event::Scatter { wi, pdf_omega, weight, is_delta, is_transmission } => {
                let way = if *is_transmission { "transmitted" } else { "reflected" };
                let density =
                    if *is_delta { "no other way".to_owned() } else { format!("density {pdf_omega}") };
                format!(
                    "  scatter    {way} towards {}, {density}, weight {}",
                    xyz(wi.to_array()),
                    rgb(weight.rgb())
                )
            }
            Event::Turn { p, throughput } => {
                format!("  turns      inside, at {}, throughput {}", xyz(p.to_array()), rgb(throughput.rgb()))
            }
            Event::Absorb => "  absorb     the path ends".to_owned(),
            Event::Roulette { survival, survives } => {
                let outcome = if *survives { "goes on" } else { "ends" };
                format!("  roulette   survival {survival}: {outcome}")
            }
        }
    }

    fn vertex(&self, vertex: &Vertex, number: usize) -> String {
        format!(
            "vertex {number:<5} {}, primitive {}\n\
             \x20 place      {}, uv {}, {}\n\
             \x20 normal     {} geometric, {} shading\n\
             \x20 lobes      {}\n\
             \x20 throughput {}",
            self.surface(&vertex.elements),
            vertex.primitive,
            xyz(vertex.p.to_array()),
            vertex.uv.x,
            vertex.uv.y,
            xyz(vertex.ng.to_array()),
            xyz(vertex.ns.to_array()),
            if vertex.lobes.is_empty() {
                "none: it absorbs everything".to_owned()
            } else {
                vertex.lobes.join(", ")
            },
            rgb(vertex.throughput.rgb()),
        )
    }

    /// A shape and its material.
    fn surface(&self, elements: &Elements) -> String {
        let [shape, material] = self.scene.kinds(elements);
        let origins = &self.scene.origins;
        let shape = self.named(shape, origins.shape(elements.shape));
        let material = match origins.material(elements.material) {
            None => "the default material".to_owned(),
            node => self.named(material, node),
        };
        format!("{shape} of {material}")
    }

    fn light(&self, index: u32) -> String {
        let id = aureole::math::Id::new(index);
        self.named(self.scene.lights[id].kind(), self.scene.origins.light(id))
    }

    /// A kind with its name and place in the file.
    fn named(&self, kind: &str, node: Option<NodeId>) -> String {
        let Some(node) = node.map(|id| &self.desc[id]) else { return kind.to_owned() };
        let name = node.name.as_ref().map_or_else(String::new, |name| format!(" `{name}`"));
        let place = self.sources.locate(node.span).map_or_else(String::new, |place| format!(" ({place})"));
        format!("{kind}{name}{place}")
    }
}

fn xyz([x, y, z]: [f32; 3]) -> String {
    format!("({x}, {y}, {z})")
}

fn rgb([r, g, b]: [f32; 3]) -> String {
    format!("[{r} {g} {b}]")
}
