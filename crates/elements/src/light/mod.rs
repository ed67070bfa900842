//! Lights.

mod area;
mod constant;
mod directional;
mod envmap;
mod goniometric;
mod point;
mod portal;
mod projector;
mod spot;
mod sunsky;

use std::fmt::Debug;

use aureole_math::{Arena, Bounds3, Id, Point2, Point3, Transform, Vector3};
use aureole_spectrum::{Spectrum, Wavelengths};

use crate::{Material, Shape, SurfacePoint, Texture};

pub use area::Area;
pub use constant::ConstantEnvironment;
pub use directional::Directional;
pub use envmap::EnvironmentMap;
pub use goniometric::Goniometric;
pub use point::PointLight;
pub use portal::PortalEnvironment;
pub use projector::Projector;
pub use spot::Spot;
pub use sunsky::SunSky;

/// What lights may ask for.
#[derive(Clone, Copy, Debug)]
pub struct LightContext<'a> {
    /// All textures of the scene.
    pub textures: &'a Arena<Texture>,
    /// All shapes of the scene.
    pub shapes: &'a Arena<Shape>,
    /// All materials of the scene: some shine.
    pub materials: &'a Arena<Material>,
    /// What the lanes of radiance mean.
    pub wavelengths: Wavelengths,
}

/// A direction towards a light, drawn from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction to the light.
    pub wi: Vector3,
    /// The point on the light, moved off its surface; `None` when the light is infinitely far.
    pub target: Option<Point3>,
    /// Radiance that arrives along `wi` if nothing is in between. Delta lights: with the Dirac divided out.
    pub radiance: Spectrum,
    /// Density per steradian; 1 for delta lights.
    pub pdf_omega: f32,
    /// Whether no other direction could have been drawn, so that no BSDF sample could hit the light.
    pub is_delta: bool,
}

/// What every light can do.
pub trait LightOps: Debug + Send + Sync {
    /// Draws a direction from `reference` towards the light.
    fn sample(&self, at: &LightContext<'_>, reference: Point3, u: Point2) -> Option<LightSample>;

    /// The density of [`sample`](Self::sample) per steradian for a direction that left `reference`, met the light's
    /// surface there, or escaped to the environment (`None`).
    fn pdf_omega(
        &self,
        _at: &LightContext<'_>,
        _reference: Point3,
        _wi: Vector3,
        _surface: Option<&SurfacePoint>,
    ) -> f32 {
        0.0
    }

    /// Radiance that leaves a point of the light's surface towards `w`.
    fn emitted(&self, _at: &LightContext<'_>, _surface: &SurfacePoint, _w: Vector3) -> Spectrum {
        Spectrum::ZERO
    }

    /// Radiance that arrives at `reference` from far away along `w` (pointing away from the viewer).
    fn environment(&self, _at: &LightContext<'_>, _reference: Point3, _w: Vector3) -> Spectrum {
        Spectrum::ZERO
    }

    /// Whether rays that leave the scene see this light.
    fn is_environment(&self) -> bool {
        false
    }

    /// An estimate of the emitted power, for choosing among lights.
    fn power(&self, at: &LightContext<'_>, scene: &Bounds3) -> f32;
}

registry! {
    ($)
    /// Any built-in light.
    Light: LightOps, match with each_light;
    area::Area as Area = "area",
    point::PointLight as Point = "point",
    spot::Spot as Spot = "spot",
    directional::Directional as Directional = "directional",
    constant::ConstantEnvironment as Constant = "constant",
    envmap::EnvironmentMap as EnvironmentMap = "envmap",
    projector::Projector as Projector = "projector",
    sunsky::SunSky as SunSky = "sunsky",
    goniometric::Goniometric as Goniometric = "goniometric",
    portal::PortalEnvironment as PortalEnvironment = "portal_envmap",
}

impl Light {
    /// Draws a direction from `reference` towards the light.
    #[inline]
    pub fn sample(&self, at: &LightContext<'_>, reference: Point3, u: Point2) -> Option<LightSample> {
        each_light!(self, l => l.sample(at, reference, u))
    }

    /// The density of [`sample`](Self::sample).
    #[inline]
    pub fn pdf_omega(
        &self,
        at: &LightContext<'_>,
        reference: Point3,
        wi: Vector3,
        surface: Option<&SurfacePoint>,
    ) -> f32 {
        each_light!(self, l => l.pdf_omega(at, reference, wi, surface))
    }

    /// Radiance that leaves a point of the light's surface towards `w`.
    #[inline]
    pub fn emitted(&self, at: &LightContext<'_>, surface: &SurfacePoint, w: Vector3) -> Spectrum {
        each_light!(self, l => l.emitted(at, surface, w))
    }

    /// Radiance that arrives at `reference` from far away along `w`.
    #[inline]
    pub fn environment(&self, at: &LightContext<'_>, reference: Point3, w: Vector3) -> Spectrum {
        each_light!(self, l => l.environment(at, reference, w))
    }

    /// The light of a shape in a group, in an instance of it. Only area lights have such a place.
    pub fn placed(&self, world_from_group: &Transform) -> Self {
        match self {
            Self::Area(area) => area.placed(*world_from_group).into(),
            other => other.clone(),
        }
    }

    /// Tells an area light of the `alpha` of its shape, and whether that is zero everywhere.
    pub fn cut_out(&mut self, alpha: Id<Texture>, is_zero: bool) {
        if let Self::Area(area) = self {
            area.cut_out(alpha, is_zero);
        }
    }

    /// Whether rays that leave the scene see this light.
    pub fn is_environment(&self) -> bool {
        each_light!(self, l => l.is_environment())
    }

    /// An estimate of the emitted power.
    pub fn power(&self, at: &LightContext<'_>, scene: &Bounds3) -> f32 {
        each_light!(self, l => l.power(at, scene))
    }
}
