//! `measured`: a reflectance that a gonio-photometer measured, in the adaptive parametrisation of the RGL's material
//! database. Readers take the parameters out of its `.bsdf` files.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `phi_i`, `theta_i` | floats | | azimuths and polar angles of incidence, in radians, that were measured |
//! | `ndf`, `sigma` | floats | | normals' distribution, projected area; each with its `_size`: rows, columns |
//! | `vndf`, `luminance` | floats | | per incidence: visible normals, and the luminance over them; each with its `_size` |
//! | `rgb` | floats | | per incidence three tables over visible normals, of the size of `luminance` |
//! | `spectra` | floats | | instead of `rgb`: a table per entry of `wavelengths` |
//! | `wavelengths` | floats | | in nanometres |
//! | `jacobian` | bool | true | whether the tables lack the factor ndf / (4 sigma) |
//!
//! Spectra are integrated to linear Rec. 709 under D65 when the material is built. Black from behind.
//!
//! # References
//! [Dupuy and Jakob 2018] "An Adaptive Parameterization for Efficient Material Acquisition and Rendering".

mod data;
mod warp;

use std::f32::consts::PI;
use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector3, reflect};
use aureole_spectrum::Spectrum;

use super::lobe::reflected;
use super::{Bsdf, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver};

use data::MeasuredData;
use warp::Slices;

/// A measured reflectance.
#[derive(Clone, Debug)]
pub struct Measured {
    data: Arc<MeasuredData>,
}

const fn floats(name: &'static str, doc: &'static str) -> ParamDoc {
    ParamDoc { name, ty: "floats", default: "", doc }
}

const fn size(name: &'static str) -> ParamDoc {
    ParamDoc { name, ty: "ints", default: "", doc: "rows and columns" }
}

impl Element for Measured {
    const SUMMARY: &'static str = "A reflectance that a gonio-photometer measured (RGL's database).";
    const PARAMS: &'static [ParamDoc] = &[
        floats("phi_i", "azimuths of incidence"),
        floats("theta_i", "polar angles of incidence"),
        floats("ndf", "normals' distribution"),
        size("ndf_size"),
        floats("sigma", "projected area"),
        size("sigma_size"),
        floats("vndf", "visible normals per incidence"),
        size("vndf_size"),
        floats("luminance", "luminance per incidence"),
        size("luminance_size"),
        floats("rgb", "colours per incidence"),
        floats("spectra", "instead: spectra per incidence"),
        floats("wavelengths", "their wavelengths in nanometres"),
        ParamDoc { name: "jacobian", ty: "bool", default: "true", doc: "the factor ndf / (4 sigma) lacks" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self { data: Arc::new(MeasuredData::from_params(params)?) })
    }
}

impl MaterialOps for Measured {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(MeasuredLobe { data: Arc::clone(&self.data) }, weight, at.frame, at.frame.n);
    }
}

/// A measured reflectance, shared by all that ask.
#[derive(Clone, Debug)]
pub struct MeasuredLobe {
    data: Arc<MeasuredData>,
}

/// The place of a pair of directions in the tables.
struct Place {
    slices: Slices,
    /// The half vector.
    m: Vector3,
    /// Its place among normals.
    u_m: [f32; 2],
    /// Its place among visible normals, warped to be even.
    u: [f32; 2],
}

/// The polar angle, precisely also near the pole.
fn elevation(w: Vector3) -> f32 {
    let chord = (w.x * w.x + w.y * w.y + (w.z - 1.0) * (w.z - 1.0)).sqrt();
    2.0 * (0.5 * chord).min(1.0).asin()
}

fn u_of_theta(theta: f32) -> f32 {
    (theta * (2.0 / PI)).max(0.0).sqrt()
}

fn u_of_phi(phi: f32) -> f32 {
    (phi + PI) / (2.0 * PI)
}

impl MeasuredLobe {
    fn slices(&self, wo: Vector3) -> Slices {
        Slices::around(&self.data.phi, wo.y.atan2(wo.x), &self.data.theta, elevation(wo))
    }

    fn place(&self, wo: Vector3, wi: Vector3) -> Option<Place> {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return None;
        }
        let [wo, wi] = self.data.unmirrored(wo, wi);
        let m = (wo + wi).normalized();
        let turn = if self.data.is_isotropic() { wo.y.atan2(wo.x) } else { 0.0 };
        let phi = u_of_phi(m.y.atan2(m.x) - turn);
        let u_m = [u_of_theta(elevation(m)), phi - phi.floor()];
        let slices = self.slices(wo);
        let u = self.data.vndf.invert(&slices, u_m);
        Some(Place { slices, m, u_m, u })
    }

    /// Density of half vectors per unit of the square, as steradians of reflected directions.
    fn jacobian(u_m: [f32; 2], wo: Vector3, m: Vector3) -> f32 {
        let sin = (m.x * m.x + m.y * m.y).sqrt();
        (2.0 * PI * PI * u_m[0] * sin).max(1e-6) * 4.0 * wo.dot(m)
    }
}

impl LobeOps for MeasuredLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        let Some(place) = self.place(wo, wi) else { return Spectrum::ZERO };
        let rgb = [0, 1, 2].map(|i| self.data.rgb[i].eval(&place.slices, place.u).max(0.0));
        let mut scale = 1.0 / wi.z;
        if self.data.has_jacobian {
            let u_wo = [u_of_theta(elevation(wo)), u_of_phi(wo.y.atan2(wo.x))];
            let sigma = self.data.sigma.eval(&Slices::SINGLE, u_wo);
            scale *= self.data.ndf.eval(&Slices::SINGLE, place.u_m) / (4.0 * sigma.max(1e-8));
        }
        Spectrum::from_rgb(rgb) * scale
    }

    fn sample(&self, wo: Vector3, _: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let [above, _] = self.data.unmirrored(wo, wo);
        let slices = self.slices(above);
        let u = self.data.luminance.sample(&slices, [u.y, u.x]);
        let u_m = self.data.vndf.sample(&slices, u);
        let turn = if self.data.is_isotropic() { above.y.atan2(above.x) } else { 0.0 };
        let m =
            aureole_math::spherical_direction(u_m[0] * u_m[0] * (0.5 * PI), (2.0 * u_m[1] - 1.0) * PI + turn);
        // Mirrored twice, a direction is itself.
        let [_, wi] = self.data.mirrored(wo, reflect(above, m));
        reflected(self, wo, wi, mode)
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        let Some(place) = self.place(wo, wi) else { return 0.0 };
        let [wo, _] = self.data.unmirrored(wo, wi);
        let even = self.data.luminance.pdf(&place.slices, place.u);
        let visible = self.data.vndf.pdf(&place.slices, place.u_m);
        let pdf = visible * even / Self::jacobian(place.u_m, wo, place.m);
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let mirror = Vector3::new(-wo.x, -wo.y, wo.z);
        (self.eval(wo, mirror, TransportMode::Radiance) * wo.z).clamp(0.0, 1.0)
    }
}
