//! Where the vertices of a Catmull-Clark surface end after infinitely many levels, and the normals there.
//!
//! Around a vertex, sharp edges part the faces into sectors; each has a normal of its own.
//!
//! # References
//! [Halstead et al. 1993] "Efficient, Fair Interpolation using Catmull-Clark Surfaces", appendix; [Biermann et al. 2000]
//! "Piecewise Smooth Subdivision Surfaces with Normal Control" for the tangents along sharp edges.

use std::f32::consts::{PI, TAU};

use aureole_desc::{AttributeDomain, Mesh};
use aureole_math::Vector3;
use rustc_hash::FxHashMap;

use super::catmull_clark::{Sharp, Surface, key};

/// Faces around a vertex between sharp edges, in the order in which they turn.
struct Sector {
    /// Far ends of the edges; one more than faces, unless the ring is closed.
    ends: Vec<Vector3>,
    /// Corners opposite to the vertex.
    across: Vec<Vector3>,
    is_closed: bool,
}

/// The triangles of a surface of quadrilaterals, moved to the limit.
pub(super) fn mesh(surface: &Surface, control: &Mesh) -> Mesh {
    let (edges, index) = surface.edges();
    let is_cut = |a: u32, b: u32| edges[index[&key(a, b)] as usize].sharpness > 0.0;
    let mut sharp = vec![Sharp::default(); surface.p.len()];
    for edge in &edges {
        for (v, other) in [(edge.ends[0], edge.ends[1]), (edge.ends[1], edge.ends[0])] {
            sharp[v as usize].add(edge.sharpness, surface.p[other as usize]);
        }
    }
    let corners_of = corners_of_vertices(surface);
    let mut positions = surface.p.clone();
    let mut sector_of = vec![0u32; surface.corners.len()];
    let mut normals = Vec::new();
    for (v, corners) in corners_of.iter().enumerate().filter(|(_, corners)| !corners.is_empty()) {
        let chains = chains(surface, corners, &is_cut);
        let sectors = chains.len();
        for chain in chains {
            let mut sector = sector(surface, &chain);
            // A single sharp edge ends here: the surface is smooth around it.
            if sharp[v].count == 1 && sector.across.len() == corners.len() && !sector.is_closed {
                sector.ends.pop();
                sector.is_closed = true;
            }
            for &corner in &chain {
                sector_of[corner as usize] = normals.len() as u32;
            }
            let is_corner = sharp[v].is_corner(corners.len() as u32);
            normals.push(normal(surface.p[v], &sector, is_corner).to_array());
            if sector.is_closed && sector.across.len() == corners.len() {
                positions[v] = smooth_limit(surface.p[v], &sector);
            }
        }
        if sharp[v].count == 2 && !sharp[v].is_corner(corners.len() as u32) && sectors <= 2 {
            positions[v] = (surface.p[v] * 4.0 + sharp[v].ends) / 6.0;
        }
    }
    triangles(surface, control, &positions, &sector_of, &normals)
}

/// The corners at each vertex.
fn corners_of_vertices(surface: &Surface) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); surface.p.len()];
    for (i, &v) in surface.corners.iter().enumerate() {
        lists[v as usize].push(i as u32);
    }
    lists
}

/// The vertices of a corner's face from the corner on: itself, next, opposite, before.
fn turned(surface: &Surface, corner: u32) -> [u32; 4] {
    let (face, i) = (corner / 4 * 4, corner % 4);
    [0, 1, 2, 3].map(|k| surface.corners[(face + (i + k) % 4) as usize])
}

/// The corners of a vertex in chains that follow each other without a sharp edge between them.
fn chains(surface: &Surface, corners: &[u32], is_cut: &impl Fn(u32, u32) -> bool) -> Vec<Vec<u32>> {
    // By their first edge, to find the one after another soon even where thousands of faces meet.
    let mut left: Vec<(u32, u32, bool)> =
        corners.iter().map(|&corner| (turned(surface, corner)[1], corner, true)).collect();
    left.sort_unstable();
    let mut chains = Vec::new();
    for starts_anywhere in [false, true] {
        for first in 0..left.len() {
            let v = surface.corners[left[first].1 as usize];
            if !left[first].2 || !(starts_anywhere || is_cut(v, left[first].0)) {
                continue;
            }
            let mut at = Some(first);
            let mut chain = Vec::new();
            while let Some(i) = at {
                left[i].2 = false;
                chain.push(left[i].1);
                let before = turned(surface, left[i].1)[3];
                let next = left.partition_point(|(end, ..)| *end < before);
                let follows = left.get(next).is_some_and(|(end, _, is_left)| *end == before && *is_left);
                at = (follows && !is_cut(v, before)).then_some(next);
            }
            chains.push(chain);
        }
    }
    chains
}

fn sector(surface: &Surface, chain: &[u32]) -> Sector {
    let at = |v: u32| surface.p[v as usize];
    let faces: Vec<[u32; 4]> = chain.iter().map(|&corner| turned(surface, corner)).collect();
    let mut ends: Vec<Vector3> = faces.iter().map(|f| at(f[1])).collect();
    let is_closed = faces.len() > 1 && faces[faces.len() - 1][3] == faces[0][1];
    if !is_closed {
        ends.push(at(faces[faces.len() - 1][3]));
    }
    Sector { ends, across: faces.iter().map(|f| at(f[2])).collect(), is_closed }
}

fn sum(list: &[Vector3], weight: impl Fn(f32) -> f32) -> Vector3 {
    list.iter().enumerate().fold(Vector3::ZERO, |sum, (i, &p)| sum + p * weight(i as f32))
}

fn smooth_limit(v: Vector3, sector: &Sector) -> Vector3 {
    let n = sector.across.len() as f32;
    let around = sum(&sector.ends, |_| 4.0) + sum(&sector.across, |_| 1.0);
    (v * (n * n) + around) / (n * (n + 5.0))
}

/// The cross product of two tangents of the limit surface; +Z where there is none.
fn normal(v: Vector3, sector: &Sector, is_corner: bool) -> Vector3 {
    let (ends, across) = (&sector.ends, &sector.across);
    let k = across.len() as f32;
    let [s, t] = if sector.is_closed {
        let step = TAU / k;
        let a = 1.0 + step.cos() + (PI / k).cos() * (2.0 * (9.0 + step.cos())).sqrt();
        let tangent = |phase: f32| {
            let wave = |i: f32| (i * step - phase).cos();
            sum(ends, |i| a * wave(i)) + sum(across, |i| wave(i) + wave(i + 1.0))
        };
        [tangent(0.0), tangent(PI / 2.0)]
    } else {
        let (first, last) = (ends[0], ends[ends.len() - 1]);
        let [along, other] = [first - v, last - v];
        // At corners the two edges span the tangents, unless they are one line.
        if is_corner || across.len() < 2 {
            let n = along.cross(other);
            if n.length_squared() > 1e-8 * along.length_squared() * other.length_squared() && across.len() < 3
            {
                return n.try_normalized().unwrap_or(Vector3::Z);
            }
        }
        let theta = PI / k;
        let (cos, sin) = (theta.cos(), theta.sin());
        let r = (cos + 1.0) / sin.max(1e-6);
        let wave = |i: f32| (i * theta).sin();
        let inner = sum(&ends[1..ends.len() - 1], |i| 4.0 * wave(i + 1.0));
        let faces = sum(across, |i| wave(i) + wave(i + 1.0));
        let border = v * (4.0 * r * (cos - 1.0)) - (first + last) * (r * (1.0 + 2.0 * cos));
        [first - last, border + inner + faces]
    };
    s.cross(t).try_normalized().unwrap_or(Vector3::Z)
}

/// Gathers everything that differs at a corner into vertices.
fn triangles(
    surface: &Surface,
    control: &Mesh,
    positions: &[Vector3],
    sector_of: &[u32],
    normals: &[[f32; 3]],
) -> Mesh {
    let mut mesh = Mesh { attributes: control.attributes.clone(), ..Mesh::default() };
    mesh.attributes.iter_mut().for_each(|attribute| attribute.data.clear());
    let mut known: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let mut vertex_rows = Vec::new();
    let mut vertex = |corner: usize| {
        let row = if surface.width > 0 { surface.row_of[corner] } else { 0 };
        *known.entry([sector_of[corner], row]).or_insert_with(|| {
            mesh.positions.push(positions[surface.corners[corner] as usize].to_array());
            mesh.normals.push(normals[sector_of[corner] as usize]);
            vertex_rows.push(row);
            mesh.positions.len() as u32 - 1
        })
    };
    for f in 0..surface.origin.len() {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| vertex(4 * f + i));
        mesh.indices.extend([[a, b, c], [a, c, d]]);
    }
    for row in vertex_rows {
        let mut row = surface.rows.iter().skip(row as usize * surface.width).copied();
        if !control.uvs.is_empty() {
            mesh.uvs.push([row.next().unwrap_or(0.0), row.next().unwrap_or(0.0)]);
        }
        for attribute in mesh.attributes.iter_mut().filter(|a| a.domain == AttributeDomain::Vertex) {
            attribute.data.extend(row.by_ref().take(attribute.channels));
        }
    }
    let of_faces = |a: &(usize, &mut aureole_desc::Attribute)| a.1.domain == AttributeDomain::Face;
    for (i, attribute) in mesh.attributes.iter_mut().enumerate().filter(of_faces) {
        let n = attribute.channels;
        for &origin in &surface.origin {
            let value = &control.attributes[i].data[origin as usize * n..][..n];
            attribute.data.extend([value, value].concat());
        }
    }
    mesh
}
