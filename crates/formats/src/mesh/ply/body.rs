//! The rows after the header.

use aureole_desc::{Limits, Mesh};

use super::faces::{read_faces, read_strips};
use super::header::{Element, Encoding, Header, Kind, Scalar};
use super::layout::{Layout, Target};
use super::numbers::{Ascii, Binary, Numbers};
use crate::mesh::MeshError;
use crate::mesh::error::check_count;
use crate::mesh::lines::Notes;

/// What the rows say.
#[derive(Debug, Default)]
pub(super) struct Content {
    pub(super) mesh: Mesh,
    /// For the corners of the first triangles, those that have any of their own.
    pub(super) corner_uvs: Vec<[f32; 2]>,
    /// Which of the pictures the first triangles show.
    pub(super) picture_of: Vec<u32>,
    pub(super) notes: Notes,
}

/// Reads all elements.
pub(super) fn read(header: &Header, body: &[u8], limits: &Limits) -> Result<Content, MeshError> {
    match header.encoding {
        Encoding::Ascii => read_elements(header, Ascii::new(body, header.lines), limits),
        Encoding::LittleEndian => read_elements(header, Binary::<false> { rest: body }, limits),
        Encoding::BigEndian => read_elements(header, Binary::<true> { rest: body }, limits),
    }
}

fn read_elements(header: &Header, mut numbers: impl Numbers, limits: &Limits) -> Result<Content, MeshError> {
    let mut content = Content::default();
    for element in &header.elements {
        check_fits(element, header.encoding, &numbers)?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut numbers, &mut content.mesh, limits)?,
            "face" => read_faces(element, &mut numbers, &mut content, limits)?,
            "tristrips" => read_strips(element, &mut numbers, &mut content.mesh, limits)?,
            _ if element.properties.is_empty() || element.count == 0 => {}
            name => {
                let message =
                    format!("the element `{name}` is left out: vertices, faces and triangle strips are read");
                content.notes.add(&message, None);
                (0..element.count).try_for_each(|_| skip_row(element, &mut numbers))?;
            }
        }
    }
    Ok(content)
}

/// Columns of the first element by their names, row by row; what comes after it is left alone.
pub(super) fn columns(
    header: &Header,
    body: &[u8],
    names: &[&str],
    limits: &Limits,
) -> Result<Vec<f32>, MeshError> {
    match header.encoding {
        Encoding::Ascii => read_columns(header, Ascii::new(body, header.lines), names, limits),
        Encoding::LittleEndian => read_columns(header, Binary::<false> { rest: body }, names, limits),
        Encoding::BigEndian => read_columns(header, Binary::<true> { rest: body }, names, limits),
    }
}

fn read_columns(
    header: &Header,
    mut numbers: impl Numbers,
    names: &[&str],
    limits: &Limits,
) -> Result<Vec<f32>, MeshError> {
    let element = header.elements.first().ok_or_else(|| MeshError::content("there are no elements"))?;
    check_fits(element, header.encoding, &numbers)?;
    let place = |name: &&str| {
        let found = element.properties.iter().position(|property| property.name == *name);
        found.ok_or_else(|| MeshError::content(format!("a {} has no `{name}`", element.name)))
    };
    let places = names.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let count = check_count("rows", element.count, limits)?;
    let mut row = vec![0.0; element.properties.len()];
    let mut values = Vec::new();
    for _ in 0..count {
        for (property, value) in element.properties.iter().zip(&mut row) {
            match property.kind {
                Kind::One(scalar) => *value = number(&mut numbers, scalar, element)? as f32,
                kind @ Kind::List { .. } => skip(kind, element, &mut numbers)?,
            }
        }
        values.extend(places.iter().map(|&place| row[place]));
    }
    Ok(values)
}

/// Whether the rows of an element may fit into what is left.
fn check_fits(element: &Element, encoding: Encoding, numbers: &impl Numbers) -> Result<(), MeshError> {
    let row = element.min_row_size(encoding) as u64;
    // The last row of an ascii file needs no newline.
    if element.count.saturating_mul(row) > numbers.left() as u64 + 1 {
        return Err(MeshError::content(format!(
            "{} {} elements cannot fit into the {} bytes that are left",
            element.count,
            element.name,
            numbers.left()
        )));
    }
    Ok(())
}

/// The next number, or an error that says where it is missing.
pub(super) fn number(
    numbers: &mut impl Numbers,
    scalar: Scalar,
    element: &Element,
) -> Result<f64, MeshError> {
    numbers.next(scalar).ok_or_else(|| {
        MeshError::content(format!(
            "{}: a number of a {} is missing or unreadable",
            numbers.place(),
            element.name
        ))
    })
}

pub(super) fn list_length(
    numbers: &mut impl Numbers,
    scalar: Scalar,
    element: &Element,
) -> Result<usize, MeshError> {
    let length = number(numbers, scalar, element)?;
    if length < 0.0 || length.fract() != 0.0 || length > numbers.left() as f64 {
        return Err(MeshError::content(format!("{}: {length} is no length of a list", numbers.place())));
    }
    Ok(length as usize)
}

fn skip_row(element: &Element, numbers: &mut impl Numbers) -> Result<(), MeshError> {
    element.properties.iter().try_for_each(|property| skip(property.kind, element, numbers))
}

pub(super) fn skip(kind: Kind, element: &Element, numbers: &mut impl Numbers) -> Result<(), MeshError> {
    match kind {
        Kind::One(scalar) => number(numbers, scalar, element).map(|_| ()),
        Kind::List { count, item } => {
            let length = list_length(numbers, count, element)?;
            (0..length).try_for_each(|_| number(numbers, item, element).map(|_| ()))
        }
    }
}

fn read_vertices(
    element: &Element,
    numbers: &mut impl Numbers,
    mesh: &mut Mesh,
    limits: &Limits,
) -> Result<(), MeshError> {
    let mut layout = Layout::of_vertices(element);
    let has = |target| layout.targets.contains(&target);
    if !(0..3).all(|i| has(Target::Position(i))) {
        return Err(MeshError::content("vertices without x, y and z"));
    }
    let (normals, uvs) = (has(Target::Normal(0)), has(Target::Uv(0)));
    let count = check_count("vertices", element.count, limits)?;
    mesh.positions = vec![[0.0; 3]; count];
    mesh.normals = vec![[0.0; 3]; if normals { count } else { 0 }];
    mesh.uvs = vec![[0.0; 2]; if uvs { count } else { 0 }];
    for attribute in &mut layout.attributes {
        attribute.data = vec![0.0; count * attribute.channels];
    }
    for i in 0..count {
        for (property, target) in element.properties.iter().zip(&layout.targets) {
            let Kind::One(scalar) = property.kind else {
                skip(property.kind, element, numbers)?;
                continue;
            };
            let value = number(numbers, scalar, element)? as f32;
            match *target {
                Target::Position(axis) => mesh.positions[i][axis] = value,
                Target::Normal(axis) => mesh.normals[i][axis] = value,
                Target::Uv(axis) => mesh.uvs[i][axis] = value,
                Target::Attribute { index, channel, divisor } => {
                    let attribute = &mut layout.attributes[index];
                    attribute.data[i * attribute.channels + channel] = value / divisor;
                }
                _ => {}
            }
        }
    }
    mesh.attributes.append(&mut layout.into_attributes());
    Ok(())
}
