//! The attributes in an EXR file's header.
//!
//! [OpenEXR] "OpenEXR File Layout": after eight bytes of magic and version, records of a name, a type name (both ended by a
//! zero byte), the value's size and the value; an empty name ends the header.

use std::ops::Range;

use exr::meta::attribute::{AttributeValue, Text};

use crate::{Attribute, Metadata};

/// Where the first record starts.
const FIRST_RECORD: usize = 8;

/// Attributes that describe how the file is laid out. They belong to the codec, not to the image.
const LAYOUT: [&str; 15] = [
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "type",
    "name",
    "version",
    "chunkCount",
    "maxSamplesPerPixel",
    "preview",
];

/// One record of the header.
struct Record<'a> {
    name: &'a [u8],
    kind: &'a [u8],
    value: &'a [u8],
    /// All its bytes.
    whole: &'a [u8],
}

/// The record at the start of `bytes`; `None` at the header's end or where the bytes make no sense.
fn record(bytes: &[u8]) -> Option<Record<'_>> {
    let name_end = bytes.iter().position(|&b| b == 0).filter(|&end| end > 0)?;
    let kind_end = name_end + 1 + bytes[name_end + 1..].iter().position(|&b| b == 0)?;
    let start = kind_end + 5;
    let size = u32::from_le_bytes(bytes.get(kind_end + 1..start)?.try_into().ok()?);
    let end = start.checked_add(usize::try_from(size).ok()?)?;
    Some(Record {
        name: &bytes[..name_end],
        kind: &bytes[name_end + 1..kind_end],
        value: bytes.get(start..end)?,
        whole: &bytes[..end],
    })
}

/// The records of the first part's header, in the file's order.
fn records(file: &[u8]) -> impl Iterator<Item = Record<'_>> {
    let mut rest = file.get(FIRST_RECORD..).unwrap_or_default();
    std::iter::from_fn(move || {
        let next = record(rest)?;
        rest = &rest[next.whole.len()..];
        Some(next)
    })
}

/// Where the list of the first part's channels is.
pub(super) fn channel_list(file: &[u8]) -> Option<Range<usize>> {
    let mut end = FIRST_RECORD;
    records(file).find_map(|record| {
        end += record.whole.len();
        (record.name == b"channels").then(|| end - record.value.len()..end)
    })
}

/// The texts, numbers and matrices among a file's attributes.
pub(super) fn read(file: &[u8]) -> Metadata {
    let pairs = records(file).filter_map(|record| {
        let name = String::from_utf8_lossy(record.name).into_owned();
        let value = match record.kind {
            b"string" => Attribute::Text(String::from_utf8_lossy(record.value).into_owned()),
            b"int" => Attribute::Int(i32::from_le_bytes(record.value.try_into().ok()?)),
            b"float" => Attribute::Float(f32::from_le_bytes(record.value.try_into().ok()?)),
            b"m44f" => {
                let rows = record.value.as_chunks().0.iter().map(|&x| f32::from_le_bytes(x));
                Attribute::Matrix(rows.collect::<Vec<_>>().try_into().ok()?)
            }
            _ => return None,
        };
        (!LAYOUT.contains(&name.as_str())).then_some((name, value))
    });
    pairs.collect()
}

/// The attributes to write for an image's facts.
pub(super) fn write(metadata: &Metadata) -> impl Iterator<Item = (Text, AttributeValue)> {
    let text = |s: &str| Text::from_slice_unchecked(s.as_bytes());
    let usable = |name: &str| !name.is_empty() && !name.contains('\0') && !LAYOUT.contains(&name);
    metadata.iter().filter(move |(name, _)| usable(name)).map(move |(name, value)| {
        let value = match value {
            Attribute::Text(value) => AttributeValue::Text(text(value)),
            Attribute::Int(value) => AttributeValue::I32(*value),
            Attribute::Float(value) => AttributeValue::F32(*value),
            Attribute::Matrix(rows) => AttributeValue::Matrix4x4(*rows),
        };
        (text(name), value)
    })
}

/// Sorts the header's records by name, in place.
///
/// The `exr` crate writes free attributes in the random order of a hash table, but one image must always give one file. The
/// order has no meaning in the format, and the header's length does not change.
pub(super) fn sort(file: &mut [u8]) {
    let mut sorted: Vec<_> = records(file).map(|record| (record.name, record.whole)).collect();
    sorted.sort_unstable();
    let header = sorted.into_iter().flat_map(|(_, whole)| whole).copied().collect::<Vec<u8>>();
    file[FIRST_RECORD..][..header.len()].copy_from_slice(&header);
}
