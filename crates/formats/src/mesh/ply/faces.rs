//! Faces and triangle strips.

use aureole_desc::{Limits, Mesh};

use super::body::{Content, list_length, number, skip};
use super::header::{Element, Kind};
use super::layout::{Layout, Target};
use super::numbers::Numbers;
use crate::mesh::MeshError;
use crate::mesh::error::check_count;

pub(super) fn read_faces(
    element: &Element,
    numbers: &mut impl Numbers,
    content: &mut Content,
    limits: &Limits,
) -> Result<(), MeshError> {
    let mut layout = Layout::of_faces(element);
    let count = check_count("faces", element.count, limits)?;
    let has = |target| layout.targets.contains(&target);
    if !has(Target::Corners) {
        return Err(MeshError::content("faces without a list `vertex_indices`"));
    }
    let (has_uvs, has_pictures) = (has(Target::CornerUvs), has(Target::Picture));
    content.mesh.indices.reserve_exact(count);
    let mut row = vec![[0.0_f32; 3]; layout.attributes.len()];
    let mut corners: Vec<u32> = Vec::with_capacity(4);
    let (mut uvs, mut picture): (Vec<f32>, u32) = (Vec::new(), 0);
    for _ in 0..count {
        corners.clear();
        uvs.clear();
        for (property, target) in element.properties.iter().zip(&layout.targets) {
            match (property.kind, *target) {
                (Kind::List { count, item }, Target::Corners) => {
                    for _ in 0..list_length(numbers, count, element)? {
                        corners.push(vertex_index(number(numbers, item, element)?, numbers)?);
                    }
                }
                (Kind::List { count, item }, Target::CornerUvs) => {
                    for _ in 0..list_length(numbers, count, element)? {
                        uvs.push(number(numbers, item, element)? as f32);
                    }
                }
                // None is written as -1.
                (Kind::One(scalar), Target::Picture) => {
                    picture = number(numbers, scalar, element)? as i64 as u32;
                }
                (Kind::One(scalar), Target::Attribute { index, channel, divisor }) => {
                    row[index][channel] = number(numbers, scalar, element)? as f32 / divisor;
                }
                (kind, _) => skip(kind, element, numbers)?,
            }
        }
        let triangles = content.mesh.add_face(&corners);
        if triangles == 0 {
            content.notes.add("a face of fewer than three corners is left out", None);
        }
        // A polygon becomes a fan; each of its triangles has the polygon's attributes.
        for _ in 0..triangles {
            for (attribute, values) in layout.attributes.iter_mut().zip(&row) {
                attribute.data.extend_from_slice(&values[..attribute.channels]);
            }
        }
        if has_uvs {
            content.add_corner_uvs(&uvs, triangles);
        }
        if has_pictures {
            content.picture_of.resize(content.mesh.indices.len(), picture);
        }
    }
    check_count("triangles", content.mesh.indices.len() as u64, limits)?;
    content.mesh.attributes.append(&mut layout.into_attributes());
    Ok(())
}

impl Content {
    /// The texture coordinates of a face that is a fan of so many triangles; not a number where they are too few or too many.
    fn add_corner_uvs(&mut self, uvs: &[f32], triangles: usize) {
        let before = self.mesh.indices.len() - triangles;
        self.corner_uvs.resize(3 * before, [f32::NAN; 2]);
        if uvs.len() != 2 * (triangles + 2) {
            if !uvs.is_empty() && triangles > 0 {
                self.notes
                    .add("a face has not two texture coordinates for each of its corners: it has none", None);
            }
            self.corner_uvs.resize(3 * (before + triangles), [f32::NAN; 2]);
            return;
        }
        let uv = |corner: usize| [uvs[2 * corner], uvs[2 * corner + 1]];
        self.corner_uvs.extend((1..=triangles).flat_map(|i| [uv(0), uv(i), uv(i + 1)]));
    }
}

/// Strips: each vertex makes a triangle with the two before it, every other one turned round; -1 begins a new strip.
pub(super) fn read_strips(
    element: &Element,
    numbers: &mut impl Numbers,
    mesh: &mut Mesh,
    limits: &Limits,
) -> Result<(), MeshError> {
    let layout = Layout::of_faces(element);
    if !layout.targets.contains(&Target::Corners) {
        return Err(MeshError::content(format!("{} without a list `vertex_indices`", element.name)));
    }
    for _ in 0..element.count {
        for (property, target) in element.properties.iter().zip(&layout.targets) {
            match (property.kind, target) {
                (Kind::List { count, item }, Target::Corners) => {
                    let mut strip = Strip::default();
                    for _ in 0..list_length(numbers, count, element)? {
                        strip.add(number(numbers, item, element)?, numbers, mesh)?;
                    }
                    check_count("triangles", mesh.indices.len() as u64, limits)?;
                }
                (kind, _) => skip(kind, element, numbers)?,
            }
        }
    }
    Ok(())
}

/// A strip at work.
#[derive(Default)]
struct Strip {
    last: [u32; 2],
    length: usize,
}

impl Strip {
    fn add(&mut self, index: f64, numbers: &impl Numbers, mesh: &mut Mesh) -> Result<(), MeshError> {
        // What ends a strip is written as -1, which unsigned types hold as their largest number.
        if index == -1.0 || index == f64::from(u32::MAX) {
            self.length = 0;
            return Ok(());
        }
        let index = vertex_index(index, numbers)?;
        let [a, b] = self.last;
        // Triangles without area lead from one row of a strip to the next.
        if self.length >= 2 && a != b && b != index && a != index {
            let triangle = if self.length.is_multiple_of(2) { [a, b, index] } else { [b, a, index] };
            mesh.add_face(&triangle);
        }
        self.last = [b, index];
        self.length += 1;
        Ok(())
    }
}

/// An index from a list, whatever type it is written in.
fn vertex_index(value: f64, numbers: &impl Numbers) -> Result<u32, MeshError> {
    let index = value as u32;
    if f64::from(index) != value {
        return Err(MeshError::content(format!("{}: {value} is no index of a vertex", numbers.place())));
    }
    Ok(index)
}
