//! `stratified`: one random point in each cell of a grid, the cells in a different random order for each dimension.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `sample_count` | int | 16 | samples per pixel; square numbers are best |
//!
//! References: the permutation of cells is [Kensler 2013] "Correlated Multi-Jittered Sampling", Pixar memo 13-01.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, hash_u64};

use super::{SampleKey, SamplerOps, unit};
use crate::{Element, Resolver};

/// Jittered points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stratified {
    sample_count: u32,
    columns: u32,
    rows: u32,
}

impl Stratified {
    /// A sampler for so many samples a pixel; further ones start a new grid.
    pub fn new(sample_count: u32) -> Self {
        let columns = (f64::from(sample_count).sqrt() as u32).max(1);
        Self { sample_count, columns, rows: sample_count.div_ceil(columns).max(1) }
    }
}

impl Element for Stratified {
    const SUMMARY: &'static str = "One random point in each cell of a grid.";
    const PARAMS: &'static [ParamDoc] = &[ParamDoc {
        name: "sample_count",
        ty: "int",
        default: "16",
        doc: "samples per pixel; square numbers are best",
    }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self::new(params.int_in("sample_count", 16, 1, 1 << 24)? as u32))
    }
}

/// The place of `i` in a random permutation of `0..length`, without a table.
fn permute(mut i: u32, length: u32, seed: u32) -> u32 {
    let mut w = length - 1;
    for shift in [1, 2, 4, 8, 16] {
        w |= w >> shift;
    }
    loop {
        i ^= seed;
        i = i.wrapping_mul(0xE170_893D);
        i ^= seed >> 16;
        i ^= (i & w) >> 4;
        i ^= seed >> 8;
        i = i.wrapping_mul(0x0929_EB3F);
        i ^= seed >> 23;
        i ^= (i & w) >> 1;
        i = i.wrapping_mul(1 | seed >> 27);
        i = i.wrapping_mul(0x6935_FA69);
        i ^= (i & w) >> 11;
        i = i.wrapping_mul(0x74DC_B303);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0x9E50_1CC3);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0xC860_A3DF);
        i &= w;
        i ^= i >> 5;
        if i < length {
            return (i.wrapping_add(seed)) % length;
        }
    }
}

impl Stratified {
    /// The cell of a sample among `count`, and bits to jitter it with.
    fn cell(&self, key: SampleKey, dimension: u32, count: u32) -> (u32, u64) {
        let round = u64::from(key.sample / count);
        let seed = hash_u64(u64::from(key.pixel_hash) << 32 | u64::from(dimension))
            ^ hash_u64(round.wrapping_add(1));
        (permute(key.sample % count, count, seed as u32), hash_u64(seed ^ u64::from(key.sample) << 32))
    }
}

impl SamplerOps for Stratified {
    fn sample_count(&self) -> u32 {
        self.sample_count
    }

    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32 {
        let (cell, bits) = self.cell(key, dimension, self.sample_count);
        ((cell as f32 + unit(bits as u32)) / self.sample_count as f32).min(1.0 - f32::EPSILON / 2.0)
    }

    fn get_2d(&self, key: SampleKey, dimension: u32) -> Point2 {
        let (cell, bits) = self.cell(key, dimension, self.columns * self.rows);
        let place = |i: u32, jitter: u32, n: u32| {
            ((i as f32 + unit(jitter)) / n as f32).min(1.0 - f32::EPSILON / 2.0)
        };
        Point2::new(
            place(cell % self.columns, bits as u32, self.columns),
            place(cell / self.columns, (bits >> 32) as u32, self.rows),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_drawn_once() {
        let sampler = Stratified::new(64);
        let mut seen = [false; 64];
        for i in 0..64 {
            let p = sampler.get_2d(SampleKey::new(0, 1, 1, i), 3);
            let cell = (p.y * 8.0) as usize * 8 + (p.x * 8.0) as usize;
            assert!(!std::mem::replace(&mut seen[cell], true));
        }
    }
}
