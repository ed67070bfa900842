//! Vertices at the same place, and normals that they share.

use aureole_desc::Mesh;
use aureole_math::{Point3, Vector3};
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

/// The normals of the faces around each group of vertices, weighted by the faces' angles there; +Z where there are none.
pub(super) fn smooth_normals(mesh: &Mesh, group_of: &[u32], groups: usize) -> Vec<[f32; 3]> {
    let mut sums = vec![Vector3::ZERO; groups];
    for triangle in &mesh.indices {
        let p = triangle.map(|i| Point3::from(mesh.positions[i as usize]));
        let normal = (p[1] - p[0]).cross(p[2] - p[0]);
        let length = normal.length();
        if !(length > 0.0 && length.is_finite()) {
            continue;
        }
        for corner in 0..3 {
            let (a, b) = (p[(corner + 1) % 3] - p[corner], p[(corner + 2) % 3] - p[corner]);
            let angle = length.atan2(a.dot(b));
            sums[group_of[triangle[corner] as usize] as usize] += normal * (angle / length);
        }
    }
    let unit = |sum: &Vector3| sum.try_normalized().unwrap_or(Vector3::Z).to_array();
    let units: Vec<[f32; 3]> = sums.iter().map(unit).collect();
    group_of.iter().map(|&group| units[group as usize]).collect()
}
