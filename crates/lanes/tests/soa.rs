//! Columns keep what is put into them, in order, for any number of lanes.

#[expect(dead_code, reason = "shared with other tests")]
mod common;

use aureole_lanes::soa::{CAPACITY, F, S4, U, V3};
use aureole_lanes::{Kernel, Lanes, Level, Mask, Real, Spectrum4, Vec3, Word, run, soa};
use common::wide_levels;

soa! {
    /// A ray.
    struct Ray in Rays { o: V3, t: F }
}

soa! {
    /// What travels along it.
    struct Path in Paths { ray: Rays, throughput: S4, slot: U }
}

/// The path whose fields follow from its number.
#[inline(always)]
fn path<R: Real>(slot: R::Word) -> Path<R> {
    let x = R::from_word(slot);
    let o = Vec3::new(x, x + 0.25, x + 0.5);
    Path { ray: Ray { o, t: -x }, throughput: Spectrum4([x * 2.0, x * 3.0, x * 4.0, x * 5.0]), slot }
}

/// Fills columns with every third path of a thousand, in groups, then reads them one by one.
struct Every3;

impl Kernel for Every3 {
    type Output = ();
    #[inline(always)]
    fn run<R: Real>(self) {
        let mut paths = Paths::new();
        for (at, there) in soa::groups::<R>(1000) {
            let slot = R::Word::iota() + at as u32;
            let third = (slot * 0xaaaa_aaab).lt(R::Word::splat(0x5555_5556));
            paths.push::<R>(there & third, path::<R>(slot));
        }
        assert_eq!(paths.len(), 334);
        for i in 0..paths.len() {
            let [kept, expected] = [paths.load::<f32>(i), path::<f32>(aureole_lanes::Word1(3 * i as u32))];
            assert_eq!((kept.ray.o, kept.ray.t), (expected.ray.o, expected.ray.t));
            assert_eq!((kept.throughput, kept.slot), (expected.throughput, expected.slot));
        }
        let mut copy = Paths::new();
        copy.set_len(paths.len());
        for (at, there) in paths.groups::<R>() {
            let group = paths.load::<R>(at);
            copy.store::<R>(at, there.select(group, path::<R>(R::Word::splat(0))));
        }
        assert_eq!(copy.load::<f32>(333).slot.0, 999);
        assert_eq!(copy.load::<R>(300).ray.t.to_array(), paths.load::<R>(300).ray.t.to_array());
        copy.clear();
        assert!(copy.is_empty());
    }
}

#[test]
fn columns_keep_their_values() {
    for level in wide_levels().chain([Level::One]) {
        run(level, Every3);
    }
}

#[test]
#[should_panic(expected = "CAPACITY")]
fn there_is_no_room_beyond_capacity() {
    let mut rays = Rays::new();
    rays.set_len(CAPACITY);
    rays.push::<f32>(true, Ray { o: Vec3::splat([0.0; 3]), t: 0.0 });
}
