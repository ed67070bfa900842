//! Light transport algorithms.

mod ambient_occlusion;
mod direct;
mod layers;
mod lighting;
mod path;
mod raycast;
mod views;
mod walk;
mod whitted;

use aureole_desc::{Node, ParamDoc, Params, Report, SceneError};
use aureole_elements::sampler::SampleKey;
use aureole_math::Ray;
use aureole_scene::{Film, Scene};
use aureole_spectrum::Spectrum;

use crate::replay::Event;
pub(crate) use layers::channel_count;
use path::PathState;

/// Dimensions below this one belong to the camera: film, lens, time.
pub const FIRST_FREE_DIMENSION: u32 = 3;

/// A camera ray and the sample that it belongs to.
#[derive(Clone, Copy, Debug)]
pub struct PathStart {
    /// The ray.
    pub ray: Ray,
    /// What the camera multiplies its radiance by.
    pub weight: f32,
    /// What random numbers are drawn from.
    pub key: SampleKey,
}

/// Memory that integrators may use from batch to batch.
#[derive(Default)]
pub struct Batch {
    path: PathState,
    rays: u64,
    layers: Vec<f32>,
}

impl Batch {
    /// Lets an integrator work on a batch; returns the number of rays that were traced.
    pub(crate) fn trace(
        &mut self,
        integrator: &dyn Integrator,
        scene: &Scene,
        starts: &[PathStart],
        radiance: &mut [Spectrum],
    ) -> u64 {
        self.rays = 0;
        self.layers.clear();
        integrator.trace(scene, starts, radiance, self);
        self.rays
    }

    /// The values of the integrator's layers, ray by ray.
    pub(crate) fn layers(&self) -> &[f32] {
        &self.layers
    }
}

/// A light transport algorithm.
pub trait Integrator: Send + Sync {
    /// The names of what it gathers besides radiance: channels of the image such as `albedo.R`.
    fn layers(&self) -> &[String] {
        &[]
    }

    /// Whether lights that the camera sees directly are left out of the picture.
    fn hides_emitters(&self) -> bool {
        false
    }

    /// Estimates the radiance along each ray of a batch; `radiance` comes in black.
    fn trace(&self, scene: &Scene, starts: &[PathStart], radiance: &mut [Spectrum], batch: &mut Batch);

    /// The same for one ray, with every step told. Integrators that keep their steps to themselves only trace.
    fn trace_watched(
        &self,
        scene: &Scene,
        starts: &[PathStart; 1],
        radiance: &mut [Spectrum; 1],
        batch: &mut Batch,
        _events: &mut Vec<Event>,
    ) {
        self.trace(scene, starts, radiance, batch);
    }
}

/// An algorithm that is clearest one ray at a time.
pub(crate) trait RayIntegrator: Send + Sync {
    /// Estimates the radiance along a ray, counting the rays traced.
    fn radiance(&self, scene: &Scene, start: &PathStart, rays: &mut u64) -> Spectrum;

    /// As [`Integrator::hides_emitters`].
    fn hides_emitters(&self) -> bool {
        false
    }
}

/// Runs a [`RayIntegrator`] over batches.
struct OneByOne<T>(T);

impl<T: RayIntegrator> Integrator for OneByOne<T> {
    fn hides_emitters(&self) -> bool {
        self.0.hides_emitters()
    }

    fn trace(&self, scene: &Scene, starts: &[PathStart], radiance: &mut [Spectrum], batch: &mut Batch) {
        for (start, radiance) in starts.iter().zip(radiance) {
            *radiance = self.0.radiance(scene, start, &mut batch.rays);
        }
    }
}

/// An integrator's manual, as `aureole list` prints it.
#[derive(Clone, Copy)]
pub struct IntegratorManual {
    /// The name.
    pub kind: &'static str,
    /// What it does.
    pub summary: &'static str,
    /// Its parameters.
    pub params: &'static [ParamDoc],
    build: fn(&mut Params) -> Result<Box<dyn Integrator>, SceneError>,
}

/// All integrators.
pub fn integrators() -> &'static [IntegratorManual] {
    const ALL: &[IntegratorManual] = &[
        path::MANUAL,
        direct::MANUAL,
        whitted::MANUAL,
        raycast::MANUAL,
        ambient_occlusion::MANUAL,
        views::NORMALS,
        views::DEPTH,
        views::UV,
        views::ALBEDO,
        views::PRIMITIVE_ID,
        layers::MANUAL,
    ];
    ALL
}

/// The scene's integrator, or another one by name.
pub(crate) fn build(scene: &Scene, name: Option<&str>) -> Result<Box<dyn Integrator>, SceneError> {
    from_params(find(scene, name)?, &mut scene.integrator.params.clone(), &scene.film)
}

/// Checks the scene's integrator, or what another one by name would make of its parameters; warns about parameters that the
/// scene's does not know.
///
/// # Errors
/// An unknown integrator or a wrong parameter, once the report has no room left for it.
pub fn check(scene: &Scene, name: Option<&str>, report: &mut Report) -> Result<(), SceneError> {
    let mut params = scene.integrator.params.clone();
    match find(scene, name).and_then(|manual| from_params(manual, &mut params, &scene.film).map(|_| manual)) {
        Ok(manual) if manual.kind == scene.integrator.kind => {
            params.warn_unused(&format!("integrator `{}`", manual.kind), manual.params, report);
            Ok(())
        }
        Ok(_) => Ok(()),
        Err(error) => report.collect(error),
    }
}

fn find(scene: &Scene, name: Option<&str>) -> Result<&'static IntegratorManual, SceneError> {
    let Node { kind, span, family, .. } = &scene.integrator;
    let kind = name.unwrap_or(kind);
    integrators().iter().find(|manual| manual.kind == kind).ok_or_else(|| SceneError::UnknownKind {
        family: *family,
        kind: kind.to_owned(),
        known: integrators().iter().map(|manual| manual.kind.to_owned()).collect(),
        at: *span,
    })
}

fn from_params(
    manual: &IntegratorManual,
    params: &mut Params,
    film: &Film,
) -> Result<Box<dyn Integrator>, SceneError> {
    let alpha = film.has_alpha.then(layers::Layer::alpha);
    let layers: Vec<_> = alpha.into_iter().chain(layers::Layer::from_params(params)?).collect();
    let integrator = (manual.build)(params)?;
    Ok(if layers.is_empty() { integrator } else { layers::with_layers(integrator, layers) })
}

/// How many segments a path may have; `max_depth` = -1 means any number.
pub(crate) fn max_depth(params: &mut Params) -> Result<u32, SceneError> {
    // 2³² - 1 is how some write -1.
    let depth = params.int_in("max_depth", -1, -1, u32::MAX.into())?;
    Ok(u32::try_from(depth).unwrap_or(u32::MAX).min(u32::MAX - 1))
}
