//! `independent`: uncorrelated uniform numbers, by hashing.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `sample_count` | int | 16 | samples per pixel |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, hash_u64};

use super::{SampleKey, SamplerOps, unit};
use crate::{Element, Resolver};

/// Uncorrelated uniform numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Independent {
    sample_count: u32,
}

impl Independent {
    /// A sampler for so many samples a pixel.
    pub fn new(sample_count: u32) -> Self {
        Self { sample_count }
    }
}

impl Element for Independent {
    const SUMMARY: &'static str = "Uncorrelated uniform numbers.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "sample_count", ty: "int", default: "16", doc: "samples per pixel" }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self::new(params.int_in("sample_count", 16, 1, 1 << 30)? as u32))
    }
}

#[inline]
fn bits(key: SampleKey, dimension: u32) -> u64 {
    let place = u64::from(key.pixel_hash) << 32 | u64::from(key.sample);
    hash_u64(place ^ hash_u64(u64::from(dimension) ^ 0x9E37_79B9_7F4A_7C15))
}

impl SamplerOps for Independent {
    fn sample_count(&self) -> u32 {
        self.sample_count
    }

    #[inline]
    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32 {
        unit(bits(key, dimension) as u32)
    }

    #[inline]
    fn get_2d(&self, key: SampleKey, dimension: u32) -> Point2 {
        let b = bits(key, dimension);
        Point2::new(unit(b as u32), unit((b >> 32) as u32))
    }
}
