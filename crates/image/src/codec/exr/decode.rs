//! Reading EXR: any parts, channels and number types, each at its place in the common window.

use std::io::Cursor;

use exr::block::reader::Reader;
use exr::block::{UncompressedBlock, read};
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::f16;
use rayon::prelude::*;

use super::attributes;
use crate::ImageLimits;
use crate::error::Fault;
use crate::image::Window;
use crate::raster::{Raster, Texels};

/// Blocks that are decompressed at a time: enough to keep the threads busy, few enough to bound the memory.
const BATCH: usize = 64;

pub(in super::super) fn decode(bytes: &[u8], limits: &ImageLimits) -> Result<Raster, Fault> {
    let reader = read(Cursor::new(bytes), false).map_err(Fault::content)?;
    let plan = Plan::new(reader.headers(), bytes.len(), limits)?;
    let mut texels = plan.texels();
    each_block(reader, |header, block| match &mut texels {
        Texels::Halves(data) => plan.place(header, block, data, Half::from_sample),
        Texels::Floats(data) => plan.place(header, block, data, f32::from_sample),
        Texels::Bytes(_) | Texels::Words(_) => Ok(()),
    })?;
    Ok(plan.finish(texels, bytes))
}

/// Unpacks a file's blocks of full resolution and hands them on in the file's order.
pub(super) fn each_block(
    reader: Reader<Cursor<&[u8]>>,
    mut take: impl FnMut(&Header, &UncompressedBlock) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let meta = reader.meta_data().clone();
    let chunks: Vec<_> = reader
        .filter_chunks(false, |_, tile, _| tile.is_largest_resolution_level())
        .map_err(Fault::content)?
        .collect::<Result<_, _>>()
        .map_err(Fault::content)?;
    let mut chunks = chunks.into_iter();
    loop {
        let batch: Vec<_> = chunks.by_ref().take(BATCH).collect();
        if batch.is_empty() {
            return Ok(());
        }
        // The crate's own parallel reader would abort the process where a decoder panics.
        let blocks: Vec<UncompressedBlock> = batch
            .into_par_iter()
            .map(|chunk| UncompressedBlock::decompress_chunk(chunk, &meta, false))
            .collect::<Result<_, _>>()
            .map_err(Fault::content)?;
        for block in &blocks {
            let header = meta.headers.get(block.index.layer).ok_or_else(|| Fault::content("wrong part"))?;
            take(header, block)?;
        }
    }
}

/// Where every part's channels go in the interleaved image.
struct Plan {
    width: usize,
    height: usize,
    window: Option<Window>,
    names: Vec<String>,
    all_half: bool,
    parts: Vec<Part>,
}

/// One part of the file.
struct Part {
    /// Its data window's corner within the image.
    x: usize,
    y: usize,
    /// For each of its channels the place within a pixel; `None` for a name that was there before.
    slots: Vec<Option<usize>>,
}

impl Plan {
    fn new(headers: &[Header], file_size: usize, limits: &ImageLimits) -> Result<Self, Fault> {
        let first = headers.first().ok_or_else(|| Fault::content("it has no parts"))?;
        for header in headers {
            if header.deep {
                return Err(Fault::content("deep data is not supported"));
            }
            if header.channels.list.iter().any(|channel| (channel.sampling.0, channel.sampling.1) != (1, 1)) {
                return Err(Fault::content(
                    "channels of lower resolution than the picture are not supported",
                ));
            }
            // Every chunk has an eight-byte offset in a table.
            if header.chunk_count > file_size / 8 {
                return Err(Fault::content("it is too short for its number of blocks"));
            }
        }
        let bounds = Bounds::around(headers);
        let channel_count = headers.iter().map(|header| header.channels.list.len() as u64).sum();
        limits.check(bounds.width(), bounds.height(), channel_count, 4)?;

        let names = ordered_names(headers);
        let parts = headers.iter().enumerate().map(|(index, header)| {
            let position = header.own_attributes.layer_position;
            let slot = |i: usize| names.iter().position(|(_, from)| *from == (index, i));
            Part {
                x: (i64::from(position.0) - bounds.min.0) as usize,
                y: (i64::from(position.1) - bounds.min.1) as usize,
                slots: (0..header.channels.list.len()).map(slot).collect(),
            }
        });
        let parts = parts.collect();
        let samples = headers.iter().flat_map(|header| &header.channels.list);
        Ok(Self {
            width: bounds.width() as usize,
            height: bounds.height() as usize,
            window: bounds.window(first),
            all_half: samples.map(|channel| channel.sample_type).all(|kind| kind == SampleType::F16),
            names: names.into_iter().map(|(name, _)| name).collect(),
            parts,
        })
    }

    fn texels(&self) -> Texels {
        let size = self.width * self.height * self.names.len();
        if self.all_half { Texels::Halves(vec![f16::ZERO; size]) } else { Texels::Floats(vec![0.0; size]) }
    }

    /// Copies a block's lines to their places.
    fn place<T>(
        &self,
        header: &Header,
        block: &UncompressedBlock,
        data: &mut [T],
        convert: impl Fn(SampleType, &[u8]) -> T,
    ) -> Result<(), Fault> {
        let (part, stride) = (&self.parts[block.index.layer], self.names.len());
        for line in block.lines(&header.channels) {
            let at = line.location;
            let Some(slot) = part.slots[at.channel] else { continue };
            let kind = header.channels.list[at.channel].sample_type;
            let start = ((part.y + at.position.1) * self.width + part.x + at.position.0) * stride + slot;
            let target = data.get_mut(start..).ok_or_else(|| Fault::content("a block lies outside"))?;
            let samples = line.value.chunks_exact(kind.bytes_per_sample());
            for (to, sample) in target.iter_mut().step_by(stride).zip(samples) {
                *to = convert(kind, sample);
            }
        }
        Ok(())
    }

    fn finish(self, texels: Texels, file: &[u8]) -> Raster {
        Raster {
            width: self.width,
            height: self.height,
            channels: self.names,
            texels,
            metadata: attributes::read(file),
            window: self.window,
        }
    }
}

/// A number that samples of any type can become.
trait FromSample {
    /// `sample` has as many bytes as its type, in this machine's order.
    fn from_sample(kind: SampleType, sample: &[u8]) -> Self;
}

type Half = f16;

impl FromSample for f32 {
    fn from_sample(kind: SampleType, sample: &[u8]) -> Self {
        match (kind, sample) {
            (SampleType::F16, &[a, b]) => f16::from_ne_bytes([a, b]).to_f32(),
            (SampleType::F32, &[a, b, c, d]) => Self::from_ne_bytes([a, b, c, d]),
            // Exact up to 2^24, which is where ids should stay.
            (SampleType::U32, &[a, b, c, d]) => u32::from_ne_bytes([a, b, c, d]) as Self,
            _ => 0.0,
        }
    }
}

impl FromSample for f16 {
    fn from_sample(_: SampleType, sample: &[u8]) -> Self {
        if let &[a, b] = sample { Self::from_ne_bytes([a, b]) } else { Self::ZERO }
    }
}

/// The smallest rectangle around all parts' data windows; `max` is beyond the last pixel.
struct Bounds {
    min: (i64, i64),
    max: (i64, i64),
}

impl Bounds {
    fn around(headers: &[Header]) -> Self {
        let mut bounds = Self { min: (i64::MAX, i64::MAX), max: (i64::MIN, i64::MIN) };
        for header in headers {
            let (corner, size) = (header.own_attributes.layer_position, header.layer_size);
            let (x, y) = (i64::from(corner.0), i64::from(corner.1));
            bounds.min = (bounds.min.0.min(x), bounds.min.1.min(y));
            bounds.max = (bounds.max.0.max(x + size.0 as i64), bounds.max.1.max(y + size.1 as i64));
        }
        bounds
    }

    fn width(&self) -> u64 {
        self.max.0.abs_diff(self.min.0)
    }

    fn height(&self) -> u64 {
        self.max.1.abs_diff(self.min.1)
    }

    /// Where the pixels lie in the display window, unless they fill it.
    fn window(&self, header: &Header) -> Option<Window> {
        let display = header.shared_attributes.display_window;
        let (x, y) = (self.min.0 - i64::from(display.position.0), self.min.1 - i64::from(display.position.1));
        let window = Window {
            x: i32::try_from(x).ok()?,
            y: i32::try_from(y).ok()?,
            full_width: display.size.0,
            full_height: display.size.1,
        };
        let fills =
            (x, y, self.width(), self.height()) == (0, 0, display.size.0 as u64, display.size.1 as u64);
        (!fills).then_some(window)
    }
}

/// All channels' names with (part, channel) of each: those without a layer first, layers by name, and R G B A in this order.
///
/// Channels of the second and further parts get the part's name in front, unless they bear it already.
fn ordered_names(headers: &[Header]) -> Vec<(String, (usize, usize))> {
    let mut names = Vec::new();
    for (index, header) in headers.iter().enumerate() {
        let part = header.own_attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
        for (i, channel) in header.channels.list.iter().enumerate() {
            let name = String::from_utf8_lossy(channel.name.bytes()).into_owned();
            let bears_it = name.strip_prefix(&part).is_some_and(|rest| rest.starts_with('.'));
            let plain = index == 0 || part.is_empty() || bears_it;
            names.push((if plain { name } else { format!("{part}.{name}") }, (index, i)));
        }
    }
    names.sort_by_cached_key(|(name, from)| {
        let (layer, component) = name.rsplit_once('.').unwrap_or(("", name));
        let rank = ["R", "G", "B", "A"].iter().position(|&c| c == component).unwrap_or(4);
        (layer.to_owned(), rank, component.to_owned(), *from)
    });
    names.dedup_by(|later, first| later.0 == first.0);
    names
}
