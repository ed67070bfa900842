//! A dielectric coat over an opaque base, with a scattering medium between: light walks at random between the layers.
//!
//! Values and densities are estimates: unbiased for values, near for densities (which only weigh samples against each
//! other). The random numbers are a hash of the directions, so that the same question has the same answer.
//!
//! # References
//! - [Guo, Hašan and Zhao 2018] "Position-Free Monte Carlo Simulation for Arbitrary Layered BSDFs".
//! - [Pharr, Jakob and Humphreys 2023] "Physically Based Rendering", section 14.3, whose estimators these are;
//!   but the density with which the exit would have drawn a direction is taken from the exit's side, so that the shares
//!   of both strategies sum to one.

use aureole_math::{Pcg32, Point2, Vector3, hash_u64, warp};
use aureole_spectrum::Spectrum;

use super::coat::Coat;
use super::conductor::Metal;
use super::dielectric::Glass;
use super::lobe::Sides;
use super::microfacet::Microfacet;
use super::phase::HenyeyGreenstein;
use super::{
    ConductorLobe, DiffuseLobe, Lobe, LobeFlags, LobeOps, LobeSample, RoughConductorLobe, TransportMode,
    fresnel,
};

/// The opaque lower layer.
#[derive(Clone, Copy, Debug)]
pub enum Base {
    /// Matte, of an albedo.
    Matte(Spectrum),
    /// A metal, with facets if it is rough.
    Metal(Metal, Option<Microfacet>),
}

/// A coated base at a point; it looks the same from both sides.
#[derive(Clone, Copy, Debug)]
pub struct LayeredLobe {
    /// Index of the coat over that outside.
    pub eta: f32,
    /// The coat's facets; none if it is smooth.
    pub coat: Option<Microfacet>,
    /// The lower layer.
    pub base: Base,
    /// Distance of the layers, in mean free paths.
    pub thickness: f32,
    /// Mean cosine of scattering between the layers.
    pub g: f32,
    /// Albedo of the medium between the layers; black: it only absorbs.
    pub albedo: Spectrum,
    /// How often light may meet a layer or scatter.
    pub max_depth: u16,
    /// How many walks an estimate takes.
    pub sample_count: u16,
}

/// Light on its way between the layers.
struct Walk {
    beta: Spectrum,
    /// Direction of travel.
    w: Vector3,
    /// Height above the base.
    z: f32,
}

/// Where a step of a walk ends.
enum Place {
    Coat,
    Base,
    Medium,
}

impl Walk {
    fn enter(sample: &LobeSample, z: f32) -> Self {
        let beta = sample.value * (sample.wi.z.abs() / sample.pdf_omega);
        Self { beta, w: sample.wi, z }
    }

    /// Follows a scattered direction.
    fn follow(&mut self, sample: &LobeSample) {
        self.beta *= sample.value * (sample.wi.z.abs() / sample.pdf_omega);
        self.w = sample.wi;
    }

    /// Russian roulette for walks that have become faint.
    fn survives(&mut self, depth: u16, rng: &mut Pcg32) -> bool {
        let strength = self.beta.max_element();
        if strength <= 0.0 {
            return false;
        }
        if depth <= 3 || strength >= 0.25 {
            return true;
        }
        self.beta = self.beta / strength;
        rng.next_f32() < strength
    }
}

/// How light leaves towards `wi`: a direction below the coat that refracts into it.
struct Exit {
    wi: Vector3,
    /// Direction of travel below the coat.
    w: Vector3,
    /// Value over density of passing the coat.
    weight: Spectrum,
    pdf: f32,
}

fn power_heuristic(a: f32, b: f32) -> f32 {
    let (a2, b2) = (a * a, b * b);
    if a2 + b2 > 0.0 { a2 / (a2 + b2) } else { 0.0 }
}

/// Transmittance of a medium of unit extinction over a height.
fn transmittance(dz: f32, w: Vector3) -> f32 {
    (-(dz / w.z).abs()).exp()
}

/// Random numbers that depend on nothing but two vectors.
fn rng_of(a: Vector3, b: Vector3) -> Pcg32 {
    let bits = |x: f32, y: f32| u64::from(x.to_bits()) << 32 | u64::from(y.to_bits());
    let mix = |seed: u64, x: f32, y: f32| hash_u64(seed ^ bits(x, y));
    Pcg32::new(mix(mix(mix(1, a.x, a.y), a.z, b.x), b.y, b.z))
}

/// Both directions mirrored in the point, if need be, so that `wo` is above; none if `wi` then is below.
fn upright(wo: Vector3, wi: Vector3) -> Option<[Vector3; 2]> {
    let side = wo.z.signum();
    (wo.z * wi.z > 0.0).then(|| [wo * side, wi * side])
}

impl LayeredLobe {
    fn coat(&self) -> Coat {
        let glass =
            Glass { eta: self.eta, reflectance: Spectrum::ONE, transmittance: Spectrum::ONE, film: None };
        Coat::new(glass, self.coat)
    }

    fn base(&self) -> Lobe {
        match self.base {
            Base::Matte(reflectance) => DiffuseLobe { reflectance }.into(),
            Base::Metal(metal, Some(surface)) => RoughConductorLobe { metal, surface }.into(),
            Base::Metal(metal, None) => ConductorLobe { metal }.into(),
        }
    }

    fn has_medium(&self) -> bool {
        !self.albedo.is_black()
    }

    /// Moves a walk to the next layer or to where it scatters.
    fn advance(&self, walk: &mut Walk, rng: &mut Pcg32) -> Place {
        let is_up = walk.w.z > 0.0;
        if self.has_medium() {
            let dz = -(1.0 - rng.next_f32()).ln() * walk.w.z;
            let z = walk.z + dz;
            if 0.0 < z && z < self.thickness {
                walk.z = z;
                return Place::Medium;
            }
        } else {
            walk.beta *= transmittance(self.thickness, walk.w);
        }
        walk.z = if is_up { self.thickness } else { 0.0 };
        if is_up { Place::Coat } else { Place::Base }
    }

    /// One walk from `wo` to `wi`, both above.
    fn estimate(
        &self,
        layers: (&Coat, &Lobe),
        [wo, wi]: [Vector3; 2],
        mode: TransportMode,
        rng: &mut Pcg32,
    ) -> Spectrum {
        let (coat, _) = layers;
        let mut pass = |v, mode| coat.sample(Sides::Transmission, v, rng.next_f32(), rng.point2(), mode);
        let (Some(enter), Some(leave)) = (pass(wo, mode), pass(wi, mode.adjoint())) else {
            return Spectrum::ZERO;
        };
        let exit = Exit { wi, w: -leave.wi, weight: leave.value / leave.pdf_omega, pdf: leave.pdf_omega };
        let mut walk = Walk::enter(&enter, self.thickness);
        let mut sum = Spectrum::ZERO;
        for depth in 0..self.max_depth {
            if !walk.survives(depth, rng) {
                break;
            }
            match self.advance(&mut walk, rng) {
                Place::Medium => sum += self.scatter_in_medium(coat, &exit, &mut walk, mode, rng),
                Place::Coat => {
                    let (uc, u) = (rng.next_f32(), rng.point2());
                    match coat.sample(Sides::Reflection, -walk.w, uc, u, mode) {
                        Some(sample) => walk.follow(&sample),
                        None => break,
                    }
                }
                Place::Base => sum += self.scatter_at_base(layers, &exit, &mut walk, mode, rng),
            }
        }
        sum
    }

    /// Scatters by the phase function; gives what reaches the exit.
    fn scatter_in_medium(
        &self,
        coat: &Coat,
        exit: &Exit,
        walk: &mut Walk,
        mode: TransportMode,
        rng: &mut Pcg32,
    ) -> Spectrum {
        let phase = HenyeyGreenstein { g: self.g };
        let depth = self.thickness - walk.z;
        let p = phase.p(walk.w, exit.w);
        let share = if coat.is_delta() { 1.0 } else { power_heuristic(exit.pdf, p) };
        let mut sum = walk.beta * self.albedo * exit.weight * (p * share * transmittance(depth, exit.w));
        let w = phase.sample(walk.w, rng.point2());
        let pdf = phase.p(walk.w, w);
        walk.beta *= self.albedo;
        walk.w = w;
        if w.z > 0.0 && !coat.is_delta() {
            let share = power_heuristic(pdf, coat.pdf(Sides::Transmission, exit.wi, -w));
            sum += walk.beta * coat.eval(-w, exit.wi, mode) * (share * transmittance(depth, w));
        }
        sum
    }

    /// Scatters at the base; gives what reaches the exit.
    fn scatter_at_base(
        &self,
        (coat, base): (&Coat, &Lobe),
        exit: &Exit,
        walk: &mut Walk,
        mode: TransportMode,
        rng: &mut Pcg32,
    ) -> Spectrum {
        let wo = -walk.w;
        let mut sum = Spectrum::ZERO;
        if !base.is_delta() {
            let share =
                if coat.is_delta() { 1.0 } else { power_heuristic(exit.pdf, base.pdf_omega(wo, exit.w)) };
            let arrives = exit.w.z.abs() * share * transmittance(self.thickness, exit.w);
            sum += walk.beta * base.eval(wo, exit.w, mode) * exit.weight * arrives;
        }
        let Some(sample) = base.sample(wo, rng.next_f32(), rng.point2(), mode) else {
            walk.beta = Spectrum::ZERO;
            return sum;
        };
        walk.follow(&sample);
        if !coat.is_delta() {
            let share = if base.is_delta() {
                1.0
            } else {
                power_heuristic(sample.pdf_omega, coat.pdf(Sides::Transmission, exit.wi, -walk.w))
            };
            let leaves = coat.eval(-walk.w, exit.wi, mode) * transmittance(self.thickness, walk.w);
            sum += walk.beta * leaves * share;
        }
        sum
    }

    /// The end of a drawn walk, as a sample. `weight`: value over density.
    fn leave(&self, wo: Vector3, wi: Vector3, weight: Spectrum, is_delta: bool) -> Option<LobeSample> {
        let (flags, pdf_omega) = if is_delta {
            (LobeFlags::DELTA_REFLECTION, 1.0)
        } else {
            (LobeFlags::REFLECTION, self.pdf_omega(wo, wi))
        };
        (pdf_omega > 0.0).then(|| LobeSample { wi, value: weight * pdf_omega, pdf_omega, flags, eta: 1.0 })
    }
}

impl LobeOps for LayeredLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        let Some([wo, wi]) = upright(wo, wi) else { return Spectrum::ZERO };
        let (coat, base) = (self.coat(), self.base());
        let mut rng = rng_of(wo, wi);
        let walks: Spectrum =
            (0..self.sample_count).map(|_| self.estimate((&coat, &base), [wo, wi], mode, &mut rng)).sum();
        coat.eval(wo, wi, mode) + walks / f32::from(self.sample_count)
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        let side = wo.z.signum();
        let above = wo * side;
        let (coat, base) = (self.coat(), self.base());
        let first = coat.sample(Sides::Both, above, uc, u, mode)?;
        let mut is_delta = first.flags.delta;
        if !first.flags.transmission {
            return self.leave(wo, first.wi * side, first.value / first.pdf_omega, is_delta);
        }
        let mut rng = rng_of(above, Vector3::new(uc, u.x, u.y));
        let mut walk = Walk::enter(&first, self.thickness);
        // An evaluation goes straight to the exit from its last event; here leaving is an event of its own.
        for depth in 0..=self.max_depth {
            if !walk.survives(depth, &mut rng) || walk.w.z == 0.0 {
                return None;
            }
            let sample = match self.advance(&mut walk, &mut rng) {
                Place::Medium => {
                    walk.w = HenyeyGreenstein { g: self.g }.sample(walk.w, rng.point2());
                    walk.beta *= self.albedo;
                    is_delta = false;
                    continue;
                }
                Place::Base => base.sample(-walk.w, rng.next_f32(), rng.point2(), mode)?,
                Place::Coat => coat.sample(Sides::Both, -walk.w, rng.next_f32(), rng.point2(), mode)?,
            };
            is_delta &= sample.flags.delta;
            if sample.flags.transmission {
                let weight = walk.beta * sample.value / sample.pdf_omega;
                return self.leave(wo, sample.wi * side, weight, is_delta);
            }
            walk.follow(&sample);
        }
        None
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        let Some([wo, wi]) = upright(wo, wi) else { return 0.0 };
        let (coat, base, mode) = (self.coat(), self.base(), TransportMode::Radiance);
        // The other order of directions gives other random numbers than the value has.
        let mut rng = rng_of(wi, wo);
        let mut sum = 0.0;
        for _ in 0..self.sample_count {
            let mut pass = |v, mode| coat.sample(Sides::Transmission, v, rng.next_f32(), rng.point2(), mode);
            let (Some(enter), Some(leave)) = (pass(wo, mode), pass(wi, mode.adjoint())) else { continue };
            let inner = base.pdf_omega(-enter.wi, -leave.wi);
            if coat.is_delta() {
                sum += inner;
                continue;
            }
            let Some(bounce) = base.sample(-enter.wi, rng.next_f32(), rng.point2(), mode) else { continue };
            let outer = coat.pdf(Sides::Both, -bounce.wi, wi);
            sum += if base.is_delta() {
                outer
            } else {
                inner * power_heuristic(leave.pdf_omega, inner)
                    + outer * power_heuristic(bounce.pdf_omega, outer)
            };
        }
        // Walks of more bounces are taken to leave evenly.
        let walks = sum / f32::from(self.sample_count) + coat.pdf(Sides::Reflection, wo, wi);
        0.9 * walks + 0.1 * warp::UNIFORM_HEMISPHERE_PDF
    }

    fn is_delta(&self) -> bool {
        self.coat.is_none() && !self.has_medium() && matches!(self.base, Base::Metal(_, None))
    }

    fn is_estimate(&self) -> bool {
        true
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let f = fresnel::dielectric(wo.z.abs(), self.eta).reflectance;
        self.base().albedo(wo) * (1.0 - f) + f
    }
}
