//! OpenEXR, by the `exr` crate: one part, scan lines, ZIP.

use std::io::{Cursor, Seek, Write};
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, ReadChannels, ReadLayers, Text,
    WritableImage, f16,
};

use crate::codec::Precision;
use crate::{Image, ImageError, ImageLimits};

pub(super) fn write(
    image: &Image,
    precision: Precision,
    out: &mut (impl Write + Seek),
) -> Result<(), ImageError> {
    let n = image.channels().len();
    let channels = image.channels().iter().enumerate().map(|(c, name)| {
        let values = image.data().iter().skip(c).step_by(n);
        let samples = match precision {
            Precision::Float => FlatSamples::F32(values.copied().collect()),
            Precision::Half => {
                FlatSamples::F16(values.map(|&x| f16::from_f32(x.clamp(-65504.0, 65504.0))).collect())
            }
        };
        AnyChannel::new(name.as_str(), samples)
    });
    let mut attributes =
        LayerAttributes { software_name: Some(Text::from("Aureole")), ..LayerAttributes::default() };
    for (key, value) in &image.metadata {
        let value = exr::meta::attribute::AttributeValue::Text(Text::from(value.as_str()));
        attributes.other.insert(Text::from(format!("aureole:{key}").as_str()), value);
    }
    let layer = Layer::new(
        (image.width(), image.height()),
        attributes,
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.collect()),
    );
    exr::prelude::Image::from_layer(layer)
        .write()
        .to_buffered(out)
        .map_err(|error| ImageError::Encode { message: error.to_string() })
}

pub(super) fn read(path: &Path, bytes: &[u8], limits: &ImageLimits) -> Result<Image, ImageError> {
    let bad = |message: String| ImageError::Decode { path: path.to_owned(), message };
    // Sizes are checked on the header alone, before pixels take memory.
    let meta =
        exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), true).map_err(|e| bad(e.to_string()))?;
    for header in &meta.headers {
        limits.check(header.layer_size.width() as u64, header.layer_size.height() as u64)?;
    }
    let decoded = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| bad(e.to_string()))?;
    let first = decoded.layer_data.first().ok_or_else(|| bad("it has no layers".into()))?;
    let size = first.size;
    let mut planes: Vec<(String, Vec<f32>)> = Vec::new();
    for layer in decoded.layer_data.iter().filter(|layer| layer.size == size) {
        // The first part keeps its channels' names; further parts carry theirs before them.
        let prefix = match &layer.attributes.layer_name {
            Some(name) if !planes.is_empty() => format!("{name}."),
            _ => String::new(),
        };
        for channel in &layer.channel_data.list {
            let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
            if values.len() == size.area() {
                planes.push((format!("{prefix}{}", channel.name), values));
            }
        }
    }
    let mut data = vec![0.0; size.area() * planes.len()];
    for (c, (_, values)) in planes.iter().enumerate() {
        for (i, &value) in values.iter().enumerate() {
            data[i * planes.len() + c] = value;
        }
    }
    let names = planes.into_iter().map(|(name, _)| name).collect();
    Image::from_data(size.width(), size.height(), names, data)
        .filter(|image| !image.data().is_empty())
        .ok_or_else(|| bad("it has no pixels".into()))
}
