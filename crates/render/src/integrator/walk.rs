//! Paths inside bodies: free flights between scattering, until the boundary lets them out.

use aureole_elements::Sampler;
use aureole_elements::bsdf::Interior;
use aureole_elements::sampler::SampleKey;
use aureole_math::{Pcg32, Point2, Point3, Ray, Vector3, hash_u64};
use aureole_scene::Interaction;
use aureole_spectrum::Spectrum;

/// Events after which a walk ends in any case.
const MAX_EVENTS: u32 = 1 << 16;

/// Events before long walks are thinned out.
const LONG: u32 = 256;

/// Where a path is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// In the open.
    Outside,
    /// In a body; so many events ago it came in.
    Inside { events: u32 },
}

/// Where a vertex draws its random numbers.
pub(super) enum Numbers<'a> {
    /// From the sampler, for the vertices of a path in the open.
    Sampler { sampler: &'a Sampler, key: SampleKey, dimension: u32 },
    /// From a generator of its own, for the many events of a walk.
    Walk(Pcg32),
}

impl Numbers<'_> {
    /// One number, for the vertex' own dimension `d`.
    #[inline]
    pub(super) fn one(&mut self, d: u32) -> f32 {
        match self {
            Self::Sampler { sampler, key, dimension } => sampler.get_1d(*key, *dimension + d),
            Self::Walk(rng) => rng.next_f32(),
        }
    }

    /// Two numbers.
    #[inline]
    pub(super) fn two(&mut self, d: u32) -> Point2 {
        match self {
            Self::Sampler { sampler, key, dimension } => sampler.get_2d(*key, *dimension + d),
            Self::Walk(rng) => rng.point2(),
        }
    }
}

/// The generator of an event: a function of the sample and of how the path came here, as all random numbers are.
pub(super) fn numbers_of(key: SampleKey, depth: u32, events: u32) -> Pcg32 {
    let sample = u64::from(key.pixel_hash) << 32 | u64::from(key.sample);
    Pcg32::new(hash_u64(sample ^ hash_u64(u64::from(depth) << 32 | u64::from(events))))
}

/// What rounding may do to a place near `origin`: a body counts as empty so near to its boundary, so that no walk gets out
/// by rounding.
#[inline]
fn margin(origin: Point3) -> f32 {
    4.0 * f32::EPSILON * origin.to_vector().abs().max_element()
}

/// A ray that ends where its free flight does.
#[inline]
pub(super) fn flight(ray: Ray, interior: &Interior, throughput: Spectrum, rng: &mut Pcg32) -> Ray {
    if !interior.scatters() {
        return ray;
    }
    let length = interior.sample_flight(throughput, rng.next_f32(), rng.next_f32());
    ray.until((length + margin(ray.origin)).min(f32::MAX))
}

/// What is left of the light of a flight that met a surface after `distance`.
#[inline]
pub(super) fn after_flight(
    interior: &Interior,
    throughput: Spectrum,
    origin: Point3,
    distance: f32,
) -> Spectrum {
    if interior.scatters() {
        interior.after_passage(throughput, (distance - margin(origin)).max(0.0))
    } else {
        throughput * interior.transmittance(distance.min(f32::MAX))
    }
}

/// The next flight after an event: where it starts, and what is left; none if the walk ends here.
pub(super) fn scatter(
    interior: &Interior,
    ray: &Ray,
    throughput: Spectrum,
    (eta, events): (f32, u32),
    rng: &mut Pcg32,
) -> Option<(Ray, Spectrum)> {
    let length = ray.t_max - margin(ray.origin);
    let left = interior.after_scattering(throughput, length);
    // Refraction squeezed the radiance on its way in, and will spread it again.
    let left = left / survival(left.max_element() * eta * eta, events, rng)?;
    let onward =
        Ray { time: ray.time, ..Ray::new(ray.at(length), interior.turn(ray.direction, rng.point2())) };
    Some((flight(onward, interior, left, rng), left))
}

/// Russian roulette for walks that are faint or long: the chance that was taken, if the walk goes on.
fn survival(strength: f32, events: u32, rng: &mut Pcg32) -> Option<f32> {
    if strength <= 0.0 || events >= MAX_EVENTS {
        return None;
    }
    let mut chance = if strength < 0.25 { strength } else { 1.0 };
    // A walk is longer than n with a chance like 1/sqrt(n): weights that grow like n^(1/4) cost the least variance for their time.
    if events >= LONG && events.is_power_of_two() {
        chance *= std::f32::consts::FRAC_1_SQRT_2;
    }
    (chance >= 1.0 || rng.next_f32() < chance).then_some(chance)
}

/// Whether light from `wi` reaches a path's vertex through the open, so that light samples may be drawn for it. What travels in
/// a body is found by the path alone.
#[inline]
pub(super) fn sees_open(
    place: Place,
    has_interior: bool,
    at: &Interaction<'_>,
    wo: Vector3,
    wi: Vector3,
) -> bool {
    let n = at.surface.frame.n;
    match place {
        Place::Outside => !(has_interior && wi.dot(n) < 0.0),
        Place::Inside { .. } => wo.dot(n) < 0.0 && wi.dot(n) > 0.0,
    }
}

/// A direction that stays on the inner side of a surface also where shading normals are not the true ones.
#[inline]
pub(super) fn kept_inside(at: &Interaction<'_>, w: Vector3) -> Vector3 {
    let surface = &at.surface;
    let ng = surface.ng.face_forward(surface.frame.n);
    let outward = w.dot(ng);
    if outward > 0.0 { w - ng * (2.0 * outward) } else { w }
}
