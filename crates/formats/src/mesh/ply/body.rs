//! The rows after the header.

use aureole_desc::{Limits, Mesh};

use super::header::{Element, Encoding, Header, Kind, Scalar};
use super::layout::{Layout, Target};
use crate::mesh::MeshError;
use crate::mesh::error::check_count;

/// A stream of numbers.
trait Numbers {
    /// The next number.
    fn next(&mut self, scalar: Scalar) -> Option<f64>;
    /// Bytes that are left.
    fn left(&self) -> usize;
    /// Where the stream is, for messages.
    fn place(&self) -> String;
}

/// Reads all elements.
pub(super) fn read(header: &Header, body: &[u8], limits: &Limits) -> Result<Mesh, MeshError> {
    match header.encoding {
        Encoding::Ascii => {
            read_elements(header, Ascii { all: body, rest: body, header_lines: header.lines }, limits)
        }
        Encoding::LittleEndian => read_elements(header, Binary::<false> { rest: body }, limits),
        Encoding::BigEndian => read_elements(header, Binary::<true> { rest: body }, limits),
    }
}

fn read_elements(header: &Header, mut numbers: impl Numbers, limits: &Limits) -> Result<Mesh, MeshError> {
    let mut mesh = Mesh::default();
    for element in &header.elements {
        check_fits(element, header.encoding, &numbers)?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut numbers, &mut mesh, limits)?,
            "face" => read_faces(element, &mut numbers, &mut mesh, limits)?,
            _ if element.properties.is_empty() => {}
            _ => (0..element.count).try_for_each(|_| skip_row(element, &mut numbers))?,
        }
    }
    Ok(mesh)
}

/// Columns of the first element by their names, row by row; what comes after it is left alone.
pub(super) fn columns(
    header: &Header,
    body: &[u8],
    names: &[&str],
    limits: &Limits,
) -> Result<Vec<f32>, MeshError> {
    match header.encoding {
        Encoding::Ascii => {
            read_columns(header, Ascii { all: body, rest: body, header_lines: header.lines }, names, limits)
        }
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
fn number(numbers: &mut impl Numbers, scalar: Scalar, element: &Element) -> Result<f64, MeshError> {
    numbers.next(scalar).ok_or_else(|| {
        MeshError::content(format!(
            "{}: a number of a {} is missing or unreadable",
            numbers.place(),
            element.name
        ))
    })
}

fn list_length(numbers: &mut impl Numbers, scalar: Scalar, element: &Element) -> Result<usize, MeshError> {
    let length = number(numbers, scalar, element)?;
    if length < 0.0 || length.fract() != 0.0 || length > numbers.left() as f64 {
        return Err(MeshError::content(format!("{}: {length} is no length of a list", numbers.place())));
    }
    Ok(length as usize)
}

fn skip_row(element: &Element, numbers: &mut impl Numbers) -> Result<(), MeshError> {
    element.properties.iter().try_for_each(|property| skip(property.kind, element, numbers))
}

fn skip(kind: Kind, element: &Element, numbers: &mut impl Numbers) -> Result<(), MeshError> {
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
                Target::Corners | Target::Skip => {}
            }
        }
    }
    mesh.attributes.append(&mut layout.attributes);
    Ok(())
}

fn read_faces(
    element: &Element,
    numbers: &mut impl Numbers,
    mesh: &mut Mesh,
    limits: &Limits,
) -> Result<(), MeshError> {
    let mut layout = Layout::of_faces(element);
    let count = check_count("faces", element.count, limits)?;
    if !layout.targets.contains(&Target::Corners) {
        return Err(MeshError::content("faces without a list `vertex_indices`"));
    }
    mesh.indices.reserve_exact(count);
    let mut row = vec![[0.0_f32; 3]; layout.attributes.len()];
    let mut corners: Vec<u32> = Vec::with_capacity(4);
    for _ in 0..count {
        corners.clear();
        for (property, target) in element.properties.iter().zip(&layout.targets) {
            match (property.kind, *target) {
                (Kind::List { count, item }, Target::Corners) => {
                    for _ in 0..list_length(numbers, count, element)? {
                        corners.push(vertex_index(number(numbers, item, element)?, numbers)?);
                    }
                }
                (Kind::One(scalar), Target::Attribute { index, channel, divisor }) => {
                    row[index][channel] = number(numbers, scalar, element)? as f32 / divisor;
                }
                (kind, _) => skip(kind, element, numbers)?,
            }
        }
        // A polygon becomes a fan; each of its triangles has the polygon's attributes.
        for _ in 0..mesh.add_face(&corners) {
            for (attribute, values) in layout.attributes.iter_mut().zip(&row) {
                attribute.data.extend_from_slice(&values[..attribute.channels]);
            }
        }
    }
    check_count("triangles", mesh.indices.len() as u64, limits)?;
    mesh.attributes.append(&mut layout.attributes);
    Ok(())
}

/// An index from a list, whatever type it is written in.
fn vertex_index(value: f64, numbers: &impl Numbers) -> Result<u32, MeshError> {
    let index = value as u32;
    if f64::from(index) != value {
        return Err(MeshError::content(format!("{}: {value} is no index of a vertex", numbers.place())));
    }
    Ok(index)
}

/// Numbers as text.
struct Ascii<'a> {
    all: &'a [u8],
    rest: &'a [u8],
    header_lines: usize,
}

impl Numbers for Ascii<'_> {
    #[inline]
    fn next(&mut self, _scalar: Scalar) -> Option<f64> {
        self.rest = self.rest.trim_ascii_start();
        let (value, length) = fast_float2::parse_partial(self.rest).ok()?;
        self.rest = &self.rest[length..];
        let ends = self.rest.first().is_none_or(u8::is_ascii_whitespace);
        ends.then_some(value)
    }

    fn left(&self) -> usize {
        self.rest.len()
    }

    fn place(&self) -> String {
        let read = &self.all[..self.all.len() - self.rest.len()];
        format!("line {}", self.header_lines + 1 + read.iter().filter(|&&b| b == b'\n').count())
    }
}

/// Numbers as bytes.
struct Binary<'a, const BIG: bool> {
    rest: &'a [u8],
}

impl<const BIG: bool> Binary<'_, BIG> {
    #[inline]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&bytes, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(bytes)
    }
}

/// Reads a number of a type in either byte order.
macro_rules! take_number {
    ($self:ident, $ty:ty) => {{
        let bytes = $self.take()?;
        f64::from(if BIG { <$ty>::from_be_bytes(bytes) } else { <$ty>::from_le_bytes(bytes) })
    }};
}

impl<const BIG: bool> Numbers for Binary<'_, BIG> {
    #[inline]
    fn next(&mut self, scalar: Scalar) -> Option<f64> {
        Some(match scalar {
            Scalar::I8 => take_number!(self, i8),
            Scalar::U8 => take_number!(self, u8),
            Scalar::I16 => take_number!(self, i16),
            Scalar::U16 => take_number!(self, u16),
            Scalar::I32 => take_number!(self, i32),
            Scalar::U32 => take_number!(self, u32),
            Scalar::F32 => take_number!(self, f32),
            Scalar::F64 => take_number!(self, f64),
        })
    }

    fn left(&self) -> usize {
        self.rest.len()
    }

    fn place(&self) -> String {
        format!("{} bytes before the end", self.rest.len())
    }
}
