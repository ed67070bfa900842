//! `merl`: a measured isotropic reflectance of the MERL database. Readers take the values out of its `.binary` files.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `values` | floats | | all of red, then green, then blue; by half angle, then difference angle, then its azimuth |
//! | `size` | ints | 90 90 180 | steps of the half angle, the difference angle, and its azimuth |
//!
//! Values are looked up without interpolation, as the database's own program does. Half vectors are drawn in proportion to
//! the luminance that is reflected straight back, or directions evenly by cosine. Black from behind.
//!
//! # References
//! - [Matusik et al. 2003] "A Data-Driven Reflectance Model".
//! - [Rusinkiewicz 1998] "A New Change of Variables for Efficient BRDF Representation".

use std::f32::consts::PI;
use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{PiecewiseConstant1D, Point2, Vector3, reflect, spherical_direction, warp};
use aureole_spectrum::{Spectrum, luminance};

use super::lobe::reflected;
use super::{Bsdf, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver};

/// A reflectance of the MERL database.
#[derive(Clone, Debug)]
pub struct Merl {
    data: Arc<MerlData>,
}

/// The values, and how half vectors are drawn.
#[derive(Debug)]
struct MerlData {
    /// Steps of the half angle, the difference angle, and its azimuth.
    size: [usize; 3],
    values: Arc<[f32]>,
    /// Over the root of the half angle, whose steps are the table's.
    halves: PiecewiseConstant1D,
}

impl Element for Merl {
    const SUMMARY: &'static str = "A measured isotropic reflectance of the MERL database.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "values", ty: "floats", default: "", doc: "red, then green, then blue" },
        ParamDoc { name: "size", ty: "ints", default: "90 90 180", doc: "steps of the three angles" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("values");
        let values = params.try_floats("values")?;
        let size = params.try_ints("size")?;
        let size = size.as_deref().map_or(Ok([90, 90, 180]), <[i32; 3]>::try_from);
        let size = size.ok().filter(|size| size.iter().all(|&n| n > 0)).map(|size| size.map(|n| n as usize));
        let data = values.zip(size).and_then(|(values, size)| MerlData::new(values, size));
        match data {
            Some(data) => Ok(Self { data: Arc::new(data) }),
            None => Err(SceneError::invalid("`merl` needs `values`: three for each step of its angles", at)),
        }
    }
}

impl MerlData {
    fn new(values: Arc<[f32]>, size: [usize; 3]) -> Option<Self> {
        let count = size.iter().try_fold(3_usize, |product, &n| product.checked_mul(n))?;
        if values.len() != count {
            return None;
        }
        let mut this = Self { size, values, halves: PiecewiseConstant1D::new([1.0])? };
        let steps = size[0];
        let weight = |i: usize| {
            // Retro-reflection, times the ring of half vectors of this step.
            let [low, high] = [i, i + 1].map(|i| (0.5 * PI * (i as f32 / steps as f32).powi(2)).cos());
            let cos = 0.5 * (low + high);
            luminance(this.rgb([i, 0, 0])).max(0.0) * cos * (low - high).max(1e-9)
        };
        let weights: Vec<f32> = (0..steps).map(weight).collect();
        this.halves = PiecewiseConstant1D::new(weights).or_else(|| PiecewiseConstant1D::new([1.0]))?;
        Some(this)
    }

    #[inline]
    fn rgb(&self, [i, j, k]: [usize; 3]) -> [f32; 3] {
        let [h, d, p] = self.size;
        let place = (i.min(h - 1) * d + j.min(d - 1)) * p + k.min(p - 1);
        [0, 1, 2].map(|channel| self.values[channel * h * d * p + place].max(0.0))
    }

    /// The place of half vector and difference: half angles in quadratic steps, finest at the mirror direction.
    fn place(&self, m: Vector3, wi: Vector3) -> [usize; 3] {
        let theta_h = warp::polar_angle(m);
        let (sin, cos) = theta_h.sin_cos();
        let phi = m.y.atan2(m.x);
        let (sin_phi, cos_phi) = phi.sin_cos();
        // Turned so that the half vector points up.
        let turned = Vector3::new(wi.x * cos_phi + wi.y * sin_phi, wi.y * cos_phi - wi.x * sin_phi, wi.z);
        let d = Vector3::new(turned.x * cos - turned.z * sin, turned.y, turned.x * sin + turned.z * cos);
        let mut phi_d = d.y.atan2(d.x);
        if phi_d < 0.0 {
            phi_d += PI;
        }
        let step = |x: f32, n: usize| (x.max(0.0) * n as f32) as usize;
        let half = theta_h * (2.0 / PI);
        [
            step(half.max(0.0).sqrt(), self.size[0]),
            step(warp::polar_angle(d) * (2.0 / PI), self.size[1]),
            step(phi_d / PI, self.size[2]),
        ]
    }
}

impl MaterialOps for Merl {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(MerlLobe { data: Arc::clone(&self.data) }, weight, at.frame, at.frame.n);
    }
}

/// A reflectance of the MERL database, shared by all that ask.
#[derive(Clone, Debug)]
pub struct MerlLobe {
    data: Arc<MerlData>,
}

impl MerlLobe {
    /// The density of half vectors per steradian.
    fn pdf_half(&self, m: Vector3) -> f32 {
        let theta = warp::polar_angle(m);
        let root = (theta * (2.0 / PI)).max(0.0).sqrt();
        // dθ = π root d(root)
        let ring = 2.0 * PI * theta.sin() * PI * root;
        if ring > 0.0 { self.data.halves.pdf(root) / ring } else { 0.0 }
    }
}

impl LobeOps for MerlLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let m = (wo + wi).normalized();
        Spectrum::from_rgb(self.data.rgb(self.data.place(m, wi)))
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = if uc < 0.5 {
            warp::square_to_cosine_hemisphere(u)
        } else {
            let root = self.data.halves.sample(u.x).x;
            reflect(wo, spherical_direction(0.5 * PI * root * root, 2.0 * PI * u.y))
        };
        reflected(self, wo, wi, mode)
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let m = (wo + wi).normalized();
        let glossy = self.pdf_half(m) / (4.0 * wo.abs_dot(m)).max(1e-8);
        0.5 * (warp::cosine_hemisphere_pdf(wi.z) + glossy)
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let wi = Vector3::new(-wo.x, -wo.y, wo.z);
        (self.eval(wo, wi, TransportMode::Radiance) * wo.z).clamp(0.0, 1.0)
    }
}
