//! Film files: as they are, where a checksum stops nearly all damage, and what is behind it.

use std::path::Path;

use aureole::image::{ImageLimits, Plane, Planes};
use aureole::math::Pcg32;
use aureole::render::{ExactSum, FilmFile, Merger};

use crate::samples::{Sample, sample};

/// The channels of whole numbers.
const SUMS: [&str; 4] = ["R", "G", "B", "weight"];
const COUNTS: [&str; 2] = ["count.drawn", "count.dropped"];
/// Sides and spare pixels that bytes may ask for.
const SIDES: usize = 5;

/// The target: a file, and a table of the same bytes whose checksum nobody compares.
pub(crate) fn check(bytes: &[u8]) {
    let limits = ImageLimits { max_pixels: 1 << 16, max_bytes: 1 << 24 };
    if let Ok(film) = FilmFile::decode(bytes, Path::new("film.exr"), &limits) {
        check_film(film);
    }
    if let Some(film) = table(bytes).and_then(|planes| FilmFile::from_planes(&planes).ok()) {
        check_film(film);
    }
}

/// What must hold for every film that is accepted.
fn check_film(film: FilmFile) {
    let bytes = film.encode().expect("a film that was read can be written");
    let again = FilmFile::decode(&bytes, Path::new("film.exr"), &ImageLimits::default());
    assert_eq!(again.as_ref().ok(), Some(&film), "it comes back as it was written");
    let mut image = film.film.image();
    assert_eq!(image.data().len(), image.channels().len() * image.width() * image.height());
    image.data_mut().fill(0.0);

    let mut merger = Merger::default();
    let is_part = merger.add(film.clone(), "a").is_ok();
    if is_part && film.samples != (0..film.spp) {
        assert!(merger.finish().is_err(), "samples are missing");
    } else if is_part {
        let twice = merger.add(film, "b").and_then(|()| merger.finish());
        assert!(twice.is_err(), "samples are there twice");
    }
}

/// A table from bytes: one of each side, the header's facts line by line up to an empty one, then numbers.
fn table(bytes: &[u8]) -> Option<Planes> {
    let (&[width, height], rest) = bytes.split_first_chunk()?;
    let (width, height) = (usize::from(width) % SIDES, usize::from(height) % SIDES);
    let end = rest.windows(2).position(|pair| pair == b"\n\n")?;
    let mut planes = Planes { width, height, ..Planes::default() };
    for line in String::from_utf8_lossy(&rest[..end]).lines() {
        if let Some((name, value)) = line.split_once('=') {
            // Within a fact, `|` stands for the end of a line.
            planes.metadata.insert(format!("aureole.{name}"), value.replace('|', "\n").into());
        }
    }
    let mut words = rest[end + 2..].as_chunks().0.iter().map(|&word| u32::from_le_bytes(word));
    let sums = SUMS.iter().flat_map(|name| (0..4).map(move |word| format!("sum.{name}.{word}")));
    for name in sums.chain(COUNTS.map(str::to_owned)) {
        let numbers = (0..width * height).map(|_| words.next().unwrap_or(0)).collect();
        planes.channels.insert(name, Plane::Uint(numbers));
    }
    Some(planes)
}

/// A film of a few pixels as a file, and as the bytes that [`table`] understands.
pub(crate) fn samples() -> Vec<Sample> {
    let (width, height) = (3u8, 2u8);
    let facts = "layout=4\nfilm=4 4 1 1\ncrop=1 1 3 2\nborder=0 0\nimage=0 1065353216\nlimit=2139095040 0\nlayers=\nsamples=0 4\nspp=4\nfingerprint=seed\t0|shape\tabc";
    let mut bytes = [&[width, height][..], facts.as_bytes(), b"\n\n"].concat();
    let pixels = usize::from(width) * usize::from(height);
    let mut rng = Pcg32::new(1);
    let sums: Vec<[u32; 4]> = (0..4 * pixels)
        .map(|_| {
            let mut sum = ExactSum::default();
            sum.add(rng.next_u32() as f32 / 1e9);
            sum.words()
        })
        .collect();
    for sums in sums.chunks(pixels) {
        for word in 0..4 {
            bytes.extend(sums.iter().flat_map(|sum| sum[word].to_le_bytes()));
        }
    }
    bytes.extend([4u32, 0].iter().flat_map(|n| [*n; 6]).flat_map(u32::to_le_bytes));
    let film = table(&bytes).and_then(|planes| FilmFile::from_planes(&planes).ok());
    let file = film.and_then(|film| film.encode().ok()).unwrap_or_default();
    vec![sample("table", &bytes), sample("file", &file)]
}

#[cfg(test)]
mod tests {
    #[test]
    fn samples_are_films() {
        let [table, file] = &super::samples()[..] else { panic!("two samples") };
        assert!(file.bytes.len() > 500, "{}", file.bytes.len());
        assert!(super::table(&table.bytes).is_some());
        super::check(&table.bytes);
        super::check(&file.bytes);
    }
}
