//! EXR files as tables of numbers: channels of 32 bits, read and written without the loss of one of them.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::read;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::meta::attribute::{IntegerBounds, LineOrder, SampleType, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{Compression, Vec2};

use super::attributes;
use super::decode::{check, each_block};
use super::steps::Steps;
use crate::error::Fault;
use crate::{ImageError, ImageLimits, Metadata};

/// The numbers of one channel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub enum Plane {
    /// For people and other programs.
    Float(Vec<f32>),
    /// For what must stay exact.
    Uint(Vec<u32>),
}

impl Plane {
    fn len(&self) -> usize {
        match self {
            Self::Float(values) => values.len(),
            Self::Uint(values) => values.len(),
        }
    }
}

/// A table of numbers over pixels, which an EXR file holds exactly.
///
/// Programs that show EXR files see its `R`, `G` and `B`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planes {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Channels by name, each of `width * height` numbers.
    pub channels: BTreeMap<String, Plane>,
    /// Facts about them.
    pub metadata: Metadata,
}

impl Planes {
    /// The bytes of an EXR file.
    ///
    /// # Errors
    /// [`ImageError::Encode`] for what the format cannot hold: no pixels, a channel of another size.
    pub fn encode(&self) -> Result<Vec<u8>, ImageError> {
        let failed = |message: String| ImageError::Encode { message };
        let size = self.width * self.height;
        if size == 0 || self.channels.values().any(|plane| plane.len() != size) {
            return Err(failed("a channel has not as many numbers as there are pixels".into()));
        }
        let channels = self.channels.iter().map(|(name, plane)| {
            let samples = match plane {
                Plane::Float(values) => FlatSamples::F32(values.clone()),
                Plane::Uint(values) => FlatSamples::U32(values.clone()),
            };
            AnyChannel::new(Text::from_slice_unchecked(name.as_bytes()), samples)
        });
        let channels = AnyChannels::sort(channels.collect());
        let size = Vec2(self.width, self.height);
        let mut facts = LayerAttributes::default();
        facts.other.extend(attributes::write(&self.metadata));
        // High words of small sums are all the same: run lengths find that as well as anything, and in no time.
        let encoding = Encoding {
            compression: Compression::RLE,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        };
        let layer = Layer::new(size, facts, encoding, channels);
        let display = IntegerBounds::from_dimensions(size);
        let file = exr::image::Image::new(ImageAttributes::new(display), layer);
        let mut out = Cursor::new(Vec::new());
        file.write()
            .skip_compatibility_checks()
            .to_buffered(&mut out)
            .map_err(|error| failed(error.to_string()))?;
        let mut bytes = out.into_inner();
        attributes::sort(&mut bytes);
        Ok(bytes)
    }

    /// Reads an EXR file of one part; the path is for messages. Channels of half precision are left out.
    ///
    /// # Errors
    /// [`ImageError::Decode`] or [`ImageError::TooLarge`].
    pub fn decode(bytes: &[u8], path: &Path, limits: &ImageLimits) -> Result<Self, ImageError> {
        // A decoder that fails an assertion on a damaged file must not take the program with it.
        let decoded = catch_unwind(AssertUnwindSafe(|| decode(bytes, limits)))
            .unwrap_or_else(|_| Err(Fault::content("its decoder failed")));
        decoded.map_err(|fault| fault.at(path))
    }
}

fn decode(bytes: &[u8], limits: &ImageLimits) -> Result<Planes, Fault> {
    let reader = read(Cursor::new(bytes), false).map_err(Fault::content)?;
    let meta = reader.meta_data().clone();
    let [header] = &meta.headers[..] else { return Err(Fault::content("it has several parts")) };
    check(header, bytes.len(), limits)?;
    let Vec2(width, height) = header.layer_size;
    let mut planes: Vec<Option<Plane>> =
        header.channels.list.iter().map(|channel| empty(channel.sample_type, width * height)).collect();
    let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();

    let mut is_whole = true;
    each_block(reader, &meta, &Steps::default(), |header, block| {
        for line in block.lines(&header.channels) {
            let at = line.location;
            let start = at.position.1 * width + at.position.0;
            let Some(plane) = planes.get_mut(at.channel).and_then(Option::as_mut) else { continue };
            let numbers = line.value.as_chunks().0;
            is_whole &= match plane {
                Plane::Float(values) => fill(values, start, numbers, f32::from_ne_bytes),
                Plane::Uint(values) => fill(values, start, numbers, u32::from_ne_bytes),
            };
        }
    })?;
    if !is_whole {
        return Err(Fault::content("a block lies outside"));
    }
    let channels = names.into_iter().zip(planes).filter_map(|(name, plane)| Some((name, plane?))).collect();
    Ok(Planes { width, height, channels, metadata: attributes::read(bytes) })
}

fn empty(kind: SampleType, size: usize) -> Option<Plane> {
    match kind {
        SampleType::F16 => None,
        SampleType::F32 => Some(Plane::Float(vec![0.0; size])),
        SampleType::U32 => Some(Plane::Uint(vec![0; size])),
    }
}

/// Whether there was room for all numbers.
fn fill<T>(values: &mut [T], start: usize, numbers: &[[u8; 4]], number: impl Fn([u8; 4]) -> T) -> bool {
    let Some(target) = values.get_mut(start..start + numbers.len()) else { return false };
    target.iter_mut().zip(numbers).for_each(|(value, &bytes)| *value = number(bytes));
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_back() {
        let words: Vec<u32> = (0..70 * 33_u32).map(|i| i.wrapping_mul(0x9e37_79b9)).collect();
        let floats = words.iter().map(|&word| word as f32 * 1e-9).collect();
        let mut planes = Planes { width: 70, height: 33, ..Planes::default() };
        planes.channels.insert("R".into(), Plane::Float(floats));
        planes.channels.insert("sum.R.0".into(), Plane::Uint(words));
        planes.metadata.insert("seed".into(), "7".into());
        let bytes = planes.encode().unwrap();
        let back = Planes::decode(&bytes, "a.exr".as_ref(), &ImageLimits::default()).unwrap();
        assert_eq!(back, planes);
        for end in (0..bytes.len()).step_by(97) {
            assert!(Planes::decode(&bytes[..end], "a.exr".as_ref(), &ImageLimits::default()).is_err());
        }
    }
}
