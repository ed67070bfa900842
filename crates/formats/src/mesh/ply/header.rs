//! The header: elements and their properties.

use crate::mesh::MeshError;
use crate::mesh::lines::without_mark;

/// How numbers are written after the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// What stands for one where a quantity is written in this type: the largest whole number.
    pub(super) fn full(self) -> f32 {
        match self {
            Self::I8 => i8::MAX.into(),
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX.into(),
            Self::U16 => u16::MAX.into(),
            Self::I32 => i32::MAX as f32,
            Self::U32 => u32::MAX as f32,
            Self::F32 | Self::F64 => 1.0,
        }
    }

    /// Bytes of a binary number.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A property of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A table: `count` rows of properties.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The fewest bytes that a row can have.
    pub(super) fn min_row_size(&self, encoding: Encoding) -> usize {
        let binary = |property: &Property| match property.kind {
            Kind::One(scalar) => scalar.size(),
            Kind::List { count, .. } => count.size(),
        };
        match encoding {
            // A digit and a space each.
            Encoding::Ascii => 2 * self.properties.len(),
            _ => self.properties.iter().map(binary).sum(),
        }
    }
}

/// A parsed header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Pictures that comments name (`comment TextureFile`), as MeshLab and scanning programs do.
    pub(super) pictures: Vec<String>,
    /// Lines of the header, so that messages about an ascii body can count on.
    pub(super) lines: usize,
}

impl Header {
    /// Parses the header; gives the bytes after it too.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), MeshError> {
        let bytes = without_mark(bytes);
        if !bytes.starts_with(b"ply") {
            return Err(MeshError::content("not a PLY file: it does not start with `ply`"));
        }
        let end_of_line = end_of_lines(bytes);
        let (mut rest, mut lines) = (bytes, 0);
        let (mut encoding, mut elements, mut pictures) = (None, Vec::new(), Vec::new());
        while let Some(line) = take_line(&mut rest, end_of_line) {
            lines += 1;
            let wrong = |message: String| MeshError::content(format!("line {lines}: {message}"));
            let line = String::from_utf8_lossy(line);
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words.as_slice() {
                ["comment", word, _, ..] if word.eq_ignore_ascii_case("TextureFile") => {
                    let name = line.split_once(word).map_or("", |(_, name)| name.trim());
                    pictures.push(name.to_owned());
                }
                [] | ["ply" | "comment" | "obj_info", ..] => {}
                ["format", word, ..] => encoding = Some(parse_encoding(word).map_err(wrong)?),
                ["element", name, count] => elements.push(parse_element(name, count).map_err(wrong)?),
                ["property", rest @ ..] => {
                    let property = parse_property(rest)
                        .ok_or_else(|| wrong(format!("cannot understand property `{}`", rest.join(" "))))?;
                    let element = elements.last_mut();
                    element
                        .ok_or_else(|| wrong("property before the first element".into()))?
                        .properties
                        .push(property);
                }
                ["end_header"] => {
                    let encoding = encoding.ok_or_else(|| wrong("no `format` in the header".into()))?;
                    return Ok((Self { encoding, elements, pictures, lines }, rest));
                }
                _ => return Err(wrong(format!("cannot understand `{line}` in the header"))),
            }
        }
        Err(MeshError::content("the header does not end: `end_header` is missing"))
    }
}

/// What ends the lines of a header: a newline, or a carriage return where the first line ends in one alone.
///
/// Bytes may follow the last line that look like the other half of a line end.
fn end_of_lines(bytes: &[u8]) -> u8 {
    let first = bytes.iter().position(|&b| b == b'\n' || b == b'\r').map_or(&[][..], |end| &bytes[end..]);
    if first.starts_with(b"\r") && !first.starts_with(b"\r\n") { b'\r' } else { b'\n' }
}

/// The bytes up to the next end of a line, without the carriage return before a newline.
fn take_line<'a>(rest: &mut &'a [u8], end_of_line: u8) -> Option<&'a [u8]> {
    let end = rest.iter().position(|&b| b == end_of_line)?;
    let line = &rest[..end];
    *rest = &rest[end + 1..];
    Some(line.strip_suffix(b"\r").unwrap_or(line))
}

fn parse_encoding(word: &str) -> Result<Encoding, String> {
    match word {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!("unknown encoding `{word}`")),
    }
}

fn parse_element(name: &str, count: &str) -> Result<Element, String> {
    let count = count.parse().map_err(|_| format!("`{count}` is not a number of elements"))?;
    Ok(Element { name: name.to_owned(), count, properties: Vec::new() })
}

fn parse_property(words: &[&str]) -> Option<Property> {
    let (name, kind) = match words {
        ["list", count, item, name] => {
            (name, Kind::List { count: Scalar::parse(count)?, item: Scalar::parse(item)? })
        }
        [scalar, name] => (name, Kind::One(Scalar::parse(scalar)?)),
        _ => return None,
    };
    Some(Property { name: (*name).to_owned(), kind })
}
