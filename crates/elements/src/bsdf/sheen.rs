//! `sheen`: the soft grazing reflection of fibres on cloth, dust or fuzz, over another material.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `color` | texture | 1 | colour of the fibres |
//! | `roughness` | texture | 0.5 | how far the reflection spreads from grazing, in (0, 1] |
//! | `bsdf` | bsdf | | the material below; it gets the light that the fibres leave |
//!
//! # References
//! - [Conty Estevez and Kulla 2017] "Production Friendly Microfacet Sheen BRDF": distribution and shadowing;
//!   the material below is scaled by the albedo of the fibres, as is said there.

use std::f32::consts::PI;
use std::sync::OnceLock;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Point2, Vector3, warp};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{
    Bsdf, LobeFlags, LobeOps, LobeSample, Material, MaterialContext, MaterialOps, TransportMode,
    optional_material,
};
use crate::{Element, Resolver, Texture, float_texture, spectrum_texture};

/// Fibres over a material.
#[derive(Clone, Copy, Debug)]
pub struct Sheen {
    color: Id<Texture>,
    roughness: Id<Texture>,
    below: Option<Id<Material>>,
}

impl Element for Sheen {
    const SUMMARY: &'static str = "The soft grazing reflection of fibres, over another material.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "color", ty: "texture", default: "1", doc: "colour of the fibres" },
        ParamDoc { name: "roughness", ty: "texture", default: "0.5", doc: "spread of the reflection" },
        ParamDoc { name: "bsdf", ty: "bsdf", default: "", doc: "the material below" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let color = spectrum_texture(params, resolver, "color", 1.0, SpectrumRole::Albedo)?;
        let roughness = float_texture(params, resolver, "roughness", 0.5)?;
        Ok(Self { color, roughness, below: optional_material(params, resolver, "bsdf")? })
    }
}

impl MaterialOps for Sheen {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let color = at.texture.albedo(self.color);
        let lobe = SheenLobe::new(color, at.texture.float(self.roughness));
        out.push(lobe, weight, at.frame, at.frame.n);
        if let Some(below) = self.below {
            let taken = lobe.albedo(at.frame.to_local(at.wo)).max_element();
            at.nested(below, weight * (1.0 - taken).max(0.0), out);
        }
    }

    fn is_see_through(&self, materials: &Arena<Material>, textures: &Arena<Texture>) -> bool {
        self.below.is_some_and(|below| materials[below].is_see_through(materials, textures))
    }
}

/// Reflection by fibres.
#[derive(Clone, Copy, Debug)]
pub struct SheenLobe {
    color: Spectrum,
    roughness: f32,
}

/// Entries of the albedo table in each dimension.
const ENTRIES: usize = 16;
/// The smallest roughness that is meant.
const MIN_ROUGHNESS: f32 = 0.07;

impl SheenLobe {
    /// Fibres of a colour and roughness.
    pub(super) fn new(color: Spectrum, roughness: f32) -> Self {
        Self { color, roughness: roughness.clamp(MIN_ROUGHNESS, 1.0) }
    }

    /// The density of fibres' normals: a power of the sine.
    #[inline]
    fn d(&self, cos_m: f32) -> f32 {
        let exponent = 1.0 / self.roughness;
        let sin2 = (1.0 - cos_m * cos_m).max(0.0);
        (2.0 + exponent) * sin2.powf(0.5 * exponent) / (2.0 * PI)
    }

    /// The fit of the shadowing's Λ: between its values at roughness one and zero.
    fn lambda(&self, cos: f32) -> f32 {
        const ROUGH: [f32; 5] = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054];
        const FINE: [f32; 5] = [25.3245, 3.32435, 0.16801, -1.27393, -4.85967];
        let t = (1.0 - self.roughness).powi(2);
        let [a, b, c, d, e]: [f32; 5] = std::array::from_fn(|i| ROUGH[i] + (FINE[i] - ROUGH[i]) * t);
        let l = |x: f32| a / (1.0 + b * x.powf(c)) + d * x + e;
        let cos = cos.clamp(1e-4, 1.0);
        if cos < 0.5 { l(cos).exp() } else { (2.0 * l(0.5) - l(1.0 - cos)).exp() }
    }

    /// The value for white fibres.
    #[inline]
    fn white(&self, wo: Vector3, wi: Vector3) -> f32 {
        let m = (wo + wi).normalized();
        let shadowing = 1.0 / (1.0 + self.lambda(wo.z) + self.lambda(wi.z));
        self.d(m.z) * shadowing / (4.0 * wo.z * wi.z)
    }

    /// How much light white fibres take, by a table over the cosine's and the roughness's steps.
    fn white_albedo(&self, cos: f32) -> f32 {
        static TABLE: OnceLock<[[f32; ENTRIES]; ENTRIES]> = OnceLock::new();
        let table = TABLE.get_or_init(|| {
            std::array::from_fn(|row| {
                let roughness = MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * row as f32 / (ENTRIES - 1) as f32;
                std::array::from_fn(|i| integrated(roughness, (i as f32 / (ENTRIES - 1) as f32).powi(2)))
            })
        });
        let place = |x: f32| {
            let x = x.clamp(0.0, 1.0) * (ENTRIES - 1) as f32;
            let i = (x as usize).min(ENTRIES - 2);
            (i, x - i as f32)
        };
        let (row, s) = place((self.roughness - MIN_ROUGHNESS) / (1.0 - MIN_ROUGHNESS));
        let (i, t) = place(cos.abs().sqrt());
        let along = |row: &[f32; ENTRIES]| row[i] + (row[i + 1] - row[i]) * t;
        along(&table[row]) + (along(&table[row + 1]) - along(&table[row])) * s
    }
}

/// The albedo of white fibres by quadrature over the hemisphere, even in cosine and azimuth.
fn integrated(roughness: f32, cos: f32) -> f32 {
    const STEPS: usize = 48;
    let lobe = SheenLobe::new(Spectrum::ONE, roughness);
    let cos = cos.max(0.01);
    let wo = Vector3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let middle = |i: usize| (i as f32 + 0.5) / STEPS as f32;
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            // Half of the circle: the other half is its mirror image.
            let wi = warp::square_to_uniform_hemisphere(Point2::new(middle(i), 0.5 * middle(j)));
            sum += lobe.white(wo, wi) * wi.z;
        }
    }
    (sum / ((STEPS * STEPS) as f32 * warp::UNIFORM_HEMISPHERE_PDF)).min(1.0)
}

impl LobeOps for SheenLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 { Spectrum::ZERO } else { self.color * self.white(wo, wi) }
    }

    fn sample(&self, wo: Vector3, _: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = warp::square_to_uniform_hemisphere(u);
        (wi.z > 0.0).then(|| LobeSample {
            wi,
            value: self.eval(wo, wi, mode),
            pdf_omega: warp::UNIFORM_HEMISPHERE_PDF,
            flags: LobeFlags::REFLECTION,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z > 0.0 && wi.z > 0.0 { warp::UNIFORM_HEMISPHERE_PDF } else { 0.0 }
    }

    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.color * self.white_albedo(wo.z)
    }
}
