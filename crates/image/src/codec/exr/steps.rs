//! Channels of lower resolution, which have a sample every few pixels only.
//!
//! The `exr` crate unpacks their blocks but refuses their headers. So it is shown a header in which all channels are whole, and
//! is told of the true steps where it unpacks.

use std::borrow::Cow;

use exr::block::chunk::Chunk;
use exr::meta::MetaData;
use exr::meta::attribute::ChannelDescription;
use exr::meta::header::Header;
use exr::prelude::Vec2;

use super::attributes;
use crate::error::Fault;

/// Pixels from one sample to the next, across and down, for each channel of the first part; none where all channels are whole.
#[derive(Debug, Default)]
pub(super) struct Steps(Vec<Vec2<usize>>);

/// The file with channels that are whole, and what steps they have.
pub(super) fn hide(file: &[u8]) -> Result<(Cow<'_, [u8]>, Steps), Fault> {
    let list = attributes::channel_list(file).unwrap_or_default();
    let mut steps = Vec::new();
    let mut at = list.start;
    let mut places = Vec::new();
    // A name and its end, a type, a flag and three bytes that mean nothing, and the steps.
    let name_length = |at: usize| file.get(at..list.end)?.iter().position(|&b| b == 0);
    while let Some(length) = name_length(at).filter(|&length| length > 0) {
        let place = at + length + 1 + 8;
        let Some(&[x, y]) = file.get(place..place + 8).map(|bytes| bytes.as_chunks().0) else { break };
        let [x, y] = [x, y].map(|bytes| u32::from_le_bytes(bytes) as usize);
        if x == 0 || y == 0 || 4 % x != 0 || 4 % y != 0 {
            return Err(Fault::content(format!(
                "a channel with every {x}th by {y}th sample is not supported"
            )));
        }
        steps.push(Vec2(x, y));
        places.push(place);
        at = place + 8;
    }
    if steps.iter().all(|&step| step == Vec2(1, 1)) {
        return Ok((Cow::Borrowed(file), Steps::default()));
    }
    let mut whole = file.to_vec();
    for place in places {
        whole[place..place + 8].copy_from_slice(&[1, 0, 0, 0, 1, 0, 0, 0]);
    }
    Ok((Cow::Owned(whole), Steps(steps)))
}

impl Steps {
    /// Puts the steps back into the header.
    pub(super) fn restore(&self, headers: &mut [Header]) -> Result<(), Fault> {
        let (false, Some(header)) = (self.0.is_empty(), headers.first_mut()) else { return Ok(()) };
        let (corner, size) = (header.own_attributes.layer_position, header.layer_size);
        for (channel, &step) in header.channels.list.iter_mut().zip(&self.0) {
            let fits = size.0 % step.0 == 0 && size.1 % step.1 == 0;
            if !fits || corner.0 % step.0 as i32 != 0 || corner.1 % step.1 as i32 != 0 {
                return Err(Fault::content("its window does not fit the steps of its channels"));
            }
            channel.sampling = step;
        }
        Ok(())
    }

    /// What the crate has to be told for it to expect as many bytes of a block as there are: only some lines have samples of
    /// all channels.
    pub(super) fn of_block<'a>(&self, meta: &'a MetaData, chunk: &Chunk) -> Result<Cow<'a, MetaData>, Fault> {
        if self.0.is_empty() || chunk.layer_index != 0 {
            return Ok(Cow::Borrowed(meta));
        }
        let mut own = meta.clone();
        let header = own.headers.first_mut().ok_or_else(|| Fault::content("wrong part"))?;
        let place = header.get_block_data_indices(&chunk.compressed_block).map_err(Fault::content)?;
        let bounds = header.get_absolute_block_pixel_coordinates(place).map_err(Fault::content)?;
        let (first, size) = (bounds.position.1 + header.own_attributes.layer_position.1, bounds.size);
        let bytes_of = |channel: &ChannelDescription| {
            let step = channel.sampling;
            let lines = (0..size.1).filter(|&y| (first + y as i32).rem_euclid(step.1 as i32) == 0).count();
            lines * (size.0 / step.0) * channel.sample_type.bytes_per_sample()
        };
        let bytes: usize = header.channels.list.iter().map(bytes_of).sum();
        if !bytes.is_multiple_of(size.area()) {
            return Err(Fault::content("channels of such lower resolutions are not supported"));
        }
        header.channels.bytes_per_pixel = bytes / size.area();
        Ok(Cow::Owned(own))
    }
}
