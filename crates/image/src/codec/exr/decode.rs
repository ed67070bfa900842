//! Reading EXR: any parts, channels and number types.
//!
//! The picture is that of the first part that has one, as large as that part's own window. Channels of other parts come
//! along as far as they lie in it.

use std::io::Cursor;

use aureole_spectrum::Primaries;
use exr::block::reader::Reader;
use exr::block::{UncompressedBlock, read};
use exr::meta::MetaData;
use exr::meta::attribute::{ChannelDescription, Chromaticities, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Vec2, f16};
use rayon::prelude::*;

use super::steps::{self, Steps};
use super::{attributes, chroma};
use crate::ImageLimits;
use crate::error::Fault;
use crate::image::Window;
use crate::raster::{Raster, Texels};

/// Blocks that are decompressed at a time: enough to keep the threads busy, few enough to bound the memory.
const BATCH: usize = 64;

pub(in super::super) fn decode(bytes: &[u8], limits: &ImageLimits) -> Result<Raster, Fault> {
    let (whole, steps) = steps::hide(bytes)?;
    let reader = read(Cursor::new(&*whole), false).map_err(Fault::content)?;
    let mut meta = reader.meta_data().clone();
    steps.restore(&mut meta.headers)?;
    let plan = Plan::new(&meta.headers, bytes.len(), limits)?;
    let mut texels = plan.texels();
    each_block(reader, &meta, &steps, |header, block| match &mut texels {
        Texels::Halves(data) => plan.place(header, block, data, Half::from_sample),
        Texels::Floats(data) => plan.place(header, block, data, f32::from_sample),
        Texels::Bytes(_) | Texels::Words(_) => {}
    })?;
    Ok(plan.finish(texels, bytes))
}

/// Unpacks a file's blocks of full resolution and hands them on in the file's order. `meta` says what they are.
pub(super) fn each_block(
    reader: Reader<Cursor<&[u8]>>,
    meta: &MetaData,
    steps: &Steps,
    mut take: impl FnMut(&Header, &UncompressedBlock),
) -> Result<(), Fault> {
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
            .map(|chunk| {
                let meta = steps.of_block(meta, &chunk)?;
                UncompressedBlock::decompress_chunk(chunk, &meta, false).map_err(Fault::content)
            })
            .collect::<Result<_, _>>()?;
        for block in &blocks {
            let header = meta.headers.get(block.index.layer).ok_or_else(|| Fault::content("wrong part"))?;
            take(header, block);
        }
    }
}

/// One line of one channel in a block.
struct Line<'a> {
    channel: usize,
    /// The first sample's place in its part's window.
    x: usize,
    y: usize,
    samples: &'a [u8],
}

/// The lines of a block in their order. Those of channels of lower resolution are where their coordinates in the whole
/// picture are multiples of the channel's steps.
fn lines<'a>(header: &'a Header, block: &'a UncompressedBlock) -> impl Iterator<Item = Line<'a>> {
    let (corner, size) = (block.index.pixel_position, block.index.pixel_size);
    let origin = header.own_attributes.layer_position;
    let rows = corner.1..corner.1 + size.1;
    let places = rows.flat_map(move |y| (0..header.channels.list.len()).map(move |channel| (y, channel)));
    let mut rest = &block.data[..];
    places.filter_map(move |(y, channel)| {
        let about = &header.channels.list[channel];
        let absolute = i64::from(origin.1) + y as i64;
        if absolute.rem_euclid(about.sampling.1 as i64) != 0 {
            return None;
        }
        let bytes = size.0 / about.sampling.0 * about.sample_type.bytes_per_sample();
        let (samples, after) = rest.split_at_checked(bytes)?;
        rest = after;
        Some(Line { channel, x: corner.0, y, samples })
    })
}

/// Where every part's channels go in the interleaved image.
struct Plan {
    width: usize,
    height: usize,
    window: Option<Window>,
    names: Vec<String>,
    all_half: bool,
    parts: Vec<Part>,
    primaries: Option<Primaries>,
}

/// One part of the file.
struct Part {
    /// Its data window's corner as seen from the picture's.
    x: i64,
    y: i64,
    /// For each of its channels the place within a pixel; `None` for a name that was there before.
    slots: Vec<Option<usize>>,
}

impl Plan {
    fn new(headers: &[Header], file_size: usize, limits: &ImageLimits) -> Result<Self, Fault> {
        for header in headers {
            check(header, file_size, limits)?;
        }
        let main_index = headers.iter().position(has_picture).unwrap_or(0);
        let main = headers.get(main_index).ok_or_else(|| Fault::content("it has no parts"))?;
        let (width, height) = (main.layer_size.0, main.layer_size.1);
        let channel_count = headers.iter().map(|header| header.channels.list.len() as u64).sum();
        limits.check(width as u64, height as u64, channel_count, 4)?;

        let names = ordered_names(headers, main_index);
        let corner = main.own_attributes.layer_position;
        let parts = headers.iter().enumerate().map(|(index, header)| {
            let position = header.own_attributes.layer_position;
            let slot = |i: usize| names.iter().position(|(_, from)| *from == (index, i));
            Part {
                x: i64::from(position.0) - i64::from(corner.0),
                y: i64::from(position.1) - i64::from(corner.1),
                slots: (0..header.channels.list.len()).map(slot).collect(),
            }
        });
        let parts = parts.collect();
        let mut channels = headers.iter().flat_map(|header| &header.channels.list);
        let is_plain_half = |channel: &ChannelDescription| {
            channel.sample_type == SampleType::F16 && channel.sampling == Vec2(1, 1)
        };
        Ok(Self {
            width,
            height,
            window: window(main),
            all_half: channels.all(is_plain_half),
            names: names.into_iter().map(|(name, _)| name).collect(),
            parts,
            primaries: main.shared_attributes.chromaticities.map(primaries),
        })
    }

    fn texels(&self) -> Texels {
        let size = self.width * self.height * self.names.len();
        if self.all_half { Texels::Halves(vec![f16::ZERO; size]) } else { Texels::Floats(vec![0.0; size]) }
    }

    /// Copies a block's lines to their places. A sample of a channel of lower resolution stands for the pixels up to the next.
    fn place<T: Copy>(
        &self,
        header: &Header,
        block: &UncompressedBlock,
        data: &mut [T],
        convert: impl Fn(SampleType, &[u8]) -> T,
    ) {
        let (part, stride) = (&self.parts[block.index.layer], self.names.len());
        for line in lines(header, block) {
            let Some(slot) = part.slots[line.channel] else { continue };
            let channel = &header.channels.list[line.channel];
            let (kind, step) = (channel.sample_type, channel.sampling);
            let first = part.x + line.x as i64;
            for row in (0..step.1).map(|dy| part.y + (line.y + dy) as i64) {
                let Some(row) = usize::try_from(row).ok().filter(|&row| row < self.height) else { continue };
                let row = &mut data[row * self.width * stride..][..self.width * stride];
                for (i, sample) in line.samples.chunks_exact(kind.bytes_per_sample()).enumerate() {
                    let x = first + (i * step.0) as i64;
                    let columns = x.max(0)..(x + step.0 as i64).min(self.width as i64);
                    columns.for_each(|x| row[x as usize * stride + slot] = convert(kind, sample));
                }
            }
        }
    }

    fn finish(self, texels: Texels, file: &[u8]) -> Raster {
        let mut raster = Raster {
            width: self.width,
            height: self.height,
            channels: self.names,
            texels,
            metadata: attributes::read(file),
            window: self.window,
        };
        chroma::to_rgb(&mut raster, self.primaries.unwrap_or(Primaries::REC709));
        if let Some(primaries) = self.primaries {
            raster.convert_primaries(primaries);
        }
        raster
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

/// Checks what a header asks for, before memory is taken for it.
pub(super) fn check(header: &Header, file_size: usize, limits: &ImageLimits) -> Result<(), Fault> {
    if header.deep {
        return Err(Fault::content("deep data is not supported"));
    }
    // Every chunk has an eight-byte offset in a table.
    if header.chunk_count > file_size / 8 {
        return Err(Fault::content("it is too short for its number of blocks"));
    }
    let (width, height) = (header.layer_size.0 as u64, header.layer_size.1 as u64);
    limits.check(width, height, header.channels.list.len() as u64, 4).map(drop)
}

/// Whether a part has a picture of its own, in colour or grey.
fn has_picture(header: &Header) -> bool {
    let has = |name: &str| header.channels.list.iter().any(|channel| channel.name.eq(name));
    has("Y") || ["R", "G", "B"].into_iter().all(has)
}

/// Where a part lies in the display window, unless it fills it.
fn window(header: &Header) -> Option<Window> {
    let display = header.shared_attributes.display_window;
    let (corner, size) = (header.own_attributes.layer_position, header.layer_size);
    let window = Window {
        x: corner.0.checked_sub(display.position.0)?,
        y: corner.1.checked_sub(display.position.1)?,
        full_width: display.size.0,
        full_height: display.size.1,
    };
    let fills = (window.x, window.y, size) == (0, 0, display.size);
    (!fills).then_some(window)
}

fn primaries(given: Chromaticities) -> Primaries {
    let place = |v: Vec2<f32>| [f64::from(v.0), f64::from(v.1)];
    Primaries { colors: [given.red, given.green, given.blue].map(place), white: place(given.white) }
}

/// All channels' names with (part, channel) of each: those without a layer first, layers by name, and R G B A in this order.
///
/// Channels of other parts than the picture's get their part's name in front, unless they bear it already.
fn ordered_names(headers: &[Header], main: usize) -> Vec<(String, (usize, usize))> {
    let mut names = Vec::new();
    for (index, header) in headers.iter().enumerate() {
        let part = header.own_attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
        for (i, channel) in header.channels.list.iter().enumerate() {
            let name = String::from_utf8_lossy(channel.name.bytes()).into_owned();
            let bears_it = name.strip_prefix(&part).is_some_and(|rest| rest.starts_with('.'));
            let plain = index == main || part.is_empty() || bears_it;
            names.push((if plain { name } else { format!("{part}.{name}") }, (index, i)));
        }
    }
    names.sort_by_cached_key(|(name, from)| {
        let (layer, component) = name.rsplit_once('.').unwrap_or(("", name));
        let rank = ["R", "G", "B", "A"].iter().position(|&c| c == component).unwrap_or(4);
        // Of one name the picture's part comes first.
        (layer.to_owned(), rank, component.to_owned(), from.0 != main, *from)
    });
    names.dedup_by(|later, first| later.0 == first.0);
    names
}
