//! Hashes that mix well, and a small generator for tests and tables.

use crate::Point2;

/// A bijective mix of 32 bits with low bias ["Hash Function Prospector", C. Wellons 2018].
#[inline]
pub const fn hash_u32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// A bijective mix of 64 bits: the finaliser of SplitMix64 [Steele et al. 2014], in Stafford's variant 13.
#[inline]
pub const fn hash_u64(mut x: u64) -> u64 {
    x ^= x >> 30;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 27;
    x = x.wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// PCG-XSH-RR 64/32 [O'Neill 2014]: a sequential generator for tests and precomputed tables, never for rendering.
#[derive(Clone, Debug)]
pub struct Pcg32 {
    state: u64,
}

impl Pcg32 {
    /// A generator from a seed.
    pub fn new(seed: u64) -> Self {
        let mut rng = Self { state: hash_u64(seed).wrapping_add(0xDA3E_39CB_94B9_5BDB) };
        rng.next_u32();
        rng
    }

    /// 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// A number in [0, 1).
    pub fn next_f32(&mut self) -> f32 {
        (self.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// A point of the unit square.
    pub fn point2(&mut self) -> Point2 {
        Point2::new(self.next_f32(), self.next_f32())
    }
}
