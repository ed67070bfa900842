//! `bilerp`: four values at the corners of the unit square, interpolated.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `v00`, `v01`, `v10`, `v11` | spectrum | 0, 1, 0, 1 | value at (u, v) |
//! | `to_uv` | transform | identity | applied to the surface's uv |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Arena;
use aureole_spectrum::{PreparedSpectrum, Spectrum, SpectrumRole, Wavelengths};

use super::mapping::{MAPPING, Mapping, TEXTURE_FROM_WORLD, TO_UV};
use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver};

/// A bilinear blend of four corners.
#[derive(Clone, Debug)]
pub struct Bilerp {
    /// At (0,0), (0,1), (1,0), (1,1).
    corners: [PreparedSpectrum; 4],
    mapping: Mapping,
}

impl Element for Bilerp {
    const SUMMARY: &'static str = "Four values at the corners of the unit square, interpolated.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "v00", ty: "spectrum", default: "0", doc: "value at u = 0, v = 0" },
        ParamDoc { name: "v01", ty: "spectrum", default: "1", doc: "value at u = 0, v = 1" },
        ParamDoc { name: "v10", ty: "spectrum", default: "0", doc: "value at u = 1, v = 0" },
        ParamDoc { name: "v11", ty: "spectrum", default: "1", doc: "value at u = 1, v = 1" },
        MAPPING,
        TEXTURE_FROM_WORLD,
        TO_UV,
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let mut corner = |name, default| -> Result<_, SceneError> {
            Ok(params.spectrum(name, default)?.prepare(SpectrumRole::Unbounded))
        };
        let corners = [corner("v00", 0.0)?, corner("v01", 1.0)?, corner("v10", 0.0)?, corner("v11", 1.0)?];
        Ok(Self { corners, mapping: Mapping::from_params(params)? })
    }
}

impl TextureOps for Bilerp {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        let p = self.mapping.apply(at);
        let [c00, c01, c10, c11] = self.corners.each_ref().map(|c| c.eval(&at.wavelengths));
        c00.lerp(c10, p.x).lerp(c01.lerp(c11, p.x), p.y)
    }

    fn mean(&self, _: &Arena<Texture>) -> Spectrum {
        self.corners.iter().map(|c| c.eval(&Wavelengths::RGB)).sum::<Spectrum>() * 0.25
    }
}
