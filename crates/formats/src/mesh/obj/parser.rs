//! The lines of an OBJ file.

use std::borrow::Cow;

use aureole_desc::Limits;

use super::Split;
use super::part::{Corner, MISSING, Part, PartBuilder, Pools};
use crate::mesh::MeshError;
use crate::mesh::error::check_count;

/// A parsed OBJ file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjFile {
    /// The parts that have faces.
    pub parts: Vec<Part>,
    /// Material libraries, as named in the file.
    pub libraries: Vec<String>,
}

impl ObjFile {
    /// Parses a file's content.
    ///
    /// # Errors
    /// A malformed line or an index that points nowhere, with the line's number.
    pub fn parse(bytes: &[u8], split: Split, limits: &Limits) -> Result<Self, MeshError> {
        let bytes = join_continued_lines(bytes);
        let mut parser = Parser { split, ..Parser::default() };
        let mut triangles = 0;
        for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
            let in_line = |message: String| MeshError::content(format!("line {}: {message}", number + 1));
            triangles += parser.line(line).map_err(in_line)?;
            check_count("triangles", triangles as u64, limits)?;
        }
        check_count("vertices", parser.pools.positions.len() as u64, limits)?;
        Ok(parser.finish())
    }
}

/// A backslash at the end of a line continues it on the next.
fn join_continued_lines(bytes: &[u8]) -> Cow<'_, [u8]> {
    let continued = |pair: &[u8]| pair == b"\\\n" || pair == b"\\\r";
    if !bytes.windows(2).any(continued) {
        return Cow::Borrowed(bytes);
    }
    let mut joined = bytes.to_vec();
    for i in 1..joined.len() {
        let line_end = joined[i] == b'\n' || (joined[i] == b'\r' && joined.get(i + 1) == Some(&b'\n'));
        if joined[i - 1] == b'\\' && line_end {
            let end = if joined[i] == b'\r' { i + 1 } else { i };
            joined[i - 1..=end].fill(b' ');
        }
    }
    Cow::Owned(joined)
}

#[derive(Debug, Default)]
struct Parser {
    split: Split,
    pools: Pools,
    done: Vec<PartBuilder>,
    current: PartBuilder,
    libraries: Vec<String>,
    face: Vec<Corner>,
}

impl Parser {
    /// Takes a line in; gives the number of triangles it adds.
    fn line(&mut self, line: &[u8]) -> Result<usize, String> {
        let (keyword, rest) = split_word(line);
        match keyword {
            b"v" => self.vertex(rest)?,
            b"vt" => self.pools.uvs.push(texture_coordinates(rest)?),
            b"vn" => self.pools.normals.push(numbers(rest)?),
            b"f" | b"fo" => {
                let before = self.current.triangles();
                self.face(rest)?;
                return Ok(self.current.triangles() - before);
            }
            b"o" | b"g" if self.split == Split::Parts => {
                let material = self.current.material.clone();
                self.start_part(text(rest), material);
            }
            b"usemtl" if self.split == Split::Parts => {
                let name = self.current.name.clone();
                self.start_part(name, Some(text(rest)));
            }
            b"mtllib" => self.libraries.push(text(rest)),
            _ => {}
        }
        Ok(0)
    }

    /// A position, and the colour that some programs write behind it.
    fn vertex(&mut self, rest: &[u8]) -> Result<(), String> {
        let pools = &mut self.pools;
        pools.positions.push(numbers(rest)?);
        let color = numbers::<6>(rest).ok().map(|[_, _, _, r, g, b]| [r, g, b]);
        if color.is_some() || !pools.colors.is_empty() {
            pools.colors.resize(pools.positions.len() - 1, [1.0; 3]);
            pools.colors.push(color.unwrap_or([1.0; 3]));
        }
        Ok(())
    }

    fn start_part(&mut self, name: String, material: Option<String>) {
        if self.current.is_empty() {
            (self.current.name, self.current.material) = (name, material);
        } else {
            self.done.push(std::mem::replace(&mut self.current, PartBuilder::new(name, material)));
        }
    }

    fn face(&mut self, mut rest: &[u8]) -> Result<(), String> {
        let counts = [self.pools.positions.len(), self.pools.uvs.len(), self.pools.normals.len()];
        self.face.clear();
        loop {
            rest = rest.trim_ascii_start();
            if rest.is_empty() || rest[0] == b'#' {
                break;
            }
            let (corner, after) = corner(rest, counts)?;
            self.face.push(corner);
            rest = after;
        }
        if self.face.len() < 3 {
            return Err(format!("a face needs three corners, this one has {}", self.face.len()));
        }
        self.current.add_face(&self.face);
        Ok(())
    }

    fn finish(mut self) -> ObjFile {
        self.done.push(self.current);
        let pools = &self.pools;
        let parts =
            self.done.into_iter().filter(|part| !part.is_empty()).map(|part| part.finish(pools)).collect();
        ObjFile { parts, libraries: self.libraries }
    }
}

/// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn corner(mut rest: &[u8], counts: [usize; 3]) -> Result<(Corner, &[u8]), String> {
    let mut corner = [MISSING; 3];
    for field in 0..3 {
        if let Some((index, after)) = integer(rest) {
            corner[field] = resolve(index, counts[field], field)?;
            rest = after;
        }
        match rest.first() {
            Some(b'/') if field < 2 => rest = &rest[1..],
            _ => break,
        }
    }
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace);
    if !ends || corner[0] == MISSING {
        let word = rest.split(u8::is_ascii_whitespace).next().unwrap_or(rest);
        return Err(format!("cannot understand `{}` in a face", String::from_utf8_lossy(word)));
    }
    Ok((corner, rest))
}

/// Turns an index that counts from one, or from the end, into one that counts from zero.
fn resolve(index: i64, count: usize, field: usize) -> Result<u32, String> {
    let found = if index < 0 { index + count as i64 } else { index - 1 };
    if (0..count as i64).contains(&found) {
        return Ok(found as u32);
    }
    let what = ["vertices", "texture coordinates", "normals"][field];
    Err(format!("index {index} points outside of the {count} {what} so far"))
}

fn integer(bytes: &[u8]) -> Option<(i64, &[u8])> {
    let negative = bytes.first() == Some(&b'-');
    let digits = if negative { &bytes[1..] } else { bytes };
    let length = digits.iter().take_while(|b| b.is_ascii_digit()).count();
    if length == 0 {
        return None;
    }
    // Saturation is enough: an index that long is refused by its caller.
    let value = digits[..length]
        .iter()
        .fold(0i64, |sum, b| sum.saturating_mul(10).saturating_add(i64::from(b - b'0')));
    Some((if negative { -value } else { value }, &digits[length..]))
}

/// The first word of a line and what follows it.
fn split_word(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii_start();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    line.split_at(end)
}

fn text(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest.trim_ascii()).into_owned()
}

fn number(rest: &mut &[u8]) -> Option<f32> {
    *rest = rest.trim_ascii_start();
    let (value, length) = fast_float2::parse_partial(*rest).ok()?;
    *rest = &rest[length..];
    Some(value)
}

fn numbers<const N: usize>(mut rest: &[u8]) -> Result<[f32; N], String> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = number(&mut rest).ok_or_else(|| format!("{N} numbers expected, found `{}`", text(rest)))?;
    }
    Ok(values)
}

/// A texture coordinate may have one, two or three numbers; what is missing is zero.
fn texture_coordinates(mut rest: &[u8]) -> Result<[f32; 2], String> {
    let u = number(&mut rest).ok_or_else(|| format!("a number expected, found `{}`", text(rest)))?;
    Ok([u, number(&mut rest).unwrap_or(0.0)])
}
