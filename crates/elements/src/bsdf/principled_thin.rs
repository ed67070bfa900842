//! `principled_thin`: Disney's material for sheets without thickness: leaves, paper, panes.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `base_color` | texture | 0.5 | colour |
//! | `roughness` | texture | 0.5 | of specular lobes and of retro-reflection, in [0, 1] |
//! | `anisotropic` | texture | 0 | stretch of highlights, in [0, 1] |
//! | `spec_trans` | texture | 0 | from matte to glass, in [0, 1] |
//! | `eta` | texture | 1.5 | index inside over outside |
//! | `spec_tint` | texture | 0 | how far reflection takes the base's hue |
//! | `sheen`, `sheen_tint` | texture | 0 | grazing reflection of cloth, and how far it takes the base's hue |
//! | `flatness` | texture | 0 | from diffuse to an approximation of subsurface scattering |
//! | `diff_trans` | texture | 0 | matte light from reflection (0) to transmission (2) |
//!
//! References: [Burley 2015], see [`disney`](super::disney); lobes and weights as in Mitsuba 3. As there, facets through
//! which a direction would have to pass from its own side do not count, which costs a little energy and reciprocity
//! at grazing angles.

use std::f32::consts::FRAC_1_PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3, reflect, warp};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::disney::{self, Matte, schlick};
use super::microfacet::Microfacet;
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver, Texture, float_texture, spectrum_texture};

/// Disney's material for thin sheets.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThin {
    base_color: Id<Texture>,
    roughness: Id<Texture>,
    anisotropic: Id<Texture>,
    spec_trans: Id<Texture>,
    eta: Id<Texture>,
    spec_tint: Id<Texture>,
    sheen: Id<Texture>,
    sheen_tint: Id<Texture>,
    flatness: Id<Texture>,
    diff_trans: Id<Texture>,
}

impl Element for PrincipledThin {
    const SUMMARY: &'static str = "Disney's material for thin sheets: leaves, paper, panes.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "base_color", ty: "texture", default: "0.5", doc: "colour" },
        ParamDoc { name: "roughness", ty: "texture", default: "0.5", doc: "roughness, in [0, 1]" },
        ParamDoc { name: "anisotropic", ty: "texture", default: "0", doc: "stretch of highlights" },
        ParamDoc { name: "spec_trans", ty: "texture", default: "0", doc: "from matte to glass" },
        ParamDoc { name: "eta", ty: "texture", default: "1.5", doc: "index of refraction" },
        ParamDoc { name: "spec_tint", ty: "texture", default: "0", doc: "how far reflection takes the hue" },
        ParamDoc { name: "sheen", ty: "texture", default: "0", doc: "grazing reflection of cloth" },
        ParamDoc { name: "sheen_tint", ty: "texture", default: "0", doc: "how far the sheen takes the hue" },
        ParamDoc {
            name: "flatness",
            ty: "texture",
            default: "0",
            doc: "from diffuse to subsurface scattering",
        },
        ParamDoc {
            name: "diff_trans",
            ty: "texture",
            default: "0",
            doc: "matte light from reflection (0) to transmission (2)",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let base_color = spectrum_texture(params, resolver, "base_color", 0.5, SpectrumRole::Albedo)?;
        let mut float = |name, default| float_texture(params, resolver, name, default);
        Ok(Self {
            base_color,
            roughness: float("roughness", 0.5)?,
            anisotropic: float("anisotropic", 0.0)?,
            spec_trans: float("spec_trans", 0.0)?,
            eta: float("eta", 1.5)?,
            spec_tint: float("spec_tint", 0.0)?,
            sheen: float("sheen", 0.0)?,
            sheen_tint: float("sheen_tint", 0.0)?,
            flatness: float("flatness", 0.0)?,
            diff_trans: float("diff_trans", 0.0)?,
        })
    }
}

impl MaterialOps for PrincipledThin {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let (texture, share) = (&at.texture, |id| at.texture.float(id).clamp(0.0, 1.0));
        let (roughness, anisotropic) = (share(self.roughness), share(self.anisotropic));
        let eta = texture.float(self.eta).max(0.1);
        // What passes is blurred less than what is reflected [Burley 2015, figure 15].
        let blur = ((0.65 * eta - 0.35) * roughness).max(0.0);
        let lobe = PrincipledThinLobe {
            matte: Matte {
                color: texture.albedo(self.base_color),
                roughness,
                flatness: share(self.flatness),
                sheen: texture.float(self.sheen),
                sheen_tint: share(self.sheen_tint),
            },
            front: disney::facets(roughness, anisotropic),
            through: disney::facets(blur, anisotropic),
            eta,
            spec_trans: share(self.spec_trans),
            spec_tint: share(self.spec_tint),
            diff_trans: (0.5 * texture.float(self.diff_trans)).clamp(0.0, 1.0),
        };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// Disney's thin material at a point; it is the same from both sides.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThinLobe {
    matte: Matte,
    front: Microfacet,
    through: Microfacet,
    eta: f32,
    spec_trans: f32,
    spec_tint: f32,
    /// Share of matte light that passes.
    diff_trans: f32,
}

/// Probabilities of drawing from each part; they sum to one.
struct Parts {
    mirror: f32,
    window: f32,
    matte: f32,
    matte_through: f32,
}

impl PrincipledThinLobe {
    #[inline]
    fn parts(&self) -> Parts {
        let matte = 1.0 - self.spec_trans;
        Parts {
            mirror: 0.5 * self.spec_trans,
            window: 0.5 * self.spec_trans,
            matte: matte * (1.0 - self.diff_trans),
            matte_through: matte * self.diff_trans,
        }
    }

    #[inline]
    fn reflectance(&self, cos: f32) -> Spectrum {
        let plain = Spectrum::splat(fresnel::dielectric(cos, self.eta).reflectance);
        if self.spec_tint == 0.0 {
            return plain;
        }
        let r0 = disney::hue(self.matte.color) * disney::normal_reflectance(self.eta);
        plain.lerp(schlick(r0, cos, self.eta), self.spec_tint)
    }

    /// The facet that would reflect `wi`, or its mirror image below the sheet.
    #[inline]
    fn facet(wo: Vector3, wi: Vector3) -> Vector3 {
        (wo + Vector3::new(wi.x, wi.y, wi.z.abs())).normalized()
    }

    /// Both directions mirrored in the point, if need be, so that `wo` is above: anisotropy does not mind.
    #[inline]
    fn upright(wo: Vector3, wi: Vector3) -> Option<[Vector3; 2]> {
        let side = wo.z.signum();
        (wo.z != 0.0 && wi.z != 0.0).then(|| [wo * side, wi * side])
    }
}

impl LobeOps for PrincipledThinLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        let Some([wo, wi]) = Self::upright(wo, wi) else { return Spectrum::ZERO };
        let m = Self::facet(wo, wi);
        let is_visible = m.dot(wi) * wi.z > 0.0 && m.dot(wo) > 0.0;
        let facets = |surface: &Microfacet| surface.d(m) * surface.g(wo, wi, m) / (4.0 * wo.z * wi.z.abs());
        let matte = 1.0 - self.spec_trans;
        let mut value = Spectrum::ZERO;
        if wi.z > 0.0 {
            if is_visible && self.spec_trans > 0.0 {
                value += self.reflectance(wo.dot(m)) * (self.spec_trans * facets(&self.front));
            }
            let cos_d = m.dot(wi);
            let diffuse = self.matte.diffuse(wo.z, wi.z, cos_d) + self.matte.sheen(cos_d);
            return value + diffuse * (matte * (1.0 - self.diff_trans));
        }
        if is_visible && self.spec_trans > 0.0 {
            let passed = 1.0 - fresnel::dielectric(wo.dot(m), self.eta).reflectance;
            value += self.matte.color * (self.spec_trans * passed * facets(&self.through));
        }
        value + self.matte.color * (matte * self.diff_trans * FRAC_1_PI)
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z == 0.0 {
            return None;
        }
        let side = wo.z.signum();
        let (above, parts) = (wo * side, self.parts());
        let below = |v: Vector3| Vector3::new(v.x, v.y, -v.z);
        let (wi, flags) = if uc < parts.mirror {
            (reflect(above, self.front.sample_visible(above, u)), LobeFlags::REFLECTION)
        } else if uc < parts.mirror + parts.window {
            let m = self.through.sample_visible(above, u);
            let wi = below(reflect(above, m));
            if m.dot(wi) >= 0.0 {
                return None;
            }
            (wi, LobeFlags::TRANSMISSION)
        } else if uc < 1.0 - parts.matte_through {
            (warp::square_to_cosine_hemisphere(u), LobeFlags::REFLECTION)
        } else {
            (below(warp::square_to_cosine_hemisphere(u)), LobeFlags::TRANSMISSION)
        };
        if (wi.z < 0.0) != flags.transmission {
            return None;
        }
        let wi = wi * side;
        let pdf_omega = self.pdf_omega(wo, wi);
        (pdf_omega > 0.0).then(|| LobeSample {
            wi,
            value: self.eval(wo, wi, mode),
            pdf_omega,
            flags,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        let Some([wo, wi]) = Self::upright(wo, wi) else { return 0.0 };
        let (m, parts) = (Self::facet(wo, wi), self.parts());
        let reflection = |surface: &Microfacet| surface.pdf_visible(wo, m) / (4.0 * wo.abs_dot(m));
        let cosine = warp::cosine_hemisphere_pdf(wi.z.abs());
        let is_visible = m.dot(wi) * wi.z > 0.0;
        let (specular, surface, matte) = if wi.z > 0.0 {
            (parts.mirror, &self.front, parts.matte)
        } else {
            (parts.window, &self.through, parts.matte_through)
        };
        let glossy = if is_visible && specular > 0.0 { specular * reflection(surface) } else { 0.0 };
        glossy + matte * cosine
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let f = self.reflectance(wo.z.abs());
        let window = self.matte.color * (Spectrum::ONE - f) + f;
        self.matte.color * (1.0 - self.spec_trans) + window * self.spec_trans
    }
}
