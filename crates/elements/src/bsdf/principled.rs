//! `principled`: Disney's material: metals, plastics, glass and cloth by a dozen numbers.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `base_color` | texture | 0.5 | colour |
//! | `roughness` | texture | 0.5 | of the main specular lobe and of retro-reflection, in [0, 1] |
//! | `anisotropic` | texture | 0 | stretch of highlights, in [0, 1] |
//! | `metallic` | texture | 0 | from dielectric to metal, in [0, 1] |
//! | `spec_trans` | texture | 0 | from matte to glass, in [0, 1] |
//! | `eta` | float | by `specular` | index inside over outside |
//! | `specular` | float | 0.5 | reflectance at normal incidence, 0.08 times so much, in [0, 1] |
//! | `spec_tint` | texture | 0 | how far dielectric reflection takes the base's hue |
//! | `sheen`, `sheen_tint` | texture | 0 | grazing reflection of cloth, and how far it takes the base's hue |
//! | `flatness` | texture | 0 | from diffuse to an approximation of subsurface scattering |
//! | `clearcoat`, `clearcoat_gloss` | texture | 0 | a second specular layer and its gloss |
//!
//! The model is not made to conserve energy: strong sheen and clearcoat add light at grazing angles.
//!
//! References: [Burley 2012], [Burley 2015], see [`disney`](super::disney); lobes and weights as in Mitsuba 3.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3, reflect, refract, warp};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::disney::{self, Gtr1, Matte, schlick};
use super::microfacet::{Distribution, Microfacet};
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver, Texture, float_texture, spectrum_texture};

/// Disney's material.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    base_color: Id<Texture>,
    roughness: Id<Texture>,
    anisotropic: Id<Texture>,
    metallic: Id<Texture>,
    spec_trans: Id<Texture>,
    eta: f32,
    spec_tint: Id<Texture>,
    sheen: Id<Texture>,
    sheen_tint: Id<Texture>,
    flatness: Id<Texture>,
    clearcoat: Id<Texture>,
    clearcoat_gloss: Id<Texture>,
}

/// Documentation of a texture of shares that is zero unless given.
const fn share(name: &'static str, doc: &'static str) -> ParamDoc {
    ParamDoc { name, ty: "texture", default: "0", doc }
}

impl Element for Principled {
    const SUMMARY: &'static str = "Disney's material: metals, plastics, glass and cloth by a dozen numbers.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "base_color", ty: "texture", default: "0.5", doc: "colour" },
        ParamDoc { name: "roughness", ty: "texture", default: "0.5", doc: "roughness, in [0, 1]" },
        share("anisotropic", "stretch of highlights"),
        share("metallic", "from dielectric to metal"),
        share("spec_trans", "from matte to glass"),
        ParamDoc {
            name: "eta",
            ty: "float",
            default: "by `specular`",
            doc: "index of refraction, inside over outside",
        },
        ParamDoc {
            name: "specular",
            ty: "float",
            default: "0.5",
            doc: "reflectance at normal incidence / 0.08",
        },
        share("spec_tint", "how far dielectric reflection takes the base's hue"),
        share("sheen", "grazing reflection of cloth"),
        share("sheen_tint", "how far the sheen takes the base's hue"),
        share("flatness", "from diffuse to approximate subsurface scattering"),
        share("clearcoat", "a second specular layer"),
        share("clearcoat_gloss", "gloss of that layer"),
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let base_color = spectrum_texture(params, resolver, "base_color", 0.5, SpectrumRole::Albedo)?;
        let may_transmit = params.has("spec_trans");
        let eta = relative_index(params, may_transmit)?;
        let roughness = float_texture(params, resolver, "roughness", 0.5)?;
        let mut share = |name| float_texture(params, resolver, name, 0.0);
        Ok(Self {
            base_color,
            roughness,
            eta,
            anisotropic: share("anisotropic")?,
            metallic: share("metallic")?,
            spec_trans: share("spec_trans")?,
            spec_tint: share("spec_tint")?,
            sheen: share("sheen")?,
            sheen_tint: share("sheen_tint")?,
            flatness: share("flatness")?,
            clearcoat: share("clearcoat")?,
            clearcoat_gloss: share("clearcoat_gloss")?,
        })
    }
}

/// The index by `eta` or `specular`; a boundary that refracts must not have index one.
fn relative_index(params: &mut Params, may_transmit: bool) -> Result<f32, SceneError> {
    if params.has("eta") {
        if params.has("specular") {
            return Err(SceneError::invalid("give either `eta` or `specular`, not both", params.span("eta")));
        }
        let eta = params.float_in("eta", 1.5, 0.1, 100.0)?;
        return Ok(if may_transmit && eta == 1.0 { 1.001 } else { eta });
    }
    let specular = params.float_in("specular", 0.5, 0.0, 12.0)?;
    let specular = if may_transmit && specular == 0.0 { 1e-3 } else { specular };
    Ok(2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0)
}

impl MaterialOps for Principled {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let (texture, share) = (&at.texture, |id| at.texture.float(id).clamp(0.0, 1.0));
        let roughness = share(self.roughness);
        let (metallic, spec_trans) = (share(self.metallic), share(self.spec_trans));
        let lobe = PrincipledLobe {
            matte: Matte {
                color: texture.albedo(self.base_color),
                roughness,
                flatness: share(self.flatness),
                sheen: texture.float(self.sheen),
                sheen_tint: share(self.sheen_tint),
            },
            surface: disney::facets(roughness, share(self.anisotropic)),
            eta: self.eta,
            metallic,
            matte_share: (1.0 - metallic) * (1.0 - spec_trans),
            glass_share: (1.0 - metallic) * spec_trans,
            spec_tint: share(self.spec_tint),
            clearcoat: texture.float(self.clearcoat).max(0.0),
            clearcoat_gloss: share(self.clearcoat_gloss),
        };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// Disney's material at a point.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledLobe {
    matte: Matte,
    surface: Microfacet,
    eta: f32,
    metallic: f32,
    matte_share: f32,
    glass_share: f32,
    spec_tint: f32,
    clearcoat: f32,
    clearcoat_gloss: f32,
}

/// The facet that turns one direction into the other.
struct Facet {
    /// Its normal, on the upper side.
    m: Vector3,
    is_reflection: bool,
    /// Relative index along the path.
    eta_path: f32,
    /// Dielectric reflectance.
    fresnel: f32,
    /// Whether both directions see the facet from the sides where they see the surface.
    is_visible: bool,
}

/// Probabilities of drawing from each part.
struct Parts {
    matte: f32,
    clearcoat: f32,
    refraction: f32,
    reflection: f32,
}

impl PrincipledLobe {
    #[inline]
    fn facet(&self, wo: Vector3, wi: Vector3) -> Option<Facet> {
        if wo.z == 0.0 || wi.z == 0.0 {
            return None;
        }
        let is_reflection = wo.z * wi.z > 0.0;
        let eta_path = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let m = (wo + if is_reflection { wi } else { wi * eta_path }).try_normalized()?;
        let m = if m.z < 0.0 { -m } else { m };
        let fresnel = fresnel::dielectric(wo.dot(m), self.eta).reflectance;
        let is_visible = m.dot(wo) * wo.z > 0.0 && m.dot(wi) * wi.z > 0.0;
        Some(Facet { m, is_reflection, eta_path, fresnel, is_visible })
    }

    /// How likely each part is drawn; inside there are only reflection and refraction.
    #[inline]
    fn parts(&self, is_front: bool, fresnel: f32) -> Parts {
        if !is_front {
            return Parts { matte: 0.0, clearcoat: 0.0, refraction: 1.0 - fresnel, reflection: fresnel };
        }
        let clearcoat = 0.25 * self.clearcoat;
        let scale = 1.0 / (1.0 + clearcoat + self.matte_share);
        let refraction = self.glass_share * (1.0 - fresnel);
        Parts {
            matte: self.matte_share * scale,
            clearcoat: clearcoat * scale,
            refraction: refraction * scale,
            reflection: (1.0 - refraction) * scale,
        }
    }

    /// Reflectance of the main specular lobe: metal and tinted dielectric by Schlick, plain dielectric by Fresnel.
    #[inline]
    fn reflectance(&self, is_front: bool, cos: f32, dielectric: f32) -> Spectrum {
        if !is_front {
            return Spectrum::splat(self.glass_share * dielectric);
        }
        let nonmetal = 1.0 - self.metallic;
        let mut value = Spectrum::splat(nonmetal * (1.0 - self.spec_tint) * dielectric);
        if self.metallic > 0.0 {
            value += schlick(self.matte.color, cos, self.eta) * self.metallic;
        }
        if self.spec_tint > 0.0 {
            let eta_path = if cos >= 0.0 { self.eta } else { 1.0 / self.eta };
            let r0 = disney::hue(self.matte.color) * disney::normal_reflectance(eta_path);
            value += schlick(r0, cos, self.eta) * (nonmetal * self.spec_tint);
        }
        value
    }

    /// The clearcoat: index 1.5, roughness of shadowing 0.25 [Burley 2012, appendix B].
    #[inline]
    fn clearcoat(&self, wo: Vector3, wi: Vector3, m: Vector3) -> f32 {
        let f = schlick(Spectrum::splat(0.04), wo.dot(m), self.eta)[0];
        let shadowing = Microfacet::new(Distribution::Ggx, 0.25, 0.25);
        0.25 * self.clearcoat * f * Gtr1::of_gloss(self.clearcoat_gloss).d(m) * shadowing.g(wo, wi, m)
    }

    #[inline]
    fn reflected(&self, wo: Vector3, wi: Vector3, facet: &Facet) -> Spectrum {
        let (m, is_front) = (facet.m, wo.z > 0.0);
        let mut value = Spectrum::ZERO;
        if facet.is_visible {
            let facets = self.surface.d(m) * self.surface.g(wo, wi, m) / (4.0 * wo.z * wi.z);
            value = self.reflectance(is_front, wo.dot(m), facet.fresnel) * facets;
            if is_front && self.clearcoat > 0.0 {
                value += Spectrum::splat(self.clearcoat(wo, wi, m));
            }
        }
        if is_front && self.matte_share > 0.0 {
            let cos_d = m.dot(wi);
            value += self.matte.diffuse(wo.z, wi.z, cos_d) * self.matte_share;
            value += self.matte.sheen(cos_d) * (1.0 - self.metallic);
        }
        value
    }

    #[inline]
    fn refracted(&self, wo: Vector3, wi: Vector3, facet: &Facet, mode: TransportMode) -> Spectrum {
        if !facet.is_visible || self.glass_share == 0.0 {
            return Spectrum::ZERO;
        }
        let m = facet.m;
        let facets = self.surface.d(m) * self.surface.g(wo, wi, m) / (wo.z * wi.z).abs();
        let denominator = (wo.dot(m) / facet.eta_path + wi.dot(m)).powi(2);
        let squeeze = if mode == TransportMode::Radiance { facet.eta_path.powi(-2) } else { 1.0 };
        let jacobian = (wo.dot(m) * wi.dot(m)).abs() / denominator;
        // Light passes the surface twice, in and out: each time it takes half of the colour.
        self.matte.color.sqrt() * (self.glass_share * (1.0 - facet.fresnel) * facets * jacobian * squeeze)
    }

    /// `wo` seen from the upper side, as the visible normals want it.
    #[inline]
    fn above(wo: Vector3) -> Vector3 {
        if wo.z < 0.0 { -wo } else { wo }
    }
}

impl LobeOps for PrincipledLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        match self.facet(wo, wi) {
            Some(facet) if facet.is_reflection => self.reflected(wo, wi, &facet),
            Some(facet) => self.refracted(wo, wi, &facet, mode),
            None => Spectrum::ZERO,
        }
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        let is_front = wo.z > 0.0;
        if wo.z == 0.0 || (!is_front && self.glass_share == 0.0) {
            return None;
        }
        let m = self.surface.sample_visible(Self::above(wo), u);
        let parts = self.parts(is_front, fresnel::dielectric(wo.dot(m), self.eta).reflectance);
        let mut eta = 1.0;
        let wi = if uc < parts.matte {
            warp::square_to_cosine_hemisphere(u)
        } else if uc < parts.matte + parts.clearcoat {
            reflect(wo, Gtr1::of_gloss(self.clearcoat_gloss).sample(u))
        } else if uc < parts.matte + parts.clearcoat + parts.refraction {
            let refraction = refract(wo, m, self.eta)?;
            eta = refraction.eta;
            refraction.wt
        } else {
            reflect(wo, m)
        };
        if (wi.z * wo.z > 0.0) != (eta == 1.0) {
            return None;
        }
        let pdf_omega = self.pdf_omega(wo, wi);
        let flags = if eta == 1.0 { LobeFlags::REFLECTION } else { LobeFlags::TRANSMISSION };
        (pdf_omega > 0.0).then(|| LobeSample { wi, value: self.eval(wo, wi, mode), pdf_omega, flags, eta })
    }

    #[inline]
    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        let is_front = wo.z > 0.0;
        let Some(facet) = self.facet(wo, wi) else { return 0.0 };
        if !is_front && self.glass_share == 0.0 {
            return 0.0;
        }
        let m = facet.m;
        let parts = self.parts(is_front, facet.fresnel);
        let pdf_m = || self.surface.pdf_visible(Self::above(wo), m);
        if facet.is_reflection {
            let matte = parts.matte * warp::cosine_hemisphere_pdf(wi.z.abs());
            if !facet.is_visible {
                return matte;
            }
            let coat = if parts.clearcoat > 0.0 {
                parts.clearcoat * Gtr1::of_gloss(self.clearcoat_gloss).pdf(m)
            } else {
                0.0
            };
            return matte + (parts.reflection * pdf_m() + coat) / (4.0 * wo.abs_dot(m));
        }
        if !facet.is_visible {
            return 0.0;
        }
        let denominator = (wo.dot(m) / facet.eta_path + wi.dot(m)).powi(2);
        parts.refraction * pdf_m() * wi.abs_dot(m) / denominator
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let f = fresnel::dielectric(wo.z, self.eta).reflectance;
        let through = self.matte.color * (self.matte_share + self.glass_share * (1.0 - f));
        self.reflectance(wo.z > 0.0, wo.z, f) + through
    }
}
