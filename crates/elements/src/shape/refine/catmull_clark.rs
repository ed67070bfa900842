//! Catmull and Clark's subdivision surfaces, with sharp and half-sharp edges.
//!
//! Borders are sharp, and vertices with a single face at a border stay where they are. Texture coordinates and vertex
//! attributes are interpolated within each face, so that they may jump between faces; face attributes are inherited.
//!
//! # References
//! [Catmull and Clark 1978] "Recursively Generated B-Spline Surfaces on Arbitrary Topological Meshes"; [DeRose et al. 1998]
//! "Subdivision Surfaces in Character Animation", section 3 and appendix B, for sharpness.

use aureole_desc::{Attribute, AttributeDomain, Mesh};
use aureole_math::Vector3;
use rustc_hash::FxHashMap;

use super::{limit_surface, weld};

/// A surface of faces with any number of corners.
pub(super) struct Surface {
    /// A place for each vertex.
    pub(super) p: Vec<Vector3>,
    /// First corner of each face, and one past the last.
    pub(super) starts: Vec<u32>,
    /// The vertex at each corner.
    pub(super) corners: Vec<u32>,
    /// The row of texture coordinates and attributes at each corner.
    pub(super) row_of: Vec<u32>,
    /// Those rows, one after the other.
    pub(super) rows: Vec<f32>,
    /// Numbers of a row.
    pub(super) width: usize,
    /// The triangle of the control mesh that each face comes from.
    pub(super) origin: Vec<u32>,
    /// Levels for which edges stay sharp; those that are not here are smooth.
    pub(super) sharpness: FxHashMap<[u32; 2], f32>,
}

/// An edge and what lies around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) ends: [u32; 2],
    /// Uses in the direction of `ends`, and against it.
    uses: [u32; 2],
    /// Sum of the middles of its faces.
    faces: Vector3,
    pub(super) sharpness: f32,
}

pub(super) fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Divides the faces of a control mesh `levels` times, and moves the vertices onto the limit surface.
pub(super) fn subdivide(control: &Mesh, levels: u32, creases: &[([u32; 2], f32)]) -> Mesh {
    if levels == 0 {
        return control.clone();
    }
    let mut surface = Surface::new(control, creases);
    for _ in 0..levels {
        surface = surface.refined();
    }
    limit_surface::mesh(&surface, control)
}

impl Surface {
    fn new(control: &Mesh, creases: &[([u32; 2], f32)]) -> Self {
        let (place_of, places) = weld::places(&control.positions);
        let mut p = vec![Vector3::ZERO; places];
        for (&place, position) in place_of.iter().zip(&control.positions) {
            p[place as usize] = Vector3::from(*position);
        }
        let mut this = Self {
            p,
            starts: vec![0],
            corners: Vec::new(),
            row_of: Vec::new(),
            rows: Vec::new(),
            width: 2 * usize::from(!control.uvs.is_empty())
                + vertex_attributes(control).map(|a| a.channels).sum::<usize>(),
            origin: Vec::new(),
            sharpness: FxHashMap::default(),
        };
        for (corners, triangle) in control.faces() {
            this.corners.extend(corners.iter().map(|&c| place_of[c as usize]));
            this.row_of.extend(corners);
            this.starts.push(this.corners.len() as u32);
            this.origin.push(triangle as u32);
        }
        if this.width > 0 {
            for i in 0..control.positions.len() {
                this.rows.extend(control.uvs.get(i).into_iter().flatten());
                for a in vertex_attributes(control) {
                    this.rows.extend(&a.data[i * a.channels..(i + 1) * a.channels]);
                }
            }
        }
        let place = |i: u32| place_of.get(i as usize).copied();
        for ([a, b], sharpness) in creases {
            if let (Some(a), Some(b)) = (place(*a), place(*b)) {
                this.sharpness.insert(key(a, b), *sharpness);
            }
        }
        this
    }

    /// Corners of a face.
    fn face(&self, f: usize) -> std::ops::Range<usize> {
        self.starts[f] as usize..self.starts[f + 1] as usize
    }

    fn face_middle(&self, f: usize) -> Vector3 {
        let corners = &self.corners[self.face(f)];
        let sum = corners.iter().fold(Vector3::ZERO, |sum, &c| sum + self.p[c as usize]);
        sum / corners.len() as f32
    }

    /// All edges in the order in which faces use them, and their places by their ends. What is not between two faces that
    /// turn the same way is sharp.
    pub(super) fn edges(&self) -> (Vec<Edge>, FxHashMap<[u32; 2], u32>) {
        let mut edges: Vec<Edge> = Vec::new();
        let mut index = FxHashMap::default();
        for f in 0..self.starts.len() - 1 {
            let (face, middle) = (self.face(f), self.face_middle(f));
            let n = face.len();
            for i in 0..n {
                let (a, b) = (self.corners[face.start + i], self.corners[face.start + (i + 1) % n]);
                let ends = key(a, b);
                let at = *index.entry(ends).or_insert_with(|| {
                    edges.push(Edge { ends, uses: [0; 2], faces: Vector3::ZERO, sharpness: 0.0 });
                    edges.len() as u32 - 1
                });
                let edge = &mut edges[at as usize];
                edge.uses[usize::from(a > b)] += 1;
                edge.faces += middle;
            }
        }
        for edge in &mut edges {
            let inside = edge.uses == [1, 1] && edge.ends[0] != edge.ends[1];
            let given = self.sharpness.get(&edge.ends).map_or(0.0, |s| s.max(0.0));
            edge.sharpness = if inside { given } else { f32::INFINITY };
        }
        (edges, index)
    }

    /// One level: each face becomes a quadrilateral for each of its corners.
    fn refined(&self) -> Self {
        let (edges, index) = self.edges();
        let (vertices, faces) = (self.p.len(), self.starts.len() - 1);
        let mut p = self.moved(&edges);
        p.extend(edges.iter().map(|edge| {
            let ends = self.p[edge.ends[0] as usize] + self.p[edge.ends[1] as usize];
            let sharp = ends * 0.5;
            let smooth = (ends + edge.faces) * 0.25;
            if edge.sharpness >= 1.0 { sharp } else { smooth + (sharp - smooth) * edge.sharpness }
        }));
        p.extend((0..faces).map(|f| self.face_middle(f)));
        let mut next = Self {
            p,
            starts: vec![0],
            corners: Vec::with_capacity(4 * self.corners.len()),
            row_of: Vec::with_capacity(4 * self.corners.len()),
            rows: self.rows.clone(),
            width: self.width,
            origin: Vec::with_capacity(self.corners.len()),
            sharpness: FxHashMap::default(),
        };
        let edge_at = |a: u32, b: u32| vertices as u32 + index[&key(a, b)];
        let mut middles: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        for f in 0..faces {
            let face = self.face(f);
            let (corners, rows) = (&self.corners[face.clone()], &self.row_of[face]);
            let n = corners.len();
            let center = (vertices + edges.len() + f) as u32;
            let center_row = next.add_row(rows);
            let sides: Vec<u32> = (0..n)
                .map(|i| {
                    let ends = key(rows[i], rows[(i + 1) % n]);
                    *middles.entry(ends).or_insert_with(|| next.add_row(&ends))
                })
                .collect();
            for i in 0..n {
                let before = (i + n - 1) % n;
                let (out, back) =
                    (edge_at(corners[i], corners[(i + 1) % n]), edge_at(corners[before], corners[i]));
                next.corners.extend([corners[i], out, center, back]);
                next.row_of.extend([rows[i], sides[i], center_row, sides[before]]);
                next.starts.push(next.corners.len() as u32);
                next.origin.push(self.origin[f]);
            }
        }
        for (i, edge) in edges.iter().enumerate().filter(|(_, edge)| edge.sharpness > 1.0) {
            let middle = (vertices + i) as u32;
            for end in edge.ends {
                next.sharpness.insert(key(end, middle), edge.sharpness - 1.0);
            }
        }
        next
    }

    /// Adds the mean of some rows, and gives its number.
    fn add_row(&mut self, of: &[u32]) -> u32 {
        if self.width == 0 {
            return 0;
        }
        for i in 0..self.width {
            let sum: f32 = of.iter().map(|&row| self.rows[row as usize * self.width + i]).sum();
            self.rows.push(sum / of.len() as f32);
        }
        (self.rows.len() / self.width) as u32 - 1
    }

    /// Where the vertices go.
    fn moved(&self, edges: &[Edge]) -> Vec<Vector3> {
        #[derive(Clone, Copy, Default)]
        struct Around {
            faces: u32,
            face_sum: Vector3,
            edges: u32,
            edge_sum: Vector3,
            sharp: Sharp,
        }
        let mut around = vec![Around::default(); self.p.len()];
        for f in 0..self.starts.len() - 1 {
            let middle = self.face_middle(f);
            for &c in &self.corners[self.face(f)] {
                around[c as usize].faces += 1;
                around[c as usize].face_sum += middle;
            }
        }
        for edge in edges {
            for (v, other) in [(edge.ends[0], edge.ends[1]), (edge.ends[1], edge.ends[0])] {
                let (at, other) = (&mut around[v as usize], self.p[other as usize]);
                at.edges += 1;
                at.edge_sum += other;
                at.sharp.add(edge.sharpness, other);
            }
        }
        let moved = |(a, v): (&Around, &Vector3)| {
            if a.faces == 0 {
                return *v;
            }
            let n = a.edges as f32;
            let smooth = (a.face_sum / a.faces as f32 + a.edge_sum / n + *v * (n - 2.0)) / n;
            let sharp = match a.sharp.count {
                _ if a.sharp.is_corner(a.faces) => *v,
                0 | 1 => return smooth,
                _ => *v * 0.75 + a.sharp.ends * 0.125,
            };
            let sharpness = a.sharp.sum / a.sharp.count as f32;
            if sharpness >= 1.0 { sharp } else { smooth + (sharp - smooth) * sharpness }
        };
        around.iter().zip(&self.p).map(moved).collect()
    }
}

/// The sharp edges around a vertex.
#[derive(Clone, Copy, Default)]
pub(super) struct Sharp {
    pub(super) count: u32,
    sum: f32,
    pub(super) ends: Vector3,
}

impl Sharp {
    pub(super) fn add(&mut self, sharpness: f32, end: Vector3) {
        if sharpness > 0.0 {
            self.count += 1;
            self.sum += sharpness;
            self.ends += end;
        }
    }

    /// Whether a vertex of so many faces stays where it is.
    pub(super) fn is_corner(&self, faces: u32) -> bool {
        self.count > 2 || (faces == 1 && self.count == 2)
    }
}

/// The attributes of a mesh that belong to vertices.
fn vertex_attributes(mesh: &Mesh) -> impl Iterator<Item = &Attribute> {
    mesh.attributes.iter().filter(|attribute| attribute.domain == AttributeDomain::Vertex)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The surface of the cube [-1, 1]³, of six quadrilaterals.
    fn cube() -> Mesh {
        let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(|b| b as f32 * 2.0 - 1.0);
        let mut mesh = Mesh { positions: (0..8).map(corner).collect(), ..Mesh::default() };
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            mesh.add_face(&face);
        }
        mesh
    }

    fn grid(n: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..(n + 1) * (n + 1) {
            mesh.positions.push([(i % (n + 1)) as f32, (i / (n + 1)) as f32, 0.0]);
            mesh.uvs.push([(i % (n + 1)) as f32 / n as f32, (i / (n + 1)) as f32 / n as f32]);
        }
        for j in 0..n {
            for a in (0..n).map(|i| j * (n + 1) + i) {
                mesh.add_face(&[a, a + 1, a + n + 2, a + n + 1]);
            }
        }
        mesh
    }

    #[test]
    fn a_cube_becomes_round() {
        let mesh = subdivide(&cube(), 3, &[]);
        assert_eq!(mesh.indices.len(), 6 * 64 * 2);
        assert_eq!(mesh.positions.len(), 6 * 64 + 2, "Euler");
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            let (p, n) = (Vector3::from(*p), Vector3::from(*n));
            assert!((n.length() - 1.0).abs() < 1e-4 && p.normalized().dot(n) > 0.9, "{p:?} {n:?}");
        }
        // A vertex of valence 3 goes to (9 v + 4 Σ edges + Σ faces) / 24, here to half of it.
        let corner = Vector3::from(mesh.positions[0]);
        assert!((corner + Vector3::splat(0.5)).length() < 1e-5, "{corner:?}");
    }

    /// The limit does not depend on the level.
    #[test]
    fn vertices_stay_on_the_limit_surface() {
        let (coarse, fine) = (subdivide(&cube(), 1, &[]), subdivide(&cube(), 4, &[]));
        for i in 0..coarse.positions.len() {
            let near = fine.positions.iter().zip(&fine.normals).map(|(p, n)| {
                let d = (Vector3::from(*p) - Vector3::from(coarse.positions[i])).length();
                (d, (Vector3::from(*n) - Vector3::from(coarse.normals[i])).length())
            });
            let (d, n) = near.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            assert!(d < 1e-5 && n < 1e-3, "{i}: {d} {n}");
        }
    }

    /// Where all is regular the surface is a bicubic B-spline: x² at the knots goes to x² + 1/3.
    #[test]
    fn regular_pieces_are_splines() {
        let mut bowl = grid(6);
        bowl.positions.iter_mut().for_each(|p| p[2] = (p[0] - 3.0) * (p[0] - 3.0));
        let mesh = subdivide(&bowl, 2, &[]);
        let inside = |p: &&[f32; 3]| p[0] > 1.0 && p[0] < 5.0 && p[1] > 1.0 && p[1] < 5.0;
        let mut count = 0;
        for (p, n) in mesh.positions.iter().zip(&mesh.normals).filter(|(p, _)| inside(p)) {
            let x = p[0] - 3.0;
            assert!((p[2] - (x * x + 1.0 / 3.0)).abs() < 1e-4, "{p:?}");
            let expected = Vector3::new(-2.0 * x, 0.0, 1.0).normalized();
            assert!((Vector3::from(*n) - expected).length() < 1e-3, "{p:?} {n:?}");
            count += 1;
        }
        assert!(count > 100);
    }

    #[test]
    fn flat_pieces_keep_their_corners_and_coordinates() {
        let mesh = subdivide(&grid(2), 3, &[]);
        assert!(mesh.positions.iter().all(|p| p[2] == 0.0));
        assert!(mesh.normals.iter().all(|n| n[2] > 0.999), "{:?}", mesh.normals);
        assert!(mesh.positions.contains(&[2.0, 2.0, 0.0]), "corners stay");
        assert!(mesh.uvs.iter().flatten().all(|t| (0.0..=1.0).contains(t)));
    }

    #[test]
    fn a_cube_with_sharp_edges_stays_a_cube() {
        let pairs = [
            [0u32, 1],
            [2, 3],
            [4, 5],
            [6, 7],
            [0, 2],
            [1, 3],
            [4, 6],
            [5, 7],
            [0, 4],
            [1, 5],
            [2, 6],
            [3, 7],
        ];
        let sharp = subdivide(&cube(), 3, &pairs.map(|e| (e, f32::INFINITY)));
        for (p, n) in sharp.positions.iter().zip(&sharp.normals) {
            let far = p.iter().fold(0.0_f32, |m, x| m.max(x.abs()));
            assert!((far - 1.0).abs() < 1e-5, "{p:?}");
            assert!(n.iter().any(|x| x.abs() > 0.999), "{p:?} {n:?}");
        }
        // Half-sharp edges lie between.
        let half = subdivide(&cube(), 3, &pairs.map(|e| (e, 1.5)));
        let corner = -half.positions[0][0];
        assert!(corner > 0.6 && corner < 0.99, "{corner}");
    }

    #[test]
    fn what_is_no_surface_does_no_harm() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
        let indices = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 0, 1], [4, 4, 4], [1, 0, 3], [2, 1, 0]];
        let mesh = subdivide(&Mesh { positions, indices, ..Mesh::default() }, 2, &[]);
        assert_eq!(mesh.check(), Ok(()));
        assert!(mesh.positions.iter().chain(&mesh.normals).flatten().all(|x| x.is_finite()));
    }
}
