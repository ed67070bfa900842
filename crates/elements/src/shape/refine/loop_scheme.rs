//! Loop's subdivision surfaces, with vertices and normals where the limit surface has them.
//!
//! # References
//! [Loop 1987] "Smooth Subdivision Surfaces Based on Triangles"; [Hoppe et al. 1994] "Piecewise Smooth Surface
//! Reconstruction" for borders; [PBRT3, section 3.8] for the weights used here.

use std::f32::consts::{PI, TAU};

use aureole_desc::Mesh;
use aureole_math::Vector3;
use rustc_hash::FxHashMap;

/// The vertices around a vertex, in the order in which the faces turn.
#[derive(Clone, Debug)]
struct Ring {
    around: Vec<u32>,
    is_border: bool,
}

/// Divides every triangle of a control mesh into four, `levels` times, and moves the vertices onto the limit surface.
///
/// # Errors
/// Edges of more than two faces, or faces that turn against each other.
pub(super) fn subdivide(control: &Mesh, levels: u32) -> Result<Mesh, String> {
    let mut p: Vec<Vector3> = control.positions.iter().map(|p| Vector3::from(*p)).collect();
    let mut triangles = control.indices.clone();
    for _ in 0..levels {
        let rings = rings(p.len(), &triangles)?;
        (p, triangles) = refined(&p, &triangles, &rings);
    }
    let rings = rings(p.len(), &triangles)?;
    let each = |f: fn(&[Vector3], usize, &Ring) -> Vector3, p: &[Vector3]| {
        rings.iter().enumerate().map(|(i, ring)| f(p, i, ring)).collect::<Vec<_>>()
    };
    let limit = each(limit_position, &p);
    let normals = each(limit_normal, &limit);
    let arrays = |list: Vec<Vector3>| list.into_iter().map(Vector3::to_array).collect();
    Ok(Mesh { positions: arrays(limit), indices: triangles, normals: arrays(normals), ..Mesh::default() })
}

/// Orders the neighbours of every vertex.
fn rings(vertices: usize, triangles: &[[u32; 3]]) -> Result<Vec<Ring>, String> {
    let mut steps: Vec<Vec<[u32; 2]>> = vec![Vec::new(); vertices];
    for t in triangles {
        for i in 0..3 {
            steps[t[i] as usize].push([t[(i + 1) % 3], t[(i + 2) % 3]]);
        }
    }
    steps.iter().enumerate().map(|(vertex, steps)| ring(vertex, steps)).collect()
}

/// Chains the steps from neighbour to neighbour.
fn ring(vertex: usize, steps: &[[u32; 2]]) -> Result<Ring, String> {
    let broken = || format!("the faces around vertex {vertex} do not form a single fan");
    let Some(first) = steps.first() else { return Ok(Ring { around: Vec::new(), is_border: true }) };
    // At a border one neighbour is entered by no step: there the chain begins.
    let begins = |from: &u32| steps.iter().all(|[_, to]| to != from);
    let border = steps.iter().map(|[from, _]| *from).find(begins);
    let start = border.unwrap_or(first[0]);
    let mut around = vec![start];
    let mut at = start;
    for _ in steps {
        let mut out = steps.iter().filter(|[from, _]| *from == at);
        let (Some([_, to]), None) = (out.next(), out.next()) else { return Err(broken()) };
        at = *to;
        around.push(at);
    }
    if border.is_none() {
        around.pop();
    }
    let mut distinct = around.clone();
    distinct.sort_unstable();
    distinct.dedup();
    let is_closed = border.is_some() || at == start;
    if !is_closed || distinct.len() != around.len() {
        Err(broken())
    } else {
        Ok(Ring { around, is_border: border.is_some() })
    }
}

/// A neighbour's weight when a vertex moves.
fn beta(valence: usize) -> f32 {
    if valence == 3 { 3.0 / 16.0 } else { 3.0 / (8.0 * valence as f32) }
}

/// A vertex blended with the sum of all neighbours, or with the two along a border.
fn blend(p: &[Vector3], i: usize, ring: &Ring, inside: f32, border: f32) -> Vector3 {
    let n = ring.around.len();
    match ring.around[..] {
        [] => p[i],
        [first, .., last] if ring.is_border => {
            p[i] * (1.0 - 2.0 * border) + (p[first as usize] + p[last as usize]) * border
        }
        _ => {
            let sum = ring.around.iter().fold(Vector3::ZERO, |sum, &j| sum + p[j as usize]);
            p[i] * (1.0 - n as f32 * inside) + sum * inside
        }
    }
}

/// One level: old vertices move, each edge gets a new one, each triangle becomes four.
fn refined(p: &[Vector3], triangles: &[[u32; 3]], rings: &[Ring]) -> (Vec<Vector3>, Vec<[u32; 3]>) {
    let mut next: Vec<Vector3> =
        rings.iter().enumerate().map(|(i, ring)| blend(p, i, ring, beta(ring.around.len()), 0.125)).collect();
    // For each edge: its new vertex, and the sum of the vertices opposite to it.
    let mut edges: FxHashMap<[u32; 2], (u32, Vector3, u32)> = FxHashMap::default();
    let mut order = Vec::new();
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    for t in triangles {
        for i in 0..3 {
            let edge = key(t[i], t[(i + 1) % 3]);
            let entry = edges.entry(edge).or_insert_with(|| {
                order.push(edge);
                ((p.len() + order.len() - 1) as u32, Vector3::ZERO, 0)
            });
            entry.1 += p[t[(i + 2) % 3] as usize];
            entry.2 += 1;
        }
    }
    next.extend(order.iter().map(|edge| {
        let ends = p[edge[0] as usize] + p[edge[1] as usize];
        match edges[edge] {
            (_, opposite, 2) => ends * 0.375 + opposite * 0.125,
            _ => ends * 0.5,
        }
    }));
    let middle = |a: u32, b: u32| edges[&key(a, b)].0;
    let split = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    (next, triangles.iter().flat_map(split).collect())
}

/// Where a vertex ends after infinitely many levels.
fn limit_position(p: &[Vector3], i: usize, ring: &Ring) -> Vector3 {
    let n = ring.around.len().max(1);
    blend(p, i, ring, 1.0 / (n as f32 + 3.0 / (8.0 * beta(n))), 0.2)
}

/// The cross product of two tangents of the limit surface; +Z where there is none.
fn limit_normal(p: &[Vector3], i: usize, ring: &Ring) -> Vector3 {
    let r: Vec<Vector3> = ring.around.iter().map(|&j| p[j as usize]).collect();
    let n = r.len();
    let sum = |weight: &dyn Fn(f32) -> f32| {
        r.iter().enumerate().fold(Vector3::ZERO, |sum, (j, &q)| sum + q * weight(j as f32))
    };
    let [s, t] = match n {
        0 | 1 => [Vector3::ZERO; 2],
        _ if !ring.is_border => {
            let step = TAU / n as f32;
            [sum(&|j| (j * step).cos()), sum(&|j| (j * step).sin())]
        }
        // Along the border, and across it: the wider the fan, the more neighbours have a say.
        _ => {
            let across = match n {
                2 => r[0] + r[1] - p[i] * 2.0,
                3 => r[1] - p[i],
                4 => (r[1] + r[2]) * 2.0 - r[0] - r[3] - p[i] * 2.0,
                _ => {
                    let theta = PI / (n - 1) as f32;
                    let inner = |j: f32| (2.0 * theta.cos() - 2.0) * (j * theta).sin();
                    let ends = (r[0] + r[n - 1]) * theta.sin();
                    -(ends + sum(&inner))
                }
            };
            [r[0] - r[n - 1], across]
        }
    };
    s.cross(t).try_normalized().unwrap_or(Vector3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron() -> Mesh {
        let positions =
            [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]].to_vec();
        let mut indices = Vec::new();
        for top in [4u32, 5] {
            let turn = [0u32, 2, 1, 3];
            for i in 0..4 {
                let (a, b) = (turn[i], turn[(i + 1) % 4]);
                indices.push(if top == 4 { [a, b, top] } else { [b, a, top] });
            }
        }
        Mesh { positions, indices, ..Mesh::default() }
    }

    #[test]
    fn closed_surfaces_become_smooth_and_face_outwards() {
        let mesh = subdivide(&octahedron(), 3).expect("is sound");
        assert_eq!(mesh.indices.len(), 8 * 64);
        assert_eq!(mesh.positions.len(), 4 * 64 + 2, "Euler");
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            let (p, n) = (Vector3::from(*p), Vector3::from(*n));
            assert!(p.length() < 1.0 && p.normalized().dot(n) > 0.8, "{p:?} {n:?}");
        }
        // The limit does not depend on the level: the first vertex stays where it is.
        let coarse = subdivide(&octahedron(), 0).expect("is sound");
        let d = Vector3::from(mesh.positions[0]) - Vector3::from(coarse.positions[0]);
        assert!(d.length() < 1e-6, "{d:?}");
    }

    #[test]
    fn flat_pieces_stay_flat_and_keep_their_border() {
        let positions = (0..9).map(|i| [(i % 3) as f32, (i / 3) as f32, 0.0]).collect();
        let mut indices = Vec::new();
        for a in [0u32, 1, 3, 4] {
            indices.extend([[a, a + 1, a + 4], [a, a + 4, a + 3]]);
        }
        let flat = Mesh { positions, indices, ..Mesh::default() };
        let mesh = subdivide(&flat, 2).expect("is sound");
        assert!(mesh.positions.iter().all(|p| p[2] == 0.0));
        assert!(mesh.normals.iter().all(|n| n[2] > 0.999), "{:?}", mesh.normals);
        let middle = Vector3::from(mesh.positions[1]) - Vector3::X;
        assert!(middle.length() < 1e-6, "corners are rounded, but the middle of a side stays: {middle:?}");
    }

    #[test]
    fn what_is_no_surface_is_refused() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
        let indices = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]];
        let fan = Mesh { positions, indices, ..Mesh::default() };
        assert!(subdivide(&fan, 1).is_err());
    }
}
