//! Every reader meets tens of thousands of damaged files; and every file that ever broke one.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use aureole_hostile::corrupt::{Corrupted, Corruptor, truncations};
use aureole_hostile::samples;
use aureole_hostile::targets::{self, Target};

/// No single file may hold a reader up for longer: what multiplies takes for ever, a busy machine only a while.
const PATIENCE: Duration = Duration::from_secs(60);

/// Gives a damaged file to a target; a failure says which one it was.
fn check(target: &Target, sample: &str, damaged: &Corrupted) {
    let start = Instant::now();
    let result = catch_unwind(AssertUnwindSafe(|| target.check(&damaged.bytes)));
    let place = format!("{}: {sample}, {}", target.name, damaged.what);
    assert!(result.is_ok(), "{place}: {:?}", String::from_utf8_lossy(&damaged.bytes));
    assert!(start.elapsed() < PATIENCE, "{place}: {:?}", start.elapsed());
}

/// `count` damaged copies of every sample, after those that are cut off at every 64th byte.
fn damage(name: &str, count: usize) {
    let target = targets::find(name).expect("the target is in the list");
    for sample in samples::of(name) {
        let mut corruptor = Corruptor::new(sample.bytes.len() as u64);
        let cuts = truncations(&sample.bytes, 64).step_by(sample.bytes.len().div_ceil(64 * count).max(1));
        let drawn = (0..count).map(|_| corruptor.corrupt(&sample.bytes));
        cuts.chain(drawn).for_each(|damaged| check(target, &sample.name, &damaged));
    }
}

#[test]
fn pbrt() {
    damage("pbrt", 6_000);
}

#[test]
fn mitsuba() {
    damage("mitsuba", 4_000);
}

#[test]
fn meshes_and_grids() {
    for name in ["ply", "obj", "mtl", "serialized", "vol"] {
        damage(name, 20_000);
    }
}

#[test]
fn measured_reflectances() {
    damage("brdf", 2_000);
}

#[test]
fn light_profiles_curves_and_spectra() {
    for (name, count) in [("ies", 500), ("curves", 2_000), ("spectrum", 20_000)] {
        damage(name, count);
    }
}

#[test]
fn films() {
    damage("film", 2_000);
}

#[test]
fn images() {
    damage("image", 2_000);
}

#[test]
fn packed_files() {
    damage("gzip", 1000);
}

#[test]
fn damaged_scenes_render_or_say_why_not() {
    damage("pbrt_render", 400);
    damage("mitsuba_render", 200);
}

#[test]
fn scenes_of_anything_render_or_say_why_not() {
    damage("wild", 400);
}

/// Files that once broke a reader, named TARGET-WHAT.
#[test]
fn what_was_mended_stays_mended() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/regressions");
    for entry in std::fs::read_dir(folder).expect("the folder is part of the project") {
        let path = entry.expect("it can be listed").path();
        let name = path.file_name().and_then(|name| name.to_str()).expect("names are ASCII").to_owned();
        let target =
            name.split('-').next().and_then(targets::find).unwrap_or_else(|| panic!("{name}: no target"));
        let bytes = std::fs::read(&path).expect("it can be read");
        check(target, &name, &Corrupted { what: "regression".into(), bytes });
    }
}
