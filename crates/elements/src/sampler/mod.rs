//! Sample generators: pure functions of (seed, pixel, sample index, dimension).

mod independent;
mod sobol;
mod stratified;

use std::fmt::Debug;

use aureole_math::Point2;

pub use independent::Independent;
pub use sobol::Sobol;
pub use stratified::Stratified;

/// Which sample of which pixel: all that a sampler may depend on, besides the dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleKey {
    /// A hash of the pixel's coordinates and the render's seed.
    pub pixel_hash: u32,
    /// The sample's index within its pixel.
    pub sample: u32,
}

impl SampleKey {
    /// The key of a sample.
    #[inline]
    pub fn new(seed: u64, x: u32, y: u32, sample: u32) -> Self {
        let hash = aureole_math::hash_u64(seed ^ aureole_math::hash_u64(u64::from(y) << 32 | u64::from(x)));
        Self { pixel_hash: (hash >> 32) as u32 ^ hash as u32, sample }
    }
}

/// What every sample generator can do. All values lie in [0, 1).
///
/// Dimensions are numbered by the caller; a two-dimensional draw has one number, shared with no one-dimensional draw.
pub trait SamplerOps: Debug + Send + Sync {
    /// Samples per pixel for which the sequence is laid out.
    fn sample_count(&self) -> u32;

    /// One number.
    fn get_1d(&self, key: SampleKey, dimension: u32) -> f32;

    /// Two numbers, well distributed together.
    fn get_2d(&self, key: SampleKey, dimension: u32) -> Point2;
}

registry! {
    ($)
    /// Any built-in sample generator.
    Sampler: SamplerOps, match with each_sampler;
    independent::Independent as Independent = "independent",
    stratified::Stratified as Stratified = "stratified",
    sobol::Sobol as Sobol = "sobol",
}

impl Sampler {
    /// Samples per pixel for which the sequence is laid out.
    pub fn sample_count(&self) -> u32 {
        each_sampler!(self, s => s.sample_count())
    }

    /// One number in [0, 1).
    #[inline]
    pub fn get_1d(&self, key: SampleKey, dimension: u32) -> f32 {
        each_sampler!(self, s => s.get_1d(key, dimension))
    }

    /// Two numbers in [0, 1), well distributed together.
    #[inline]
    pub fn get_2d(&self, key: SampleKey, dimension: u32) -> Point2 {
        each_sampler!(self, s => s.get_2d(key, dimension))
    }
}

/// The upper 24 bits as a number in [0, 1).
#[inline]
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}
