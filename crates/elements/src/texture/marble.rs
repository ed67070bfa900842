//! `marble`: veins in stone, from noise that bends layers along y.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `octaves` | int | 8 | layers of noise |
//! | `roughness` | float | 0.5 | how strong each layer is beside the one before |
//! | `scale` | float | 1 | factor of the position |
//! | `variation` | float | 0.2 | how far the noise bends the layers |
//! | `texture_from_world` | transform | identity | |
//!
//! As pbrt's texture of that name.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Point3, Transform};
use aureole_spectrum::Spectrum;

use super::fractal::octaves;
use super::mapping::TEXTURE_FROM_WORLD;
use super::noise::Octaves;
use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver};

/// Control points of the colours across a vein, from pbrt.
const COLORS: [[f32; 3]; 9] = [
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.5, 0.5, 0.5],
    [0.6, 0.59, 0.58],
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.2, 0.2, 0.33],
    [0.58, 0.58, 0.6],
];

/// Veined stone.
#[derive(Clone, Debug)]
pub struct Marble {
    octaves: Octaves,
    scale: f32,
    variation: f32,
    texture_from_world: Transform,
}

impl Element for Marble {
    const SUMMARY: &'static str = "Veins in stone.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "octaves", ty: "int", default: "8", doc: "layers of noise" },
        ParamDoc { name: "roughness", ty: "float", default: "0.5", doc: "of each layer in the one before" },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor of the position" },
        ParamDoc {
            name: "variation",
            ty: "float",
            default: "0.2",
            doc: "how far the noise bends the layers",
        },
        TEXTURE_FROM_WORLD,
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            octaves: octaves(params)?,
            scale: params.float("scale", 1.0)?,
            variation: params.float("variation", 0.2)?,
            texture_from_world: params.transform("texture_from_world")?,
        })
    }
}

/// The colour across a vein, `t` in [0, 1].
fn color(t: f32) -> [f32; 3] {
    let segments = COLORS.len() - 3;
    let x = t.clamp(0.0, 1.0) * segments as f32;
    let first = (x as usize).min(segments - 1);
    let x = x - first as f32;
    let y = 1.0 - x;
    let weights = [y * y * y, 3.0 * x * y * y, 3.0 * x * x * y, x * x * x];
    std::array::from_fn(|c| 1.5 * (0..4).map(|i| weights[i] * COLORS[first + i][c]).sum::<f32>())
}

impl TextureOps for Marble {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        let p = self.texture_from_world.point(at.p);
        let p = Point3::new(p.x * self.scale, p.y * self.scale, p.z * self.scale);
        let layer = p.y + self.variation * self.octaves.fbm(p);
        Spectrum::from_rgb(color(0.5 + 0.5 * layer.sin()))
    }

    fn mean(&self, _: &Arena<Texture>) -> Spectrum {
        let around = (0..64).map(|i| color(0.5 + 0.5 * (i as f32 * std::f32::consts::TAU / 64.0).sin()));
        around.map(Spectrum::from_rgb).sum::<Spectrum>() / 64.0
    }
}
