//! `constant`: the same value everywhere.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `value` | spectrum | 1 | the value |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Arena;
use aureole_spectrum::{PreparedSpectrum, Spectrum, SpectrumRole, Wavelengths};

use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver};

/// A texture that is the same everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    value: PreparedSpectrum,
}

impl Constant {
    /// A texture of one value.
    pub fn new(value: PreparedSpectrum) -> Self {
        Self { value }
    }
}

impl Element for Constant {
    const SUMMARY: &'static str = "The same value everywhere.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "value", ty: "spectrum", default: "1", doc: "the value" }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self::new(params.spectrum("value", 1.0)?.prepare(SpectrumRole::Albedo)))
    }
}

impl TextureOps for Constant {
    #[inline]
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        self.value.eval(&at.wavelengths)
    }

    fn mean(&self, _: &Arena<Texture>) -> Spectrum {
        self.value.eval(&Wavelengths::RGB)
    }

    fn is_constant(&self) -> bool {
        true
    }
}
