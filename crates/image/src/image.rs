//! Images as renders produce them: floats in named channels.

use std::borrow::Cow;
use std::collections::BTreeSet;

use aureole_spectrum::{luminance, srgb_from_xyz};

use crate::{ImageError, Metadata};

/// Where an image's pixels lie in the whole picture that they are part of (EXR's data and display windows).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Column of the image's left edge in the whole picture.
    pub x: i32,
    /// Row of the image's top edge in the whole picture.
    pub y: i32,
    /// Pixels across of the whole picture.
    pub full_width: usize,
    /// Pixels down of the whole picture.
    pub full_height: usize,
}

/// Linear pixels in named channels, interleaved, rows from top to bottom.
///
/// `R`, `G`, `B` and `A` are the picture: linear Rec. 709, multiplied by alpha; a lone `Y` is a grey one. Other
/// channels are layers such as `albedo.R` or `Z`.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    channels: Vec<String>,
    data: Vec<f32>,
    /// Facts about the image, written where the format has a place for them.
    pub metadata: Metadata,
    /// The place of a crop in its whole picture; `None` where the image is the whole.
    pub window: Option<Window>,
}

impl Image {
    /// A black image.
    ///
    /// The names must differ from each other; the caller answers for a size that fits into memory (files are
    /// checked against [`crate::ImageLimits`]).
    pub fn new(width: usize, height: usize, channels: &[&str]) -> Self {
        let channels: Vec<String> = channels.iter().map(|&name| name.to_owned()).collect();
        debug_assert!(all_differ(&channels), "channels must have different names: {channels:?}");
        let data = vec![0.0; width * height * channels.len()];
        Self { width, height, channels, data, metadata: Metadata::new(), window: None }
    }

    /// An image from interleaved data; `None` when the lengths do not match, there are no pixels, or two channels have one name.
    pub fn from_data(width: usize, height: usize, channels: Vec<String>, data: Vec<f32>) -> Option<Self> {
        let size = width.checked_mul(height)?.checked_mul(channels.len())?;
        let usable = size > 0 && size == data.len() && all_differ(&channels);
        usable.then(|| Self { width, height, channels, data, metadata: Metadata::new(), window: None })
    }

    /// A colour image (`R`, `G`, `B`) from its pixels; `None` when their number is not `width * height`.
    pub fn from_rgb(width: usize, height: usize, pixels: &[[f32; 3]]) -> Option<Self> {
        let channels = ["R", "G", "B"].map(str::to_owned).to_vec();
        Self::from_data(width, height, channels, pixels.as_flattened().to_vec())
    }

    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The channels' names, in the order of a pixel's values.
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// All values, interleaved.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// All values, interleaved.
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

    /// All pixels in order, each a slice of its channels.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.data.chunks_exact(self.channels.len().max(1))
    }

    /// The place of a channel within a pixel.
    pub fn channel(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|channel| channel == name)
    }

    /// The image with its picture in linear Rec. 709, where that is in CIE XYZ (channels `X`, `Y`, `Z` and none of `R`, `G`, `B`).
    pub fn in_rgb(&self) -> Cow<'_, Self> {
        let has_rgb = ["R", "G", "B"].iter().any(|name| self.channel(name).is_some());
        let [Some(x), Some(y), Some(z)] = ["X", "Y", "Z"].map(|name| self.channel(name)) else {
            return Cow::Borrowed(self);
        };
        if has_rgb {
            return Cow::Borrowed(self);
        }
        let mut image = self.clone();
        for (place, name) in [x, y, z].into_iter().zip(["R", "G", "B"]) {
            name.clone_into(&mut image.channels[place]);
        }
        for pixel in image.data.chunks_exact_mut(self.channels.len()) {
            [pixel[x], pixel[y], pixel[z]] = srgb_from_xyz([pixel[x], pixel[y], pixel[z]]);
        }
        Cow::Owned(image)
    }

    /// Where the picture's red, green and blue are: `R`, `G`, `B`, or one grey channel three times (`Y`, or else the first).
    pub fn rgb_channels(&self) -> [usize; 3] {
        match ["R", "G", "B"].map(|name| self.channel(name)) {
            [Some(r), Some(g), Some(b)] => [r, g, b],
            _ => [self.channel("Y").unwrap_or(0); 3],
        }
    }

    /// Whether the picture has no colour: one grey channel in place of `R`, `G`, `B`.
    pub fn is_grey(&self) -> bool {
        let [r, g, _] = self.rgb_channels();
        r == g
    }

    /// The picture's colour at a pixel. For whole images [`to_rgb`](Self::to_rgb) is faster.
    pub fn rgb(&self, x: usize, y: usize) -> [f32; 3] {
        let pixel = self.pixel(x, y);
        self.rgb_channels().map(|c| pixel[c])
    }

    /// The picture alone, three values a pixel.
    pub fn to_rgb(&self) -> Vec<[f32; 3]> {
        let rgb = self.rgb_channels();
        self.pixels().map(|pixel| rgb.map(|c| pixel[c])).collect()
    }

    /// Luminance of every pixel.
    pub fn to_luminance(&self) -> Vec<f32> {
        let rgb = self.rgb_channels();
        self.pixels().map(|pixel| luminance(rgb.map(|c| pixel[c]))).collect()
    }

    /// One channel of every pixel.
    pub fn plane(&self, channel: usize) -> impl ExactSizeIterator<Item = f32> {
        self.pixels().map(move |pixel| pixel[channel])
    }

    /// Opacity of every pixel, if there is an `A` channel.
    pub fn alpha(&self) -> Option<Vec<f32>> {
        self.channel("A").map(|a| self.plane(a).collect())
    }

    /// The channels `layer.R`, `layer.G` ... as an image of their own (`R`, `G` ...); `None` if there are none.
    pub fn layer(&self, layer: &str) -> Option<Self> {
        let member = |name: &String| {
            name.strip_prefix(layer).and_then(|rest| rest.strip_prefix('.')).map(str::to_owned)
        };
        let (indices, channels): (Vec<usize>, Vec<String>) =
            self.channels.iter().enumerate().filter_map(|(i, name)| Some((i, member(name)?))).unzip();
        let data = self.pixels().flat_map(|pixel| indices.iter().map(|&i| pixel[i])).collect();
        let image = Self::from_data(self.width, self.height, channels, data)?;
        Some(Self { window: self.window, ..image })
    }

    /// Adds all channels of another image, each name after `prefix`.
    ///
    /// # Errors
    /// [`ImageError::Mismatch`] if the sizes differ or a name is taken.
    pub fn append(&mut self, prefix: &str, other: &Self) -> Result<(), ImageError> {
        self.check_same_size(other)?;
        let names = other.channels.iter().map(|name| format!("{prefix}{name}"));
        let channels: Vec<String> = self.channels.iter().cloned().chain(names).collect();
        if !all_differ(&channels) {
            return Err(ImageError::Mismatch(format!("a channel of `{prefix}` is already in the image")));
        }
        self.data = self.pixels().zip(other.pixels()).flat_map(|(a, b)| a.iter().chain(b)).copied().collect();
        self.channels = channels;
        Ok(())
    }

    /// How many values are NaN or infinite.
    pub fn count_non_finite(&self) -> usize {
        self.data.iter().filter(|value| !value.is_finite()).count()
    }

    /// Checks that two images can be compared pixel by pixel.
    pub(crate) fn check_same_size(&self, other: &Self) -> Result<(), ImageError> {
        if self.data.is_empty() || other.data.is_empty() {
            return Err(ImageError::Mismatch("an image without pixels cannot be compared".into()));
        }
        if (self.width, self.height) == (other.width, other.height) {
            return Ok(());
        }
        Err(ImageError::Mismatch(format!(
            "the images differ in size: {} x {} and {} x {} pixels",
            self.width, self.height, other.width, other.height
        )))
    }
}

fn all_differ(names: &[String]) -> bool {
    names.iter().collect::<BTreeSet<_>>().len() == names.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_found_by_name() {
        let mut image = Image::new(2, 2, &["B", "G", "R", "A", "albedo.R"]);
        image.pixel_mut(1, 0).copy_from_slice(&[3.0, 2.0, 1.0, 0.5, 0.25]);
        assert_eq!(image.rgb(1, 0), [1.0, 2.0, 3.0]);
        assert_eq!(image.to_rgb()[1], [1.0, 2.0, 3.0]);
        assert_eq!(image.alpha().unwrap()[1], 0.5);
        assert_eq!(image.layer("albedo").unwrap().channels(), ["R"]);
        assert!(image.layer("alb").is_none());
    }

    #[test]
    fn a_lone_luminance_is_grey() {
        let image = Image::from_data(1, 1, vec!["Z".into(), "Y".into()], vec![9.0, 0.5]).unwrap();
        assert!(image.is_grey());
        assert_eq!(image.rgb(0, 0), [0.5; 3]);
    }

    #[test]
    fn wrong_data_is_refused() {
        let names = |n: &[&str]| n.iter().map(|&x| x.to_owned()).collect::<Vec<_>>();
        assert!(Image::from_data(2, 2, names(&["R"]), vec![0.0; 3]).is_none());
        assert!(Image::from_data(1, 1, names(&["R", "R"]), vec![0.0; 2]).is_none());
        assert!(Image::from_data(usize::MAX, 2, names(&["R"]), vec![]).is_none());
        assert!(Image::from_data(0, 0, names(&["R"]), vec![]).is_none());
    }

    #[test]
    fn layers_are_appended() {
        let mut image = Image::from_rgb(1, 1, &[[1.0, 2.0, 3.0]]).unwrap();
        let albedo = Image::from_rgb(1, 1, &[[4.0, 5.0, 6.0]]).unwrap();
        image.append("albedo.", &albedo).unwrap();
        assert_eq!(image.pixel(0, 0), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(image.layer("albedo").unwrap().to_rgb(), albedo.to_rgb());
        assert!(image.append("albedo.", &albedo).is_err());
        assert!(image.append("b.", &Image::new(2, 1, &["R"])).is_err());
    }
}
