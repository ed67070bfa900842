//! Images as renders produce them: floats in named channels.

use std::collections::BTreeMap;

/// Linear pixels in named channels, interleaved, rows from top to bottom.
///
/// `R`, `G`, `B` and `A` are the picture; other channels are layers such as `albedo.R` or `Z`.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    channels: Vec<String>,
    data: Vec<f32>,
    /// Facts about the image, written where the format has a place for them.
    pub metadata: BTreeMap<String, String>,
}

impl Image {
    /// A black image.
    pub fn new(width: usize, height: usize, channels: &[&str]) -> Self {
        let channels: Vec<String> = channels.iter().map(|c| (*c).to_owned()).collect();
        let data = vec![0.0; width * height * channels.len()];
        Self { width, height, channels, data, metadata: BTreeMap::new() }
    }

    /// An image from interleaved data; `None` when the lengths do not match.
    pub fn from_data(width: usize, height: usize, channels: Vec<String>, data: Vec<f32>) -> Option<Self> {
        let matches = width.checked_mul(height)?.checked_mul(channels.len())? == data.len();
        matches.then(|| Self { width, height, channels, data, metadata: BTreeMap::new() })
    }

    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The channels' names.
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// All values.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// All values.
    pub fn data_mut(&mut self) -> &mut [f32] {
        &mut self.data
    }

    /// All channels of a pixel.
    pub fn pixel(&self, x: usize, y: usize) -> &[f32] {
        let n = self.channels.len();
        let start = (y * self.width + x) * n;
        &self.data[start..start + n]
    }

    /// All channels of a pixel.
    pub fn pixel_mut(&mut self, x: usize, y: usize) -> &mut [f32] {
        let n = self.channels.len();
        let start = (y * self.width + x) * n;
        &mut self.data[start..start + n]
    }

    /// The place of a channel within a pixel.
    pub fn channel(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|c| c == name)
    }

    /// Where the picture's red, green and blue are: `R`, `G`, `B`, or one luminance channel three times.
    pub fn rgb_channels(&self) -> [usize; 3] {
        match ["R", "G", "B"].map(|name| self.channel(name)) {
            [Some(r), Some(g), Some(b)] => [r, g, b],
            _ => [self.channel("Y").unwrap_or(0); 3],
        }
    }

    /// The picture alone, three values a pixel.
    pub fn to_rgb(&self) -> Vec<[f32; 3]> {
        let rgb = self.rgb_channels();
        self.data.chunks_exact(self.channels.len()).map(|pixel| rgb.map(|c| pixel[c])).collect()
    }

    /// Opacity of every pixel, if there is an `A` channel.
    pub fn alpha(&self) -> Option<Vec<f32>> {
        let a = self.channel("A")?;
        Some(self.data.chunks_exact(self.channels.len()).map(|pixel| pixel[a]).collect())
    }
}
