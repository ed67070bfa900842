//! One sample again, slowly: what its path met, drew and found.
//!
//! Integrators tell a `Watch` what happens. In a render nobody watches, and what would be told is not even computed.

use aureole_desc::SceneError;
use aureole_math::{Normal3, Point2, Point3, Vector3};
use aureole_scene::{Elements, Interaction, Scene};
use aureole_spectrum::Spectrum;

use crate::film::LARGEST;
use crate::integrator::{self, Batch, PathStart};
use crate::render::{RenderOptions, SampleId, start_path};
use crate::splat::Splatter;

/// Something that happens on a path.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The path begins.
    Start {
        /// Where.
        origin: Point3,
        /// Unit direction of the camera ray.
        direction: Vector3,
        /// The sample's weight in its pixel.
        filter_weight: f32,
    },
    /// The path meets a surface.
    Vertex(Box<Vertex>),
    /// The path leaves the scene.
    Escape {
        /// Unit direction.
        direction: Vector3,
    },
    /// Light that the path itself ran into.
    Found {
        /// What it adds to the sample, weighted against light samples.
        contribution: Spectrum,
    },
    /// A light is drawn; a shadow ray will tell whether it is seen.
    Light {
        /// Which of the scene's lights; counted as in the scene's arena.
        light: u32,
        /// Unit direction towards it.
        wi: Vector3,
        /// Density of the direction per steradian, the choice of the light included.
        pdf_omega: f32,
        /// What it adds to the sample unless something is in between.
        contribution: Spectrum,
    },
    /// No light is drawn, or one that cannot be seen or reflected from here.
    Unlit,
    /// The shadow ray to the drawn light.
    Shadow {
        /// Whether something is in between.
        blocked: bool,
    },
    /// The path's next direction is drawn.
    Scatter {
        /// Unit direction.
        wi: Vector3,
        /// Density per steradian; meaningless for mirrors and windows.
        pdf_omega: f32,
        /// Value times cosine over density.
        weight: Spectrum,
        /// A mirror or a window.
        is_delta: bool,
        /// Through the surface.
        is_transmission: bool,
    },
    /// The path scatters inside a body.
    Turn {
        /// Where.
        p: Point3,
        /// How much of what is found from here reaches the pixel.
        throughput: Spectrum,
    },
    /// The surface takes the path's light.
    Absorb,
    /// Russian roulette is played.
    Roulette {
        /// The chance to go on.
        survival: f32,
        /// Whether the path goes on.
        survives: bool,
    },
}

/// A surface on a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Vertex {
    /// What the surface is made of.
    pub elements: Elements,
    /// The triangle, patch or part of the shape.
    pub primitive: u32,
    /// Position in the world.
    pub p: Point3,
    /// Unit geometric normal.
    pub ng: Normal3,
    /// Unit shading normal.
    pub ns: Normal3,
    /// Surface parameters.
    pub uv: Point2,
    /// How much of what is found from here reaches the pixel.
    pub throughput: Spectrum,
    /// The lobes of the material there.
    pub lobes: Vec<&'static str>,
}

impl Vertex {
    pub(crate) fn new(
        elements: Elements,
        at: &Interaction<'_>,
        throughput: Spectrum,
        lobes: Vec<&'static str>,
    ) -> Self {
        let surface = &at.surface;
        Self {
            elements,
            primitive: surface.primitive,
            p: surface.p,
            ng: surface.ng.into(),
            ns: surface.frame.n.into(),
            uv: surface.uv,
            throughput,
            lobes,
        }
    }
}

impl Event {
    /// Whether all its numbers are finite, and none so large that the film leaves it out.
    pub fn is_finite(&self) -> bool {
        let vector = |v: Vector3| v.is_finite();
        let fits = |s: &Spectrum| s.rgb().iter().all(|c| c.abs() <= LARGEST);
        match self {
            Self::Start { origin, direction, filter_weight } => {
                origin.is_finite() && vector(*direction) && filter_weight.is_finite()
            }
            Self::Vertex(vertex) => {
                let normals = vector(vertex.ng.into()) && vector(vertex.ns.into());
                vertex.p.is_finite() && normals && vertex.throughput.is_finite()
            }
            Self::Escape { direction } => vector(*direction),
            Self::Found { contribution } => fits(contribution),
            // The density of a light that is a mere point is no number to divide by.
            Self::Light { wi, contribution, .. } => vector(*wi) && fits(contribution),
            Self::Scatter { wi, weight, .. } => vector(*wi) && weight.is_finite(),
            Self::Turn { p, throughput } => p.is_finite() && throughput.is_finite(),
            Self::Roulette { survival, .. } => survival.is_finite(),
            Self::Unlit | Self::Shadow { .. } | Self::Absorb => true,
        }
    }
}

/// Someone who is told what happens on a path.
pub(crate) trait Watch {
    /// Hears of an event, which is made only if somebody listens.
    fn hear(&mut self, event: impl FnOnce() -> Event);
}

/// Nobody: a render as it is.
pub(crate) struct Nobody;

impl Watch for Nobody {
    #[inline(always)]
    fn hear(&mut self, _: impl FnOnce() -> Event) {}
}

impl Watch for Vec<Event> {
    fn hear(&mut self, event: impl FnOnce() -> Event) {
        self.push(event());
    }
}

/// A sample and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// The integrator's name.
    pub integrator: String,
    /// What happened, in order. Integrators other than `path` tell of the start only.
    pub events: Vec<Event>,
    /// The radiance along the sample's ray, exactly as in a render; the camera's weight is not in it.
    pub radiance: Spectrum,
}

impl Replay {
    /// The first event with a number that is not finite, and the last surface up to there.
    pub fn culprit(&self) -> Option<(usize, Option<&Vertex>)> {
        let index = self.events.iter().position(|event| !event.is_finite())?;
        let surface = self.events[..=index].iter().rev().find_map(|event| match event {
            Event::Vertex(vertex) => Some(&**vertex),
            _ => None,
        });
        Some((index, surface))
    }
}

/// Draws one sample again and tells everything about it.
///
/// # Errors
/// As [`render`](crate::render()), and for a pixel outside of the image.
pub fn replay(scene: &Scene, options: &RenderOptions, id: SampleId) -> Result<Replay, SceneError> {
    let full = scene.film.full;
    if id.x >= full.width || id.y >= full.height {
        let message = format!("pixel {},{} is not in the {} x {} image", id.x, id.y, full.width, full.height);
        return Err(SceneError::invalid(message, aureole_desc::Span::NONE));
    }
    let integrator = integrator::build(scene, options.integrator.as_deref())?;
    let (start, footprint) = start_path(scene, &Splatter::new(scene), options.seed, id);
    let filter_weight = footprint.own();
    let mut events =
        vec![Event::Start { origin: start.ray.origin, direction: start.ray.direction, filter_weight }];
    let mut radiance = [Spectrum::ZERO];
    let starts: [PathStart; 1] = [start];
    integrator.trace_watched(scene, &starts, &mut radiance, &mut Batch::default(), &mut events);
    let integrator = options.integrator.clone().unwrap_or_else(|| scene.integrator.kind.clone());
    Ok(Replay { integrator, events, radiance: radiance[0] })
}
