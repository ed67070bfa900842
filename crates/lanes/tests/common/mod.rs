//! Numbers to test with, and the instruction sets of this machine.

use aureole_lanes::Level;

/// What this processor has besides one lane.
pub(crate) fn wide_levels() -> impl Iterator<Item = Level> {
    Level::ALL.into_iter().filter(|level| *level != Level::One && level.is_available())
}

/// Words that look random.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32 ^ (self.0 >> 9) as u32
    }

    /// Between two limits.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.word() >> 8) as f32 / (1 << 24) as f32
    }
}

/// The numbers where rules change, of both signs.
pub(crate) fn special() -> Vec<f32> {
    let sizes = [
        0.0,
        f32::from_bits(1),
        f32::MIN_POSITIVE / 2.0,
        f32::MIN_POSITIVE,
        1e-10,
        0.25,
        0.499_999_97,
        0.5,
        0.500_000_06,
        0.999_999_94,
        1.0,
        1.000_000_1,
        1.5,
        2.5,
        std::f32::consts::PI,
        88.7,
        104.0,
        127.5,
        8_388_607.5,
        8_388_608.0,
        2_147_483_500.0,
        2_147_483_600.0,
        4_294_967_300.0,
        1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    sizes.iter().flat_map(|&x| [x, -x]).collect()
}

/// Special numbers, numbers with any bits, and numbers of common sizes.
pub(crate) fn floats(count: usize, seed: u64) -> Vec<f32> {
    let mut random = Random(seed);
    let mut all = special();
    while all.len() < count {
        all.push(f32::from_bits(random.word()));
        all.push(random.between(-4.0, 4.0));
        all.push(random.between(-100.0, 100.0));
        all.push(random.between(-1.0, 1.0));
    }
    all.truncate(count);
    all
}
