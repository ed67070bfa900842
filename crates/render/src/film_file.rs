//! Films as files: checkpoints, and parts of a render that are merged.
//!
//! A film file is an EXR image that any program shows, with what it takes to go on: `sum.*` are the exact sums of a pixel's
//! weighted samples in words of 32 bits, the lowest first; `count.*` how many samples there are; `layer.*` the sums of other
//! quantities. A cropped film has the pixels around the crop whose samples reach into it. The header's attributes say which
//! samples of which scene they are, and a checksum over everything tells whether the file is whole.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use aureole_image::{Attribute, ImageError, ImageLimits, Metadata, Plane, Planes};
use aureole_scene::{Colors, Crop, Film as FilmShape};

use crate::exact_sum::ExactSum;
use crate::film::{Film, PixelSum};
use crate::fingerprint::{Fingerprint, Hash};

/// The layout of the file; films of another one are refused.
const LAYOUT: &str = "4";
/// The exact sums of a pixel.
const SUMS: [&str; 4] = ["R", "G", "B", "weight"];

/// A film, what it was rendered from, and what is to become of it.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    /// The sums.
    pub film: Film,
    /// What they are samples of.
    pub fingerprint: Fingerprint,
    /// The samples of every pixel that the film is to gather.
    pub samples: Range<u32>,
    /// Samples of every pixel of the whole render, of which these may be a part.
    pub spp: u32,
}

/// A film file that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// The file cannot be read, or is no EXR file.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// An image, but no film.
    #[error("it is no film: {0}")]
    NotAFilm(String),
    /// Some bits are not those that were written.
    #[error("it is damaged: its checksum is wrong")]
    Checksum,
    /// Written by another version of the program.
    #[error("it was written by another version (layout {0}, here {LAYOUT})")]
    Layout(String),
}

impl FilmFile {
    /// Whether the film has all that it is to gather.
    pub fn is_complete(&self) -> bool {
        self.film.drawn() == [self.samples.len() as u32; 2]
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// [`ImageError::Encode`].
    pub fn encode(&self) -> Result<Vec<u8>, ImageError> {
        let shape
        @ FilmShape { full, crop, border, colors, has_alpha, gain, max_component, max_component_of } =
            self.film.shape();
        let area = shape.area();
        let mut planes = Planes {
            width: area.width as usize,
            height: area.height as usize,
            channels: channels(&self.film),
            metadata: Metadata::new(),
        };
        let mut fact = |name: &str, value: String| {
            planes.metadata.insert(format!("aureole.{name}"), value.into());
        };
        fact("layout", LAYOUT.to_owned());
        fact("film", format!("{} {} {} {}", full.width, full.height, area.x, area.y));
        fact("crop", format!("{} {} {} {}", crop.x, crop.y, crop.width, crop.height));
        fact("border", format!("{} {}", border[0], border[1]));
        fact("image", format!("{} {}", kind_of_image(colors, has_alpha), gain.to_bits()));
        fact("limit", format!("{} {}", max_component.to_bits(), max_component_of as u32));
        fact("layers", self.film.layer_names().join("\n"));
        fact("samples", format!("{} {}", self.samples.start, self.samples.end));
        fact("spp", self.spp.to_string());
        fact("fingerprint", self.fingerprint.to_text());
        let checksum = checksum(&planes);
        planes.metadata.insert("aureole.checksum".into(), checksum.into());
        planes.encode()
    }

    /// Reads a file's bytes; the path is for messages.
    ///
    /// # Errors
    /// A [`FilmError`] for anything but a whole film. No number of the file is believed before the file is known to be large
    /// enough for it.
    pub fn decode(bytes: &[u8], path: &Path, limits: &ImageLimits) -> Result<Self, FilmError> {
        let mut planes = Planes::decode(bytes, path, limits)?;
        check_layout(&planes)?;
        let wanted = text(&planes.metadata, "checksum")?.to_owned();
        planes.metadata.remove("aureole.checksum");
        if checksum(&planes) != wanted {
            return Err(FilmError::Checksum);
        }
        Self::from_planes(&planes)
    }

    /// The film that numbers and facts stand for, whatever their checksum.
    ///
    /// # Errors
    /// A [`FilmError`] where they do not make a film.
    pub fn from_planes(planes: &Planes) -> Result<Self, FilmError> {
        check_layout(planes)?;
        let [full_width, full_height, x, y] = numbers(&planes.metadata, "film")?;
        let [start, end] = numbers(&planes.metadata, "samples")?;
        let [spp] = numbers(&planes.metadata, "spp")?;
        let [width, height] = [planes.width, planes.height].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        let fits = |start: u32, size: u32, whole: u32| {
            size > 0 && start.checked_add(size).is_some_and(|end| end <= whole)
        };
        if !(fits(x, width, full_width) && fits(y, height, full_height) && start < end && end <= spp) {
            return Err(FilmError::NotAFilm("its sizes contradict each other".into()));
        }
        let area = Crop { x, y, width, height };
        let shape = shape(&planes.metadata, full_width, full_height)?;
        if shape.area() != area {
            return Err(FilmError::NotAFilm("its sizes contradict each other".into()));
        }
        let names = text(&planes.metadata, "layers")?.lines().map(str::to_owned).collect();
        let film = film(check_names(names)?, shape, start, &planes.channels)?;
        if film.pixels.iter().any(|pixel| pixel.dropped > pixel.drawn || pixel.drawn > end - start) {
            return Err(FilmError::NotAFilm("its counts contradict each other".into()));
        }
        let fingerprint = Fingerprint::from_text(text(&planes.metadata, "fingerprint")?);
        Ok(Self { film, fingerprint, samples: start..end, spp })
    }
}

const COLORS: [Colors; 3] = [Colors::Rgb, Colors::Luminance, Colors::Xyz];

/// What the picture's channels are, as a number.
fn kind_of_image(colors: Colors, has_alpha: bool) -> u32 {
    colors as u32 + if has_alpha { 4 } else { 0 }
}

/// The whole image and the part of it, without trust.
fn shape(metadata: &Metadata, full_width: u32, full_height: u32) -> Result<FilmShape, FilmError> {
    let mut shape = FilmShape::new(full_width, full_height);
    let [x, y, width, height] = numbers(metadata, "crop")?;
    let [border_x, border_y] = numbers(metadata, "border")?;
    let [kind, gain] = numbers(metadata, "image")?;
    let [max_component, limited] = numbers(metadata, "limit")?;
    shape.crop = Crop { x, y, width, height };
    shape.border = [border_x, border_y];
    let kinds = COLORS.into_iter().flat_map(|colors| [(colors, false), (colors, true)]);
    let known = kinds.into_iter().find(|(colors, alpha)| kind_of_image(*colors, *alpha) == kind);
    (shape.colors, shape.has_alpha) = known.unwrap_or_default();
    shape.gain = f32::from_bits(gain);
    shape.max_component = f32::from_bits(max_component);
    let limited = COLORS.into_iter().find(|colors| *colors as u32 == limited);
    shape.max_component_of = limited.unwrap_or_default();
    let inside = |start: u32, size: u32, whole: u32| {
        size > 0 && start.checked_add(size).is_some_and(|end| end <= whole)
    };
    let fits = inside(x, width, full_width)
        && inside(y, height, full_height)
        && known.is_some()
        && limited.is_some();
    let fits = fits && (0.0..=1e6).contains(&shape.gain) && shape.max_component >= 0.0;
    // What the filters' reach may be at most.
    if fits && border_x.max(border_y) < 256 {
        Ok(shape)
    } else {
        Err(FilmError::NotAFilm("its crop makes no sense".into()))
    }
}

fn check_layout(planes: &Planes) -> Result<(), FilmError> {
    match text(&planes.metadata, "layout")? {
        LAYOUT => Ok(()),
        other => Err(FilmError::Layout(other.chars().take(16).collect())),
    }
}

fn channels(film: &Film) -> BTreeMap<String, Plane> {
    let means: Vec<[f32; 3]> = film.pixels.iter().map(PixelSum::mean).collect();
    let colors = ["R", "G", "B"].iter().enumerate();
    let mut planes: BTreeMap<String, Plane> = colors
        .map(|(i, name)| (name.to_string(), Plane::Float(means.iter().map(|rgb| rgb[i]).collect())))
        .collect();
    let mut plane = |name: String, word: &dyn Fn(&PixelSum) -> u32| {
        planes.insert(name, Plane::Uint(film.pixels.iter().map(word).collect()));
    };
    for (i, name) in SUMS.iter().enumerate() {
        for word in 0..4 {
            plane(format!("sum.{name}.{word}"), &|pixel| sums(pixel)[i].words()[word]);
        }
    }
    plane("count.drawn".into(), &|pixel| pixel.drawn);
    plane("count.dropped".into(), &|pixel| pixel.dropped);
    let count = film.layer_names().len();
    for i in 0..count {
        for word in 0..4 {
            let sums = film.layers.iter().skip(i).step_by(count);
            planes.insert(layer(i, word), Plane::Uint(sums.map(|sum| sum.words()[word]).collect()));
        }
    }
    planes
}

/// Layers are channels of an image: their names differ from each other and from the picture's.
fn check_names(names: Vec<String>) -> Result<Vec<String>, FilmError> {
    const MOST: usize = 256;
    let mut sorted: Vec<&str> =
        names.iter().map(String::as_str).chain(["R", "G", "B", "X", "Y", "Z"]).collect();
    sorted.sort_unstable();
    if names.len() > MOST || sorted.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err(FilmError::NotAFilm("its layers make no sense".into()));
    }
    Ok(names)
}

/// The channel of a word of a layer's sums.
fn layer(index: usize, word: usize) -> String {
    format!("layer.{index}.{word}")
}

fn film(
    names: Vec<String>,
    shape: FilmShape,
    first: u32,
    channels: &BTreeMap<String, Plane>,
) -> Result<Film, FilmError> {
    let area = shape.area();
    let size = area.width as usize * area.height as usize;
    let plane = |name: &str| match channels.get(name) {
        Some(Plane::Uint(words)) if words.len() == size => Ok(words.as_slice()),
        _ => Err(FilmError::NotAFilm(format!("the channel `{name}` is missing"))),
    };
    let mut words = [[[].as_slice(); 4]; 4];
    for (name, words) in SUMS.iter().zip(&mut words) {
        for (word, slot) in words.iter_mut().enumerate() {
            *slot = plane(&format!("sum.{name}.{word}"))?;
        }
    }
    let (drawn, dropped) = (plane("count.drawn")?, plane("count.dropped")?);
    let count = names.len();
    let layers: Vec<[&[u32]; 4]> = (0..count)
        .map(|i| {
            let mut words = [[].as_slice(); 4];
            for (word, slot) in words.iter_mut().enumerate() {
                *slot = plane(&layer(i, word))?;
            }
            Ok(words)
        })
        .collect::<Result<_, FilmError>>()?;
    let mut film = Film::with_layers(shape, first, names);
    for (i, words) in layers.iter().enumerate() {
        for (at, sum) in film.layers.iter_mut().skip(i).step_by(count).enumerate() {
            *sum = ExactSum::from_words(words.map(|plane| plane[at]));
        }
    }
    for (at, pixel) in film.pixels.iter_mut().enumerate() {
        let [r, g, b, weight] = words.map(|sum| ExactSum::from_words(sum.map(|plane| plane[at])));
        *pixel = PixelSum { rgb: [r, g, b], weight, drawn: drawn[at], dropped: dropped[at] };
    }
    Ok(film)
}

fn sums(pixel: &PixelSum) -> [ExactSum; 4] {
    let [r, g, b] = pixel.rgb;
    [r, g, b, pixel.weight]
}

/// A hash over all numbers and facts.
fn checksum(planes: &Planes) -> String {
    let mut hash = Hash::default();
    hash.text(&format!("{} {}", planes.width, planes.height));
    let facts = planes.metadata.iter().filter(|(name, _)| name.starts_with("aureole."));
    facts.for_each(|(name, value)| hash.text(&format!("{name} {value:?}")));
    for (name, plane) in &planes.channels {
        hash.text(name);
        match plane {
            Plane::Float(values) => hash.words(values.iter().map(|x| x.to_le_bytes())),
            Plane::Uint(values) => hash.words(values.iter().map(|x| x.to_le_bytes())),
        }
    }
    hash.finish()
}

fn text<'a>(metadata: &'a Metadata, name: &str) -> Result<&'a str, FilmError> {
    match metadata.get(&format!("aureole.{name}")) {
        Some(Attribute::Text(text)) => Ok(text),
        _ => Err(FilmError::NotAFilm(format!("it does not say its `{name}`"))),
    }
}

fn numbers<const N: usize>(metadata: &Metadata, name: &str) -> Result<[u32; N], FilmError> {
    let numbers: Result<Vec<u32>, _> = text(metadata, name)?.split(' ').map(str::parse).collect();
    let numbers = numbers.ok().and_then(|list| list.try_into().ok());
    numbers.ok_or_else(|| FilmError::NotAFilm(format!("its `{name}` makes no sense")))
}

#[cfg(test)]
mod tests {
    use aureole_image::Image;
    use aureole_spectrum::Spectrum;

    use super::*;
    use crate::film::tests::add;

    fn file() -> FilmFile {
        let mut shape = FilmShape::new(40, 30);
        shape.crop = Crop { x: 5, y: 6, width: 7, height: 3 };
        let mut film = Film::new(shape, 2);
        let mut tile = film.tile(Crop { x: 6, y: 6, width: 2, height: 2 });
        add(&mut tile, 1, 1, Spectrum::from_rgb([-0.1, 2.0, 1e9]), 0.5);
        add(&mut tile, 0, 1, Spectrum::splat(f32::NAN), 0.5);
        film.put(&tile);
        let fingerprint = Fingerprint::from_text("seed\t0\nshape\tabc\n");
        FilmFile { film, fingerprint, samples: 2..5, spp: 8 }
    }

    fn decode(bytes: &[u8]) -> Result<FilmFile, FilmError> {
        FilmFile::decode(bytes, "a.exr".as_ref(), &ImageLimits::default())
    }

    #[test]
    fn films_come_back_bit_for_bit() {
        let bytes = file().encode().unwrap();
        assert_eq!(decode(&bytes).unwrap(), file());
        let image = aureole_image::decode_image(&bytes, "a.exr".as_ref(), &ImageLimits::default()).unwrap();
        assert_eq!(image.rgb(2, 1), [-0.1, 2.0, 1e9]);
    }

    #[test]
    fn no_damage_goes_unnoticed() {
        let bytes = file().encode().unwrap();
        for end in 0..bytes.len() {
            assert!(decode(&bytes[..end]).is_err(), "cut at {end}");
        }
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            // Some bits of the header mean nothing for a film, such as those of a pixel's aspect.
            if let Ok(film) = decode(&damaged) {
                assert_eq!(film, file(), "bit {bit}");
            }
        }
    }

    #[test]
    fn other_images_are_no_films() {
        let image = Image::new(2, 2, &["R", "G", "B"]);
        let bytes = aureole_image::encode(&image, aureole_image::Format::Exr, &Default::default()).unwrap();
        assert!(matches!(decode(&bytes), Err(FilmError::NotAFilm(_))));
        assert!(matches!(decode(b"no image"), Err(FilmError::Image(_))));
    }
}
