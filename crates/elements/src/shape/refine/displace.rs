//! Displacement: a mesh is divided until its edges are short, and its vertices move along their normals.

use aureole_desc::{AttributeDomain, Mesh};
use aureole_math::{Arena, Id, Normal3, Point2, Point3, Transform, Vector3};
use aureole_spectrum::Wavelengths;
use rustc_hash::FxHashMap;

use super::weld;
use crate::{Texture, TextureContext};

/// Divides the longest edge of each triangle until none is longer than `edge_length` in the world. Whether and where an
/// edge is divided depends on its ends alone. `None` where that needs more than `limit` triangles.
pub(super) fn tessellate(
    control: &Mesh,
    world_from_object: &Transform,
    edge_length: f32,
    limit: u64,
) -> Option<Mesh> {
    let mut mesh = control.clone();
    mesh.polygons.clear();
    if mesh.normals.is_empty() {
        let (place_of, places) = weld::places(&mesh.positions);
        mesh.normals = mesh.smooth_normals(places, |vertex| place_of[vertex] as usize);
    }
    mesh.indices.clear();
    mesh.attributes.iter_mut().filter(|a| a.domain == AttributeDomain::Face).for_each(|a| a.data.clear());
    let mut middles: FxHashMap<[u32; 2], Option<u32>> = FxHashMap::default();
    let mut stack = Vec::new();
    for (face, &triangle) in control.indices.iter().enumerate() {
        stack.push(triangle);
        while let Some(t) = stack.pop() {
            let side = |i: usize| {
                let [a, b] = [t[i], t[(i + 1) % 3]].map(|v| Point3::from(mesh.positions[v as usize]));
                world_from_object.vector(b - a).length_squared()
            };
            let sides = [side(0), side(1), side(2)];
            let mut longest = [0, 1, 2];
            longest.sort_by(|&a, &b| sides[b].total_cmp(&sides[a]));
            let divided =
                longest.into_iter().filter(|&i| sides[i] > edge_length * edge_length).find_map(|i| {
                    let ends = [t[i].min(t[(i + 1) % 3]), t[i].max(t[(i + 1) % 3])];
                    let middle = *middles.entry(ends).or_insert_with(|| add_middle(&mut mesh, ends));
                    middle.map(|m| (i, m))
                });
            match divided {
                Some((i, m)) => {
                    let [a, b, c] = [t[i], t[(i + 1) % 3], t[(i + 2) % 3]];
                    stack.extend([[m, b, c], [a, m, c]]);
                }
                None => {
                    mesh.indices.push(t);
                    let faces = mesh.attributes.iter_mut().zip(&control.attributes);
                    for (a, from) in faces.filter(|(a, _)| a.domain == AttributeDomain::Face) {
                        a.data.extend_from_slice(&from.data[face * a.channels..(face + 1) * a.channels]);
                    }
                }
            }
            if (mesh.indices.len() + stack.len()) as u64 > limit {
                return None;
            }
        }
    }
    Some(mesh)
}

/// Adds the vertex in the middle of an edge; `None` where there is no number between its ends.
fn add_middle(mesh: &mut Mesh, [a, b]: [u32; 2]) -> Option<u32> {
    let (a, b) = (a as usize, b as usize);
    let [p, q] = [mesh.positions[a], mesh.positions[b]];
    let middle: [f32; 3] = std::array::from_fn(|i| 0.5 * p[i] + 0.5 * q[i]);
    if middle == p || middle == q {
        return None;
    }
    mesh.positions.push(middle);
    let [m, n] = [mesh.normals[a], mesh.normals[b]].map(Vector3::from);
    mesh.normals.push((m + n).try_normalized().unwrap_or(m).to_array());
    if !mesh.uvs.is_empty() {
        let [s, t] = [mesh.uvs[a], mesh.uvs[b]];
        mesh.uvs.push([0.5 * s[0] + 0.5 * t[0], 0.5 * s[1] + 0.5 * t[1]]);
    }
    for attribute in mesh.attributes.iter_mut().filter(|a| a.domain == AttributeDomain::Vertex) {
        for i in 0..attribute.channels {
            let [x, y] = [a, b].map(|v| attribute.data[v * attribute.channels + i]);
            attribute.data.push(0.5 * x + 0.5 * y);
        }
    }
    Some(mesh.positions.len() as u32 - 1)
}

/// Moves each vertex along its normal by the texture's value there, and gives the moved surface normals of its own. Vertices
/// at the same place move to the mean of their ways: what was closed stays closed.
pub(super) fn displace(
    mut mesh: Mesh,
    world_from_object: &Transform,
    texture: Id<Texture>,
    textures: &Arena<Texture>,
) -> Mesh {
    let (place_of, places) = weld::places(&mesh.positions);
    // Edges that were hard stay hard.
    let (group_of, groups) =
        weld::number(place_of.iter().zip(&mesh.normals).map(|(&place, n)| (place, n.map(f32::to_bits))));
    let mut sums = vec![(Vector3::ZERO, 0.0_f32); places];
    for (i, &place) in place_of.iter().enumerate() {
        let n = Vector3::from(mesh.normals[i]).try_normalized().unwrap_or(Vector3::Z);
        let context = TextureContext {
            p: world_from_object.point(Point3::from(mesh.positions[i])),
            n: Vector3::from(world_from_object.normal(Normal3::from(n))).try_normalized().unwrap_or(n),
            ..TextureContext::at_uv(
                textures,
                Wavelengths::RGB,
                mesh.uvs.get(i).copied().map_or(Point2::new(0.0, 0.0), Point2::from),
            )
        };
        let height = context.float(texture);
        let sum = &mut sums[place as usize];
        sum.0 += n * if height.is_finite() { height } else { 0.0 };
        sum.1 += 1.0;
    }
    for (p, &place) in mesh.positions.iter_mut().zip(&place_of) {
        let (sum, count) = sums[place as usize];
        *p = (Vector3::from(*p) + sum / count).to_array();
    }
    mesh.normals = mesh.smooth_normals(groups, |vertex| group_of[vertex] as usize);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of twelve triangles whose faces share no vertex.
    fn loose_box() -> Mesh {
        let mut mesh = Mesh::default();
        for axis in 0..3 {
            for side in [-1.0_f32, 1.0] {
                let first = mesh.positions.len() as u32;
                for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0_f32)] {
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, a * side, b);
                    let mut n = [0.0; 3];
                    n[axis] = side;
                    mesh.positions.push(p);
                    mesh.normals.push(n);
                    mesh.uvs.push([a, b]);
                }
                mesh.indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
        }
        mesh
    }

    /// Height by u.
    #[derive(Debug)]
    struct Slope;

    impl crate::texture::TextureOps for Slope {
        fn eval(&self, at: &TextureContext<'_>) -> aureole_spectrum::Spectrum {
            aureole_spectrum::Spectrum::splat(0.2 + 0.1 * at.uv.x)
        }
        fn mean(&self, _: &Arena<Texture>) -> aureole_spectrum::Spectrum {
            aureole_spectrum::Spectrum::splat(0.2)
        }
    }

    /// Every edge is used once in each direction, by places.
    fn assert_closed(mesh: &Mesh) {
        let (place_of, _) = weld::places(&mesh.positions);
        let mut uses: FxHashMap<[u32; 2], i32> = FxHashMap::default();
        for t in &mesh.indices {
            for i in 0..3 {
                let (a, b) = (place_of[t[i] as usize], place_of[t[(i + 1) % 3] as usize]);
                *uses.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
        assert!(uses.values().all(|&n| n == 0));
    }

    #[test]
    fn closed_meshes_stay_closed() {
        let place = Transform::scale(Vector3::new(1.0, 2.0, 0.5));
        let fine = tessellate(&loose_box(), &place, 0.3, 1 << 20).expect("is small");
        assert!(fine.indices.len() > 500, "{}", fine.indices.len());
        for t in &fine.indices {
            for i in 0..3 {
                let [a, b] = [t[i], t[(i + 1) % 3]].map(|v| Point3::from(fine.positions[v as usize]));
                assert!(place.vector(b - a).length() <= 0.3 + 1e-6);
            }
        }
        let mut textures = Arena::new();
        let slope = textures.push(Texture::Custom(std::sync::Arc::new(Slope)));
        let moved = displace(fine.clone(), &place, slope, &textures);
        assert_eq!(moved.check(), Ok(()));
        assert_closed(&fine);
        assert_closed(&moved);
        let biggest = moved.positions.iter().flatten().fold(0.0_f32, |m, x| m.max(x.abs()));
        assert!(biggest > 1.05, "{biggest}");
    }

    #[test]
    fn limits_and_endless_edges() {
        assert!(tessellate(&loose_box(), &Transform::default(), 1e-3, 10_000).is_none());
        // Between neighbouring numbers there is no middle.
        let mut far = loose_box();
        far.positions.iter_mut().flatten().for_each(|x| *x = 3e7 + *x * 2.0);
        let fine = tessellate(&far, &Transform::default(), 1e-3, 10_000).expect("ends");
        assert!(fine.indices.len() < 10_000);
    }
}
