//! Surface materials and the BSDFs they evaluate to.
//!
//! A *material* is a recipe: it names textures and other materials. At a hit it evaluates to a [`Bsdf`], a plain value
//! on the stack made of a few weighted [`Lobe`]s, which know no textures.

mod baek_plastic;
mod bend;
mod blend;
mod bump;
mod coat;
mod coated_conductor;
mod coated_diffuse;
mod conductor;
mod dielectric;
mod diffuse;
mod diffuse_transmission;
mod directional;
mod disney;
mod emission;
pub mod fresnel;
mod gloss;
mod gloss_or_matte;
mod hair;
mod hair_lobe;
mod half_space;
mod interior;
mod layered;
mod lobe;
mod mask;
mod measured;
mod merl;
pub mod microfacet;
mod normal_map;
mod null;
mod open_pbr;
mod phase;
mod plastic;
mod principled;
mod principled_thin;
mod prism;
mod regularize;
mod rough_conductor;
mod rough_dielectric;
mod rough_diffuse;
mod rough_plastic;
mod sheen;
mod stack;
mod subsurface;
mod subsurface_lobe;
mod thin_dielectric;
mod thin_film;
mod two_sided;

use std::fmt::Debug;

use aureole_desc::{NodeId, Params, SceneError, Span};
use aureole_math::{Arena, Frame, Id, Vector3};
use aureole_spectrum::Spectrum;

use crate::{Resolver, Texture, TextureContext};

pub use baek_plastic::{BaekPlastic, BaekPlasticLobe};
pub use blend::Blend;
pub use bump::Bump;
pub use coated_conductor::CoatedConductor;
pub use coated_diffuse::CoatedDiffuse;
pub use conductor::{Conductor, ConductorLobe};
pub use dielectric::{Dielectric, DielectricLobe};
pub use diffuse::{Diffuse, DiffuseLobe};
pub use diffuse_transmission::{DiffuseTransmission, DiffuseTransmissionLobe};
pub use emission::EmissionContext;
pub use gloss::GlossLobe;
pub use hair::Hair;
pub use hair_lobe::HairLobe;
pub use interior::Interior;
pub use layered::{Base, LayeredLobe};
pub use lobe::{Lobe, LobeFlags, LobeOps, LobeSample, TransportMode};
pub use mask::Mask;
pub use measured::{Measured, MeasuredLobe};
pub use merl::{Merl, MerlLobe};
pub use normal_map::NormalMap;
pub use null::{Null, NullLobe};
pub use open_pbr::OpenPbr;
pub use plastic::{Plastic, PlasticLobe};
pub use principled::{Principled, PrincipledLobe};
pub use principled_thin::{PrincipledThin, PrincipledThinLobe};
pub use prism::{PrismLobe, RoughPrismLobe};
pub use rough_conductor::{RoughConductor, RoughConductorLobe};
pub use rough_dielectric::{RoughDielectric, RoughDielectricLobe};
pub use rough_diffuse::{RoughDiffuse, RoughDiffuseLobe};
pub use rough_plastic::{RoughPlastic, RoughPlasticLobe};
pub use sheen::{Sheen, SheenLobe};
pub use stack::{Bsdf, BsdfSample};
pub use subsurface::Subsurface;
pub use subsurface_lobe::SubsurfaceLobe;
pub use thin_dielectric::{ThinDielectric, ThinDielectricLobe};
pub use thin_film::Film;
pub use two_sided::TwoSided;

/// Where a material is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct MaterialContext<'a> {
    /// What textures need to know.
    pub texture: TextureContext<'a>,
    /// All materials of the scene.
    pub materials: &'a Arena<Material>,
    /// Shading frame in the world; materials that bend normals hand a bent one to those below them.
    pub frame: Frame,
    /// Unit geometric normal in the world.
    pub ng: Vector3,
    /// Derivative of position by u.
    pub dp_du: Vector3,
    /// Derivative of position by v.
    pub dp_dv: Vector3,
    /// Derivatives of the shading normal by u and v, for [`Bump::follows_normals`].
    pub dn_duv: [Vector3; 2],
    /// Whether the shading normal is interpolated between those of vertices.
    pub has_vertex_normals: bool,
    /// Unit direction to the viewer, in the world.
    pub wo: Vector3,
}

impl MaterialContext<'_> {
    /// Evaluates a nested material with a share of the whole.
    pub fn nested(&self, material: Id<Material>, weight: f32, out: &mut Bsdf) {
        self.materials[material].evaluate(self, weight, out);
    }
}

/// What every material can do.
pub trait MaterialOps: Debug + Send + Sync {
    /// Adds the lobes seen at a hit, their weights multiplied by `weight`.
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf);

    /// Whether shapes of this material are lights.
    fn shines(&self, _materials: &Arena<Material>) -> bool {
        false
    }

    /// Whether light may pass straight on, as if there were no surface: see [`Bsdf::null_transmittance`].
    fn is_see_through(&self, _materials: &Arena<Material>, _textures: &Arena<Texture>) -> bool {
        false
    }

    /// Radiance that it sends out by itself.
    fn emitted(&self, _at: &EmissionContext<'_>) -> Spectrum {
        Spectrum::ZERO
    }
}

registry! {
    ($)
    /// Any built-in material.
    Material: MaterialOps, match with each_material;
    diffuse::Diffuse as Diffuse = "diffuse",
    conductor::Conductor as Conductor = "conductor",
    rough_conductor::RoughConductor as RoughConductor = "rough_conductor",
    dielectric::Dielectric as Dielectric = "dielectric",
    thin_dielectric::ThinDielectric as ThinDielectric = "thin_dielectric",
    rough_dielectric::RoughDielectric as RoughDielectric = "rough_dielectric",
    plastic::Plastic as Plastic = "plastic",
    rough_plastic::RoughPlastic as RoughPlastic = "rough_plastic",
    baek_plastic::BaekPlastic as BaekPlastic = "baek_plastic",
    diffuse_transmission::DiffuseTransmission as DiffuseTransmission = "diffuse_transmission",
    coated_diffuse::CoatedDiffuse as CoatedDiffuse = "coated_diffuse",
    coated_conductor::CoatedConductor as CoatedConductor = "coated_conductor",
    principled::Principled as Principled = "principled",
    principled_thin::PrincipledThin as PrincipledThin = "principled_thin",
    open_pbr::OpenPbr as OpenPbr = "open_pbr",
    subsurface::Subsurface as Subsurface = "subsurface",
    rough_diffuse::RoughDiffuse as RoughDiffuse = "rough_diffuse",
    measured::Measured as Measured = "measured",
    merl::Merl as Merl = "merl",
    hair::Hair as Hair = "hair",
    sheen::Sheen as Sheen = "sheen",
    two_sided::TwoSided as TwoSided = "two_sided",
    mask::Mask as Mask = "mask",
    blend::Blend as Blend = "blend",
    null::Null as Null = "null",
    bump::Bump as Bump = "bump",
    normal_map::NormalMap as NormalMap = "normal_map",
}

impl Material {
    /// Adds the lobes seen at a hit, their weights multiplied by `weight`.
    #[inline]
    pub fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        each_material!(self, m => m.evaluate(at, weight, out));
    }

    /// Whether shapes of this material are lights.
    pub fn shines(&self, materials: &Arena<Material>) -> bool {
        each_material!(self, m => m.shines(materials))
    }

    /// Whether light may pass straight on, as if there were no surface.
    pub fn is_see_through(&self, materials: &Arena<Material>, textures: &Arena<Texture>) -> bool {
        each_material!(self, m => m.is_see_through(materials, textures))
    }

    /// Radiance that it sends out by itself.
    pub fn emitted(&self, at: &EmissionContext<'_>) -> Spectrum {
        each_material!(self, m => m.emitted(at))
    }
}

/// A nested material that must be given.
pub(crate) fn nested_material(
    params: &mut Params,
    resolver: &mut dyn Resolver,
    name: &str,
    element: &str,
) -> Result<Id<Material>, SceneError> {
    match params.try_node(name)? {
        Some(node) => resolver.material(node),
        None => Err(missing(name, element)),
    }
}

/// A nested material that may be left out.
pub(crate) fn optional_material(
    params: &mut Params,
    resolver: &mut dyn Resolver,
    name: &str,
) -> Result<Option<Id<Material>>, SceneError> {
    let node: Option<NodeId> = params.try_node(name)?;
    node.map(|node| resolver.material(node)).transpose()
}

/// Whether an opacity leaves holes anywhere.
pub(crate) fn has_holes(opacity: Id<Texture>, textures: &Arena<Texture>) -> bool {
    !textures[opacity].is_constant() || textures[opacity].mean(textures)[0] < 1.0
}

fn missing(name: &str, element: &str) -> SceneError {
    SceneError::MissingParam {
        element: element.into(),
        param: name.into(),
        wanted: "a material".into(),
        at: Span::NONE,
    }
}
