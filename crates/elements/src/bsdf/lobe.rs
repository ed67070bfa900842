//! One term of a BSDF.

use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::{
    BaekPlasticLobe, ConductorLobe, DielectricLobe, DiffuseLobe, DiffuseTransmissionLobe, GlossLobe,
    HairLobe, LayeredLobe, MeasuredLobe, MerlLobe, NullLobe, PlasticLobe, PrincipledLobe, PrincipledThinLobe,
    PrismLobe, RoughConductorLobe, RoughDielectricLobe, RoughDiffuseLobe, RoughPlasticLobe, RoughPrismLobe,
    SheenLobe, SubsurfaceLobe, ThinDielectricLobe,
};

/// What travels along a path: refraction squeezes radiance, but not importance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransportMode {
    /// From the eye towards the lights.
    #[default]
    Radiance,
    /// From the lights towards the eye.
    Importance,
}

impl TransportMode {
    /// The mode of the same path walked the other way.
    #[inline]
    pub fn adjoint(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}

/// Which part of a boundary's scattering is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sides {
    Both,
    Reflection,
    Transmission,
}

impl Sides {
    /// The probability of drawing a reflection from a boundary that reflects so much; none if nothing is left to draw.
    #[inline]
    pub(super) fn reflection_probability(self, reflectance: f32) -> Option<f32> {
        match self {
            Self::Both => Some(reflectance),
            Self::Reflection => (reflectance > 0.0).then_some(1.0),
            Self::Transmission => (reflectance < 1.0).then_some(0.0),
        }
    }
}

/// What kind of scattering a sample is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LobeFlags {
    /// A Dirac distribution: no other direction could have been drawn.
    pub delta: bool,
    /// Through the surface.
    pub transmission: bool,
    /// Straight on, as if there were no surface: no scattering at all.
    pub null: bool,
}

impl LobeFlags {
    /// Non-delta reflection.
    pub const REFLECTION: Self = Self { delta: false, transmission: false, null: false };
    /// Non-delta transmission.
    pub const TRANSMISSION: Self = Self { delta: false, transmission: true, null: false };
    /// A mirror.
    pub const DELTA_REFLECTION: Self = Self { delta: true, transmission: false, null: false };
    /// A window.
    pub const DELTA_TRANSMISSION: Self = Self { delta: true, transmission: true, null: false };
    /// A surface that is not there.
    pub const NULL: Self = Self { delta: true, transmission: true, null: true };
}

/// A direction drawn from a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeSample {
    /// The direction, in the shading frame.
    pub wi: Vector3,
    /// The lobe's value, without cosine. For delta lobes the coefficient of the Dirac over |cos θi|.
    pub value: Spectrum,
    /// Density per steradian; for delta lobes the probability of this choice.
    pub pdf_omega: f32,
    /// The kind of scattering.
    pub flags: LobeFlags,
    /// Relative index of refraction along the path: 1 but for refraction.
    pub eta: f32,
}

/// What every lobe can do. Directions are unit vectors in the shading frame; both point away from the surface.
pub trait LobeOps {
    /// The value for a pair of directions, without cosine. Delta lobes give zero.
    fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum;

    /// Draws a direction.
    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample>;

    /// The density of [`sample`](Self::sample) per steradian. Delta lobes give zero.
    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32;

    /// Whether the lobe is nothing but Dirac distributions.
    fn is_delta(&self) -> bool {
        false
    }

    /// Whether values and densities are estimates by a random walk: then draws follow the density only nearly, and only a
    /// sample's own value over its own density is right on average.
    fn is_estimate(&self) -> bool {
        false
    }

    /// Whether [`sample`](Self::sample) looks at `uc`: a lobe of one part has nothing to choose.
    fn has_choice(&self) -> bool {
        true
    }

    /// An estimate of how much light is scattered, for albedo images.
    fn albedo(&self, wo: Vector3) -> Spectrum;
}

/// The sample of a lobe that drew `wi` by its own density; none if that is not above the surface.
#[inline]
pub(super) fn reflected(
    lobe: &impl LobeOps,
    wo: Vector3,
    wi: Vector3,
    mode: TransportMode,
) -> Option<LobeSample> {
    let pdf_omega = lobe.pdf_omega(wo, wi);
    (wi.z > 0.0 && pdf_omega > 0.0).then(|| LobeSample {
        wi,
        value: lobe.eval(wo, wi, mode),
        pdf_omega,
        flags: LobeFlags::REFLECTION,
        eta: 1.0,
    })
}

/// Lists the lobes: makes the enum and its static dispatch.
macro_rules! lobes {
    ($($Variant:ident($Type:ident)),* $(,)?) => {
        /// Any lobe: a plain value; measured ones share their tables.
        #[derive(Clone, Debug)]
        #[expect(missing_docs, reason = "each is documented at its type")]
        pub enum Lobe { $($Variant($Type)),* }

        $(impl From<$Type> for Lobe {
            #[inline]
            fn from(lobe: $Type) -> Self {
                Self::$Variant(lobe)
            }
        })*

        impl Lobe {
            /// The lobe's name, for people who look into a path.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$Variant(_) => stringify!($Variant)),* }
            }
        }

        impl LobeOps for Lobe {
            #[inline]
            fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
                match self { $(Self::$Variant(lobe) => lobe.eval(wo, wi, mode)),* }
            }
            #[inline]
            fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
                match self { $(Self::$Variant(lobe) => lobe.sample(wo, uc, u, mode)),* }
            }
            #[inline]
            fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
                match self { $(Self::$Variant(lobe) => lobe.pdf_omega(wo, wi)),* }
            }
            #[inline]
            fn is_delta(&self) -> bool {
                match self { $(Self::$Variant(lobe) => lobe.is_delta()),* }
            }
            #[inline]
            fn is_estimate(&self) -> bool {
                match self { $(Self::$Variant(lobe) => lobe.is_estimate()),* }
            }
            #[inline]
            fn has_choice(&self) -> bool {
                match self { $(Self::$Variant(lobe) => lobe.has_choice()),* }
            }
            fn albedo(&self, wo: Vector3) -> Spectrum {
                match self { $(Self::$Variant(lobe) => lobe.albedo(wo)),* }
            }
        }
    };
}

lobes! {
    Diffuse(DiffuseLobe),
    Conductor(ConductorLobe),
    RoughConductor(RoughConductorLobe),
    Dielectric(DielectricLobe),
    Prism(PrismLobe),
    RoughPrism(RoughPrismLobe),
    ThinDielectric(ThinDielectricLobe),
    RoughDielectric(RoughDielectricLobe),
    Plastic(PlasticLobe),
    RoughPlastic(RoughPlasticLobe),
    BaekPlastic(BaekPlasticLobe),
    DiffuseTransmission(DiffuseTransmissionLobe),
    Principled(PrincipledLobe),
    PrincipledThin(PrincipledThinLobe),
    Layered(LayeredLobe),
    Hair(HairLobe),
    Sheen(SheenLobe),
    Subsurface(SubsurfaceLobe),
    Gloss(GlossLobe),
    RoughDiffuse(RoughDiffuseLobe),
    Measured(MeasuredLobe),
    Merl(MerlLobe),
    Null(NullLobe),
}
