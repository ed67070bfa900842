//! The image plane of a scene: its size and the part of it that is rendered.

use aureole_desc::{Limits, Node, SceneDesc, SceneError, Span};
use aureole_elements::FilmSpec;
use aureole_spectrum::{Spectrum, xyz_from_srgb};

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Crop {
    /// The rectangle with a border around it, within another one.
    pub fn grown(&self, [bx, by]: [u32; 2], within: &Self) -> Self {
        let axis = |start: u32, size: u32, border: u32, from: u32, whole: u32| {
            let first = start.saturating_sub(border).max(from);
            let end = start.saturating_add(size).saturating_add(border).min(from.saturating_add(whole));
            (first, end.saturating_sub(first))
        };
        let (x, width) = axis(self.x, self.width, bx, within.x, within.width);
        let (y, height) = axis(self.y, self.height, by, within.y, within.height);
        Self { x, y, width, height }
    }
}

/// What the picture's channels are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colors {
    /// Red, green, blue: linear Rec. 709.
    #[default]
    Rgb,
    /// Luminance alone.
    Luminance,
    /// CIE X, Y, Z.
    Xyz,
}

/// Resolution and crop, and what a pixel is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// The whole image.
    pub full: FilmSpec,
    /// What is rendered of it.
    pub crop: Crop,
    /// How many pixels beside its own a sample adds to, in each direction; none where samples belong to one pixel.
    pub border: [u32; 2],
    /// What the picture's channels are.
    pub colors: Colors,
    /// Whether it has a channel that says where it is covered.
    pub has_alpha: bool,
    /// What the image is multiplied by: how sensitive the film is.
    pub gain: f32,
    /// Samples with a channel above this, after the gain, are scaled down to it; infinite for none.
    pub max_component: f32,
    /// What the channels are that this counts for.
    pub max_component_of: Colors,
}

impl Film {
    /// An uncropped film.
    pub fn new(width: u32, height: u32) -> Self {
        let crop = Crop { x: 0, y: 0, width, height };
        Self {
            full: FilmSpec { width, height },
            crop,
            border: [0; 2],
            colors: Colors::Rgb,
            has_alpha: false,
            gain: 1.0,
            max_component: f32::INFINITY,
            max_component_of: Colors::Rgb,
        }
    }

    /// The pixels that samples are drawn for: the crop, and those around it whose samples reach into it.
    pub fn area(&self) -> Crop {
        self.crop.grown(self.border, &Crop { x: 0, y: 0, width: self.full.width, height: self.full.height })
    }

    /// A sample as the film takes it: no brighter than its limit, which counts after the gain.
    #[inline]
    pub fn limited(&self, radiance: Spectrum) -> Spectrum {
        if self.max_component == f32::INFINITY {
            return radiance;
        }
        let [x, y, z] = match self.max_component_of {
            Colors::Rgb => radiance.rgb(),
            Colors::Luminance => [xyz_from_srgb(radiance.rgb())[1]; 3],
            Colors::Xyz => xyz_from_srgb(radiance.rgb()),
        };
        let brightest = x.max(y).max(z) * self.gain;
        if brightest > self.max_component { radiance * (self.max_component / brightest) } else { radiance }
    }

    /// The film of a description, without compiling it.
    ///
    /// # Errors
    /// Sizes that are wrong or beyond the limits.
    pub fn of(desc: &SceneDesc, limits: &Limits) -> Result<Self, SceneError> {
        Self::from_node(desc.film.map(|id| &desc[id]), limits)
    }

    /// Reads a `film` node; 256 x 256 without one.
    pub(crate) fn from_node(node: Option<&Node>, limits: &Limits) -> Result<Self, SceneError> {
        let Some(node) = node else { return Ok(Self::new(256, 256)) };
        let mut params = node.params.clone();
        let mut size = |name: &str, default: i64| params.int_in(name, default, 1, 1 << 20).map(|n| n as u32);
        let (width, height) = (size("width", 256)?, size("height", 256)?);
        let mut film = Self::new(width, height);
        if ["crop_x", "crop_y", "crop_width", "crop_height"].iter().any(|name| params.has(name)) {
            let x = params.int_in("crop_x", 0, 0, i64::from(width) - 1)? as u32;
            let y = params.int_in("crop_y", 0, 0, i64::from(height) - 1)? as u32;
            let rest = |whole: u32, start: u32| i64::from(whole - start);
            film.crop = Crop {
                x,
                y,
                width: params.int_in("crop_width", rest(width, x), 1, rest(width, x))? as u32,
                height: params.int_in("crop_height", rest(height, y), 1, rest(height, y))? as u32,
            };
        }
        (film.colors, film.has_alpha) = params.one_of(
            "pixel_format",
            &[
                ("rgb", (Colors::Rgb, false)),
                ("rgba", (Colors::Rgb, true)),
                ("luminance", (Colors::Luminance, false)),
                ("luminance_alpha", (Colors::Luminance, true)),
                ("xyz", (Colors::Xyz, false)),
                ("xyza", (Colors::Xyz, true)),
            ],
        )?;
        film.gain = params.float_in("gain", 1.0, 0.0, 1e6)?;
        if params.has("max_component") {
            film.max_component = params.float_in("max_component", 0.0, 0.0, f32::INFINITY)?;
            film.max_component_of =
                params.one_of("max_component_of", &[("rgb", Colors::Rgb), ("xyz", Colors::Xyz)])?;
        }
        film.check(limits, node.span)?;
        Ok(film)
    }

    fn check(&self, limits: &Limits, at: Span) -> Result<(), SceneError> {
        let found = u64::from(self.crop.width) * u64::from(self.crop.height);
        if found <= limits.max_pixels {
            return Ok(());
        }
        Err(SceneError::Limit {
            what: "the image's number of pixels".into(),
            found,
            limit: limits.max_pixels,
            name: Some("max-pixels"),
            at,
        })
    }
}
