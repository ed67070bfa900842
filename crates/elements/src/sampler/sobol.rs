//! `sobol`: Owen-scrambled Sobol points, padded: each pair of dimensions is a (0, 2)-sequence of its own, shuffled.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `sample_count` | int | 16 | samples per pixel; powers of two are best |
//!
//! References: [Burley 2020] "Practical Hash-based Owen Scrambling", JCGT 9(4); [Owen 1995]; direction numbers of the
//! second dimension: [Sobol 1967]. The hash that permutes as Owen's tree does: [Laine and Karras 2011], with the
//! constants of [Vegdahl 2021] "Building a Better LK Hash".

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, hash_u32, hash_u64};

use super::{SampleKey, SamplerOps, unit};
use crate::{Element, Resolver};

/// Owen-scrambled Sobol points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sobol {
    sample_count: u32,
}

impl Sobol {
    /// A sampler for so many samples a pixel.
    pub fn new(sample_count: u32) -> Self {
        Self { sample_count }
    }
}

impl Element for Sobol {
    const SUMMARY: &'static str = "Owen-scrambled Sobol points: the least noise.";
    const PARAMS: &'static [ParamDoc] = &[ParamDoc {
        name: "sample_count",
        ty: "int",
        default: "16",
        doc: "samples per pixel; powers of two are best",
    }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self::new(params.int_in("sample_count", 16, 1, 1 << 30)? as u32))
    }
}

/// Permutes the tree of binary digits from the least significant one upwards.
#[inline]
fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^ x.wrapping_mul(0x53A2_2864)
}

/// Owen's nested uniform scramble of a number given by its digits from the most significant one.
#[inline]
fn owen_scramble(x: u32, seed: u32) -> u32 {
    laine_karras(x.reverse_bits(), seed).reverse_bits()
}

/// The second Sobol dimension, its digits from the least significant bit up: the index times Pascal's triangle modulo two.
///
/// A binomial coefficient (j over k) is odd when k's bits are a subset of j's, so five masked shifts do.
#[inline]
fn sobol_second(mut index: u32) -> u32 {
    index ^= (index & 0xAAAA_AAAA) >> 1;
    index ^= (index & 0xCCCC_CCCC) >> 2;
    index ^= (index & 0xF0F0_F0F0) >> 4;
    index ^= (index & 0xFF00_FF00) >> 8;
    index ^ ((index & 0xFFFF_0000) >> 16)
}

/// A dimension of a pixel: the sample's place in the shuffled sequence, and a seed for scrambling its digits.
#[inline]
fn place(key: SampleKey, dimension: u32) -> (u32, u32) {
    let hash = hash_u64(u64::from(key.pixel_hash) << 32 | u64::from(dimension));
    (owen_scramble(key.sample, hash as u32), (hash >> 32) as u32)
}

impl SamplerOps for Sobol {
    fn sample_count(&self) -> u32 {
        self.sample_count
    }

    #[inline]
    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32 {
        let (index, seed) = place(key, dimension);
        // The first Sobol dimension is the index with its digits reversed, and `laine_karras` wants them reversed again.
        unit(laine_karras(index, seed).reverse_bits())
    }

    #[inline]
    fn get_2d(&self, key: SampleKey, dimension: u32) -> Point2 {
        let (index, seed) = place(key, dimension);
        let x = laine_karras(index, seed).reverse_bits();
        let y = laine_karras(sobol_second(index), hash_u32(seed)).reverse_bits();
        Point2::new(unit(x), unit(y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(n: u32, dimension: u32) -> Vec<Point2> {
        (0..n).map(|i| Sobol::new(n).get_2d(SampleKey::new(7, 3, 5, i), dimension)).collect()
    }

    /// The first 2^k points put exactly one point into each elementary interval of area 2^-k.
    #[test]
    fn points_are_a_net() {
        for dimension in [0, 1, 2, 9] {
            for k in [4_u32, 6, 8] {
                let points = points(1 << k, dimension);
                for a in 0..=k {
                    let (nx, ny) = (1_u32 << a, 1_u32 << (k - a));
                    let mut seen = vec![false; 1 << k];
                    for p in &points {
                        let cell = (p.y * ny as f32) as u32 * nx + (p.x * nx as f32) as u32;
                        assert!(!std::mem::replace(&mut seen[cell as usize], true), "k {k}, {nx} x {ny}");
                    }
                }
            }
        }
    }

    /// One-dimensional draws are stratified, and different dimensions are not correlated.
    #[test]
    fn dimensions_are_stratified_and_independent() {
        let n = 1024;
        let sampler = Sobol::new(n);
        let draw = |d| (0..n).map(move |i| sampler.get_1d(SampleKey::new(1, 2, 3, i), d)).collect::<Vec<_>>();
        let (a, b) = (draw(4), draw(5));
        let mut seen = vec![false; n as usize];
        for x in &a {
            assert!(!std::mem::replace(&mut seen[(x * n as f32) as usize], true));
        }
        let covariance: f32 = a.iter().zip(&b).map(|(x, y)| (x - 0.5) * (y - 0.5)).sum::<f32>() / n as f32;
        assert!(covariance.abs() < 5.0 / 12.0 / (n as f32).sqrt(), "{covariance}");
    }
}
