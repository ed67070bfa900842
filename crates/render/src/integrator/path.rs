//! `path`: path tracing with next-event estimation, multiple importance sampling and Russian roulette.
//!
//! A batch of paths is advanced stage by stage: all rays are traced, all hits shaded, all shadow rays traced. Finished
//! paths drop out, so that what is left stays together in memory.
//!
//! References: [Kajiya 1986] "The Rendering Equation"; [Veach 1997] "Robust Monte Carlo Methods for Light Transport
//! Simulation".

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_elements::Bsdf;
use aureole_elements::bsdf::{BsdfSample, Interior, TransportMode};
use aureole_math::{Point3, Ray};
use aureole_scene::{Interaction, Scene, SceneHit};
use aureole_spectrum::{Spectrum, Wavelengths};

use super::lighting::{LightNumbers, Weighting, environment, light_pdf, power_heuristic, sample_light};
use super::walk::{self, Numbers, Place};
use super::{Batch, FIRST_FREE_DIMENSION, Integrator, IntegratorManual, PathStart, max_depth};
use crate::replay::{Event, Nobody, Vertex, Watch};

pub(super) const MANUAL: IntegratorManual = IntegratorManual {
    kind: "path",
    summary: "Path tracing with next-event estimation, multiple importance sampling and Russian roulette.",
    params: &[
        ParamDoc {
            name: "max_depth",
            ty: "int",
            default: "-1",
            doc: "longest path in segments; -1 for any length",
        },
        ParamDoc {
            name: "rr_depth",
            ty: "int",
            default: "5",
            doc: "segments before Russian roulette starts",
        },
        ParamDoc {
            name: "hide_emitters",
            ty: "bool",
            default: "false",
            doc: "lights are not seen by the camera itself",
        },
        ParamDoc {
            name: "see_through",
            ty: "bool",
            default: "true",
            doc: "surfaces that light passes straight on through are no segments' ends, and let light samples pass",
        },
        ParamDoc {
            name: "regularize",
            ty: "bool",
            default: "false",
            doc: "roughen mirrors and windows behind the first bounce that was none's",
        },
        ParamDoc {
            name: "force_diffuse",
            ty: "bool",
            default: "false",
            doc: "every surface is matte, and scatters as much light as it would otherwise",
        },
    ],
    build: |params| Ok(Box::new(Path::from_params(params)?)),
};

struct Path {
    max_depth: u32,
    rr_depth: u32,
    hide_emitters: bool,
    see_through: bool,
    regularize: bool,
    force_diffuse: bool,
}

/// A path between two surfaces.
#[derive(Clone, Copy)]
struct Segment {
    throughput: Spectrum,
    /// Where the segment starts, for densities of light samples.
    reference: Point3,
    /// Density of its direction; infinite when no light sample could have found what it finds.
    pdf_omega: f32,
    /// Product of the relative indices of refraction so far, for Russian roulette.
    eta: f32,
    /// The path's place in the batch.
    path: u32,
    /// Segments before this one; all those inside a body that scatters are one.
    depth: u32,
    /// Surfaces before this one that drew random numbers.
    vertex: u32,
    /// Whether some bounce was neither a mirror's nor a window's.
    is_diffused: bool,
    /// Whether nothing but surfaces that let it pass straight through came before: what it finds is seen directly.
    is_direct: bool,
    place: Place,
}

/// A shadow ray's path and what it may add.
#[derive(Clone, Copy)]
struct Pending {
    path: u32,
    contribution: Spectrum,
}

/// The state of a batch, kept to spare allocations.
#[derive(Default)]
pub(super) struct PathState {
    rays: Vec<Ray>,
    segments: Vec<Segment>,
    hits: Vec<SceneHit>,
    next_rays: Vec<Ray>,
    next_segments: Vec<Segment>,
    shadow_rays: Vec<Ray>,
    pending: Vec<Pending>,
    blocked: Vec<bool>,
    bsdf: Bsdf,
    /// What fills the body that a path is in.
    interiors: Vec<Interior>,
}

/// Random numbers of one bounce, by dimension.
const LIGHT_CHOICE: u32 = 0;
const LIGHT_PLACE: u32 = 1;
const LOBE: u32 = 2;
const DIRECTION: u32 = 3;
const ROULETTE: u32 = 4;
const PER_BOUNCE: u32 = 5;

impl Path {
    fn from_params(params: &mut Params) -> Result<Self, SceneError> {
        Ok(Self {
            max_depth: max_depth(params)?,
            rr_depth: params.int_in("rr_depth", 5, 0, i64::from(u32::MAX))? as u32,
            hide_emitters: params.bool("hide_emitters", false)?,
            see_through: params.bool("see_through", true)?,
            regularize: params.bool("regularize", false)?,
            force_diffuse: params.bool("force_diffuse", false)?,
        })
    }

    /// Adds what a segment found, and continues its path from there.
    fn shade<W: Watch>(
        &self,
        scene: &Scene,
        starts: &[PathStart],
        radiance: &mut [Spectrum],
        state: &mut PathState,
        i: usize,
        watch: &mut W,
    ) {
        let (ray, mut segment, hit) = (state.rays[i], state.segments[i], state.hits[i]);
        if let Place::Inside { events } = segment.place {
            let interior = state.interiors[segment.path as usize];
            if !hit.is_some() && interior.scatters() {
                return Self::scatter_inside(&starts[segment.path as usize], state, i, events, watch);
            }
            segment.throughput = walk::after_flight(&interior, segment.throughput, ray.origin, hit.t);
        }
        let found = &mut radiance[segment.path as usize];
        let is_visible = !(segment.is_direct && self.hide_emitters);
        if !hit.is_some() {
            watch.hear(|| Event::Escape { direction: ray.direction });
            if is_visible {
                let weight = |pdf: f32| power_heuristic(segment.pdf_omega, pdf);
                let contribution =
                    segment.throughput * environment(scene, segment.reference, ray.direction, weight);
                watch.hear(|| Event::Found { contribution });
                *found += contribution;
            }
            return;
        }
        let at = scene.interaction(&ray, &hit);
        watch.hear(|| {
            let lobes = scene.bsdf(&at, -ray.direction, Wavelengths::RGB).lobe_names();
            Event::Vertex(Box::new(Vertex::new(scene.elements(&hit), &at, segment.throughput, lobes)))
        });
        if at.light.is_some() && is_visible {
            let emitted = scene.emitted(&at, -ray.direction, Wavelengths::RGB);
            if !emitted.is_black() {
                let pdf = light_pdf(scene, segment.reference, ray.direction, &at);
                let contribution = segment.throughput * emitted * power_heuristic(segment.pdf_omega, pdf);
                watch.hear(|| Event::Found { contribution });
                *found += contribution;
            }
        }
        if segment.depth + 1 < self.max_depth || self.sees_through(scene) {
            self.scatter(scene, &starts[segment.path as usize], state, &ray, segment, &at, watch);
        }
    }

    /// Turns a path inside a body.
    fn scatter_inside<W: Watch>(
        start: &PathStart,
        state: &mut PathState,
        i: usize,
        events: u32,
        watch: &mut W,
    ) {
        let (ray, segment) = (state.rays[i], state.segments[i]);
        let interior = state.interiors[segment.path as usize];
        let mut rng = walk::numbers_of(start.key, segment.vertex, events);
        let next = walk::scatter(&interior, &ray, segment.throughput, (segment.eta, events), &mut rng);
        let Some((onward, throughput)) = next else {
            watch.hear(|| Event::Absorb);
            return;
        };
        watch.hear(|| Event::Turn { p: onward.origin, throughput });
        state.next_rays.push(onward);
        let place = Place::Inside { events: events + 1 };
        state.next_segments.push(Segment { throughput, place, reference: onward.origin, ..segment });
    }

    /// Draws a light sample and the path's next direction.
    #[expect(clippy::too_many_arguments, reason = "the state of one path at one surface, and who watches it")]
    fn scatter<W: Watch>(
        &self,
        scene: &Scene,
        start: &PathStart,
        state: &mut PathState,
        ray: &Ray,
        segment: Segment,
        at: &Interaction<'_>,
        watch: &mut W,
    ) {
        let wo = -ray.direction;
        let depth = segment.depth;
        let is_last = depth + 1 >= self.max_depth;
        // In a body that scatters the path has far more vertices than the sampler has dimensions.
        let walked = match segment.place {
            Place::Inside { events } if state.interiors[segment.path as usize].scatters() => Some(events),
            _ => None,
        };
        let mut numbers = match walked {
            Some(events) => Numbers::Walk(walk::numbers_of(start.key, segment.vertex, events)),
            None => Numbers::Sampler {
                sampler: &scene.sampler,
                key: start.key,
                dimension: FIRST_FREE_DIMENSION + segment.vertex * PER_BOUNCE,
            },
        };
        let bsdf = &mut state.bsdf;
        scene.bsdf_into(at, wo, Wavelengths::RGB, bsdf);
        if self.force_diffuse {
            // Numbers that nothing else draws: no walk is so long.
            let mut rng = walk::numbers_of(start.key, segment.vertex, 1 << 31);
            bsdf.make_diffuse(wo, rng.next_f32(), rng.point2());
        } else if self.regularize && segment.is_diffused {
            bsdf.regularize();
        }
        let has_interior = bsdf.has_interior();
        let sees_open = |wi| walk::sees_open(segment.place, has_interior, at, wo, wi);
        if bsdf.is_smooth() && !is_last {
            let numbers = LightNumbers {
                // Numbers that decide nothing are not drawn.
                choice: if scene.picker.has_choice() { numbers.one(LIGHT_CHOICE) } else { 0.0 },
                place: numbers.two(LIGHT_PLACE),
            };
            let weighting = Weighting::Against { lights: 1, bsdfs: 1 };
            let light = sample_light(scene, at, bsdf, wo, numbers, weighting, ray.time);
            if let Some(light) = light.filter(|light| sees_open(light.ray.direction)) {
                let contribution = segment.throughput * light.contribution;
                watch.hear(|| light.event(contribution));
                state.shadow_rays.push(light.ray);
                state.pending.push(Pending { path: segment.path, contribution });
            } else {
                watch.hear(|| Event::Unlit);
            }
        }
        let lobe = if bsdf.has_choice() { numbers.one(LOBE) } else { 0.0 };
        let Some(drawn) = bsdf.sample(wo, lobe, numbers.two(DIRECTION), TransportMode::Radiance) else {
            watch.hear(|| Event::Absorb);
            return;
        };
        watch.hear(|| Event::Scatter {
            wi: drawn.wi,
            pdf_omega: drawn.pdf_omega,
            weight: drawn.weight,
            is_delta: drawn.flags.delta,
            is_transmission: drawn.flags.transmission,
        });
        if drawn.flags.null && self.see_through {
            return Self::pass(state, start, &segment, &drawn, at.surface.spawn_ray(drawn.wi, ray.time));
        }
        if is_last {
            return;
        }
        let mut next = Segment {
            throughput: segment.throughput * drawn.weight,
            reference: at.surface.p,
            pdf_omega: if drawn.flags.delta || !sees_open(drawn.wi) {
                f32::INFINITY
            } else {
                drawn.pdf_omega
            },
            eta: segment.eta * drawn.eta,
            path: segment.path,
            depth: depth + 1,
            vertex: segment.vertex + 1,
            is_diffused: segment.is_diffused || !drawn.flags.delta,
            is_direct: segment.is_direct && drawn.is_straight(),
            place: Self::place_after(state, &segment, &drawn, drawn.wi.dot(at.surface.frame.n) < 0.0),
        };
        if next.throughput.is_black() {
            return;
        }
        let is_walking = walked.is_some() && next.place != Place::Outside;
        if is_walking {
            (next.depth, next.vertex) = (depth, segment.vertex);
        }
        if is_walking || depth + 1 >= self.rr_depth {
            // Refraction squeezes radiance, but a path that will leave the glass again is not weaker for it.
            let survival = (next.throughput.max_element() * next.eta * next.eta).min(0.95);
            let survives = numbers.one(ROULETTE) < survival;
            watch.hear(|| Event::Roulette { survival, survives });
            if !survives {
                return;
            }
            next.throughput = next.throughput / survival;
        }
        let direction = if next.place == Place::Outside { drawn.wi } else { walk::kept_inside(at, drawn.wi) };
        Self::launch(state, start, next, at.surface.spawn_ray(direction, ray.time));
    }

    /// Sends a path on its way, in a body until the end of its free flight.
    fn launch(state: &mut PathState, start: &PathStart, next: Segment, onward: Ray) {
        state.next_rays.push(match next.place {
            Place::Outside => onward,
            Place::Inside { events } => {
                let interior = &state.interiors[next.path as usize];
                // Numbers that no vertex draws: they lie beyond the events of any walk.
                let mut rng = walk::numbers_of(start.key, next.vertex, !events);
                walk::flight(onward, interior, next.throughput, &mut rng)
            }
        });
        state.next_segments.push(next);
    }

    /// Whether some surfaces may count as if they were not there.
    fn sees_through(&self, scene: &Scene) -> bool {
        self.see_through && scene.is_see_through()
    }

    /// Lets a path go straight on: what it finds is still weighed against the light samples of the last surface.
    fn pass(state: &mut PathState, start: &PathStart, segment: &Segment, drawn: &BsdfSample, onward: Ray) {
        // More surfaces than this count as opaque, so that no path goes on for ever.
        const MOST: u32 = 1 << 12;
        let (throughput, vertex) = (segment.throughput * drawn.weight, segment.vertex + 1);
        if vertex < segment.depth.saturating_add(MOST) {
            Self::launch(state, start, Segment { throughput, vertex, ..*segment }, onward);
        }
    }

    /// Where a path is after it was scattered at a surface.
    fn place_after(state: &mut PathState, segment: &Segment, drawn: &BsdfSample, is_inward: bool) -> Place {
        let path = segment.path as usize;
        match (segment.place, drawn.flags.transmission, is_inward) {
            (_, true, true) if let Some(interior) = drawn.interior => {
                if state.interiors.len() <= path {
                    state.interiors.resize(path + 1, Interior::CLEAR);
                }
                state.interiors[path] = state.bsdf.interior(interior);
                Place::Inside { events: 0 }
            }
            (_, true, false) => Place::Outside,
            (Place::Inside { events }, ..) => Place::Inside { events: events + 1 },
            (Place::Outside, ..) => Place::Outside,
        }
    }
}

impl PathState {
    fn begin(&mut self, starts: &[PathStart]) {
        self.rays.clear();
        self.segments.clear();
        for (i, start) in starts.iter().enumerate() {
            self.rays.push(start.ray);
            self.segments.push(Segment {
                throughput: Spectrum::ONE,
                reference: start.ray.origin,
                pdf_omega: f32::INFINITY,
                eta: 1.0,
                path: i as u32,
                depth: 0,
                vertex: 0,
                is_diffused: false,
                is_direct: true,
                place: Place::Outside,
            });
        }
    }

    /// Traces the shadow rays and adds what arrives.
    fn light<W: Watch>(
        &mut self,
        scene: &Scene,
        sees_through: bool,
        radiance: &mut [Spectrum],
        watch: &mut W,
    ) {
        self.blocked.clear();
        self.blocked.resize(self.shadow_rays.len(), false);
        scene.occluded_many(&self.shadow_rays, &mut self.blocked);
        for ((pending, ray), &blocked) in self.pending.iter().zip(&self.shadow_rays).zip(&self.blocked) {
            let passed = match (blocked, sees_through) {
                (false, _) => Spectrum::ONE,
                (true, false) => Spectrum::ZERO,
                (true, true) => scene.transmittance(ray, Wavelengths::RGB),
            };
            watch.hear(|| Event::Shadow { blocked: passed.is_black() });
            radiance[pending.path as usize] += pending.contribution * passed;
        }
        self.shadow_rays.clear();
        self.pending.clear();
    }
}

impl Path {
    /// Advances all paths of a batch to their ends.
    fn advance<W: Watch>(
        &self,
        scene: &Scene,
        starts: &[PathStart],
        radiance: &mut [Spectrum],
        batch: &mut Batch,
        watch: &mut W,
    ) {
        let state = &mut batch.path;
        state.begin(starts);
        while !state.rays.is_empty() && self.max_depth > 0 {
            state.hits.clear();
            state.hits.resize(state.rays.len(), SceneHit::NONE);
            scene.closest_hits(&state.rays, &mut state.hits);
            batch.rays += state.rays.len() as u64;
            for i in 0..state.rays.len() {
                self.shade(scene, starts, radiance, state, i, watch);
            }
            batch.rays += state.shadow_rays.len() as u64;
            state.light(scene, self.sees_through(scene), radiance, watch);
            std::mem::swap(&mut state.rays, &mut state.next_rays);
            std::mem::swap(&mut state.segments, &mut state.next_segments);
            state.next_rays.clear();
            state.next_segments.clear();
        }
    }
}

impl Integrator for Path {
    fn hides_emitters(&self) -> bool {
        self.hide_emitters
    }

    fn trace(&self, scene: &Scene, starts: &[PathStart], radiance: &mut [Spectrum], batch: &mut Batch) {
        self.advance(scene, starts, radiance, batch, &mut Nobody);
    }

    fn trace_watched(
        &self,
        scene: &Scene,
        starts: &[PathStart; 1],
        radiance: &mut [Spectrum; 1],
        batch: &mut Batch,
        events: &mut Vec<Event>,
    ) {
        self.advance(scene, starts, radiance, batch, events);
    }
}
