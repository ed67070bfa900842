//! `sunsky`: a clear sky with its sun, over a place at a time.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `turbidity` | float | 3 | haze, 1 (arctic) to 10 (a hazy day) |
//! | `albedo` | spectrum | 0.3 | of the ground, which lights the sky from below |
//! | `sun_direction` | vector | | to the sun, in the world; instead of place and time |
//! | `latitude`, `longitude` | float | 35.6894, 139.6917 | of the place, degrees north and east |
//! | `timezone` | float | 9 | hours before universal time |
//! | `year`, `month`, `day` | int | 2010, 7, 10 | date |
//! | `hour`, `minute`, `second` | float | 15, 0, 0 | local time |
//! | `sun_scale` | float | 1 | factor of the sun; 0 is without |
//! | `sky_scale` | float | 1 | factor of the sky |
//! | `sun_aperture` | float | 0.5358 | angle across the sun's disk, degrees; its irradiance stays the same |
//! | `limb_darkening` | bool | false | let the sun's disk darken towards its edge; its irradiance stays the same |
//! | `world_from_light` | transform | identity | up is +Z of the light's space, south is +X |
//!
//! Below the horizon it is black. Unless it is asked for, the darkening of the sun's limb is averaged. Very low suns are redder
//! than Rec. 709 can say, and their blue is negative.
//!
//! The model is that of [Hošek and Wilkie 2012, 2013]; directions are drawn from a table of the sky's luminance and from the
//! sun's cone, in proportion to their irradiance.

mod model;
mod position;

use std::f32::consts::{PI, TAU};

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Frame, PiecewiseConstant2D, Point2, Point3, Transform, Vector3, warp};
use aureole_spectrum::{Spectrum, SpectrumRole, luminance};

use self::model::{SUN_HALF_ANGLE, Sky, limb_darkening, sun_radiance};
use self::position::PlaceAndTime;
use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver, SurfacePoint};

/// A clear sky with its sun.
#[derive(Clone, Debug)]
pub struct SunSky {
    sky: Sky,
    sky_scale: f32,
    /// Radiance of the disk, scaled.
    sun: [f32; 3],
    /// To the sun, in the light's space.
    sun_frame: Frame,
    one_minus_cos_sun: f32,
    has_dark_limb: bool,
    world_from_light: Transform,
    light_from_world: Transform,
    /// Over azimuth and the cosine with the zenith; `None` without a sky.
    distribution: Option<PiecewiseConstant2D>,
    /// How often the sky is drawn rather than the sun.
    sky_share: f32,
    /// Irradiance of everything on a ball's cross-section: the integral of luminance over all directions.
    total: f32,
}

/// Cells of the sampling table, around and up.
const CELLS: [usize; 2] = [128, 64];

const OWN_PARAMS: [ParamDoc; 8] = [
    ParamDoc { name: "turbidity", ty: "float", default: "3", doc: "haze, 1 to 10" },
    ParamDoc { name: "albedo", ty: "spectrum", default: "0.3", doc: "of the ground" },
    ParamDoc {
        name: "sun_direction",
        ty: "vector",
        default: "",
        doc: "to the sun, instead of place and time",
    },
    ParamDoc { name: "sun_scale", ty: "float", default: "1", doc: "factor of the sun" },
    ParamDoc { name: "sky_scale", ty: "float", default: "1", doc: "factor of the sky" },
    ParamDoc { name: "sun_aperture", ty: "float", default: "0.5358", doc: "angle across the sun, degrees" },
    ParamDoc {
        name: "limb_darkening",
        ty: "bool",
        default: "false",
        doc: "let the sun's disk darken towards its edge",
    },
    ParamDoc { name: "world_from_light", ty: "transform", default: "identity", doc: "+Z is up" },
];

const ALL_PARAMS: [ParamDoc; 17] = {
    let mut all = [OWN_PARAMS[0]; 17];
    let mut i = 0;
    while i < all.len() {
        all[i] = if i < OWN_PARAMS.len() { OWN_PARAMS[i] } else { position::PARAMS[i - OWN_PARAMS.len()] };
        i += 1;
    }
    all
};

impl Element for SunSky {
    const SUMMARY: &'static str = "A clear sky with its sun, over a place at a time.";
    const PARAMS: &'static [ParamDoc] = &ALL_PARAMS;

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let world_from_light = params.transform("world_from_light")?;
        let light_from_world = world_from_light.inverse();
        let at = params.span("sun_direction");
        let sun = match params.try_vec3("sun_direction")? {
            Some(direction) => light_from_world
                .vector(Vector3::from(direction))
                .try_normalized()
                .ok_or_else(|| SceneError::invalid("`sun_direction` must not be zero", at))?,
            None => PlaceAndTime::from_params(params)?.sun(),
        };
        if sun.z < 0.0 {
            resolver.report().warn("the sun is below the horizon: the sky is black", Span::NONE);
        }
        let turbidity = params.float_in("turbidity", 3.0, 1.0, 10.0)?;
        let albedo = params.spectrum("albedo", 0.3)?.to_rgb(SpectrumRole::Albedo);
        let half_angle = 0.5 * params.float_in("sun_aperture", 0.5358, 1e-3, 179.0)?.to_radians();
        // A larger disk is dimmer, so that its irradiance stays.
        let spread = one_minus_cos(SUN_HALF_ANGLE) / one_minus_cos(half_angle);
        let sun_scale = params.float_in("sun_scale", 1.0, 0.0, f32::INFINITY)? * spread;
        let elevation = sun.z.clamp(-1.0, 1.0).asin();
        let is_day = sun.z >= 0.0;
        let mut this = Self {
            sky: Sky::new(turbidity, albedo, elevation),
            sky_scale: if is_day { params.float_in("sky_scale", 1.0, 0.0, f32::INFINITY)? } else { 0.0 },
            sun: if is_day { sun_radiance(turbidity, elevation).map(|c| c * sun_scale) } else { [0.0; 3] },
            sun_frame: Frame::from_normal(sun),
            one_minus_cos_sun: one_minus_cos(half_angle),
            has_dark_limb: params.bool("limb_darkening", false)?,
            world_from_light,
            light_from_world,
            distribution: None,
            sky_share: 0.0,
            total: 0.0,
        };
        this.prepare();
        Ok(this)
    }
}

/// 1 - cos x without cancellation.
fn one_minus_cos(x: f32) -> f32 {
    2.0 * (0.5 * x).sin().powi(2)
}

impl SunSky {
    /// Tabulates the sky's luminance and weighs it against the sun's.
    fn prepare(&mut self) {
        let [across, up] = CELLS;
        let weights: Vec<f32> = (0..across * up)
            .map(|i| {
                let place = Point2::new(
                    ((i % across) as f32 + 0.5) / across as f32,
                    ((i / across) as f32 + 0.5) / up as f32,
                );
                luminance(self.sky_radiance(direction(place))).max(0.0)
            })
            .collect();
        let sky = TAU * weights.iter().sum::<f32>() / weights.len() as f32;
        let sun = TAU * self.one_minus_cos_sun * luminance(self.sun).max(0.0);
        // A share for each keeps what the other's table misses from being noisy.
        self.sky_share = match (sky > 0.0, sun > 0.0) {
            (true, true) => (sky / (sky + sun)).clamp(0.1, 0.9),
            (true, false) => 1.0,
            _ => 0.0,
        };
        let mean = sky / TAU;
        self.distribution =
            PiecewiseConstant2D::new(&weights.iter().map(|w| w + 0.02 * mean).collect::<Vec<_>>(), across);
        self.total = sky + sun;
    }

    fn sky_radiance(&self, w: Vector3) -> [f32; 3] {
        if self.sky_scale == 0.0 || w.z < 0.0 {
            return [0.0; 3];
        }
        self.sky.radiance(w.z, w.dot(self.sun_frame.n)).map(|c| c * self.sky_scale)
    }

    /// One minus the cosine with the direction to the sun's middle: half the squared chord, without cancellation.
    fn one_minus_cos_to_sun(&self, w: Vector3) -> f32 {
        0.5 * (w - self.sun_frame.n).length_squared()
    }

    fn is_in_sun(&self, w: Vector3) -> bool {
        self.one_minus_cos_to_sun(w) <= self.one_minus_cos_sun
    }

    /// The sun's radiance in a direction within its disk.
    fn sun_radiance(&self, w: Vector3) -> [f32; 3] {
        if !self.has_dark_limb {
            return self.sun;
        }
        // sin² x = (1 - cos x) (1 + cos x)
        let sin2 = |one_minus_cos: f32| one_minus_cos * (2.0 - one_minus_cos);
        let darkness = limb_darkening(
            (1.0 - sin2(self.one_minus_cos_to_sun(w)) / sin2(self.one_minus_cos_sun)).max(0.0),
        );
        std::array::from_fn(|c| self.sun[c] * darkness[c])
    }

    fn radiance(&self, w: Vector3) -> Spectrum {
        if w.z < 0.0 {
            return Spectrum::ZERO;
        }
        let sky = self.sky_radiance(w);
        let sun = if self.is_in_sun(w) { self.sun_radiance(w) } else { [0.0; 3] };
        Spectrum::from_rgb(std::array::from_fn(|c| sky[c] + sun[c]))
    }

    /// Density of drawing a unit direction of the light's space.
    fn density(&self, w: Vector3) -> f32 {
        if w.z < 0.0 {
            return 0.0;
        }
        let sky = self.distribution.as_ref().map_or(0.0, |d| d.pdf(place(w)) / TAU);
        let sun = if self.is_in_sun(w) { warp::uniform_cone_pdf(self.one_minus_cos_sun) } else { 0.0 };
        self.sky_share * sky + (1.0 - self.sky_share) * sun
    }

    fn local(&self, w: Vector3) -> Vector3 {
        self.light_from_world.vector(w).normalized()
    }
}

/// A direction of the upper hemisphere from azimuth and height, both over [0, 1]; equal areas are equal solid angles.
fn direction(place: Point2) -> Vector3 {
    let (sin_phi, cos_phi) = (place.x * TAU).sin_cos();
    let sin_theta = (1.0 - place.y * place.y).max(0.0).sqrt();
    Vector3::new(sin_theta * cos_phi, sin_theta * sin_phi, place.y)
}

fn place(w: Vector3) -> Point2 {
    Point2::new(warp::azimuth(w.y, w.x) / TAU, w.z)
}

impl LightOps for SunSky {
    fn sample(&self, _: &LightContext<'_>, _: Point3, u: Point2) -> Option<LightSample> {
        let w = if u.x < self.sky_share {
            let u = Point2::new(u.x / self.sky_share, u.y);
            direction(self.distribution.as_ref()?.sample(u)?.p)
        } else {
            let u = Point2::new(((u.x - self.sky_share) / (1.0 - self.sky_share)).min(0.999_999_94), u.y);
            self.sun_frame.to_world(warp::square_to_uniform_cone(u, self.one_minus_cos_sun))
        };
        let pdf_omega = self.density(w);
        let radiance = self.radiance(w);
        let wi = self.world_from_light.vector(w).try_normalized()?;
        let is_usable = pdf_omega > 0.0 && pdf_omega.is_finite() && !radiance.is_black();
        is_usable.then_some(LightSample { wi, target: None, radiance, pdf_omega, is_delta: false })
    }

    fn pdf_omega(&self, _: &LightContext<'_>, _: Point3, wi: Vector3, _: Option<&SurfacePoint>) -> f32 {
        self.density(self.local(wi))
    }

    fn environment(&self, _: &LightContext<'_>, _: Point3, w: Vector3) -> Spectrum {
        self.radiance(self.local(w))
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn power(&self, _: &LightContext<'_>, scene: &Bounds3) -> f32 {
        let radius = scene.radius();
        self.total * PI * radius * radius
    }
}
