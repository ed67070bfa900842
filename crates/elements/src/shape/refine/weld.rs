//! Vertices at the same place.

use rustc_hash::FxHashMap;

/// For each vertex the number of its place: vertices at the very same place share one. Places are numbered as they come.
pub(super) fn places(positions: &[[f32; 3]]) -> (Vec<u32>, usize) {
    // Adding zero makes the two zeros one.
    number(positions.iter().map(|p| p.map(|x| (x + 0.0).to_bits())))
}

/// Numbers the distinct keys as they come.
pub(super) fn number<K: std::hash::Hash + Eq>(keys: impl Iterator<Item = K>) -> (Vec<u32>, usize) {
    let mut known: FxHashMap<K, u32> = FxHashMap::default();
    let numbers = keys
        .map(|key| {
            let next = known.len() as u32;
            *known.entry(key).or_insert(next)
        })
        .collect();
    (numbers, known.len())
}
