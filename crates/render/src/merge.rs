//! Parts of a render become the whole.

use std::ops::Range;

use crate::film::Film;
use crate::film_file::FilmFile;
use crate::fingerprint::Fingerprint;

/// Why parts do not make a whole.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// No parts at all.
    #[error("there is nothing to merge")]
    Nothing,
    /// Parts of different renders.
    #[error("`{part}` does not belong to `{first}`: {}", differences.join("; "))]
    Differs {
        /// The part.
        part: String,
        /// The first part, with which all others are compared.
        first: String,
        /// What differs.
        differences: Vec<String>,
    },
    /// A part that was interrupted.
    #[error(
        "`{part}` is not finished: its pixels have {} to {} of {wanted} samples; go on with `render --resume`",
        drawn[0], drawn[1]
    )]
    Unfinished {
        /// The part.
        part: String,
        /// The least and largest number of samples of a pixel.
        drawn: [u32; 2],
        /// How many there should be.
        wanted: u32,
    },
    /// Samples that two parts have, or that no part has.
    #[error("{}", problems(doubled, missing))]
    Ranges {
        /// What is there twice.
        doubled: Vec<Overlap>,
        /// What is not there.
        missing: Vec<Range<u32>>,
    },
}

/// Samples that two parts have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overlap {
    /// Which.
    pub samples: Range<u32>,
    /// One part.
    pub a: String,
    /// The other.
    pub b: String,
}

fn problems(doubled: &[Overlap], missing: &[Range<u32>]) -> String {
    let words = |range: &Range<u32>| format!("{}..{}", range.start, range.end);
    let twice = doubled
        .iter()
        .map(|Overlap { samples, a, b }| format!("samples {} are in both `{a}` and `{b}`", words(samples)));
    let nowhere: Vec<_> = missing.iter().map(words).collect();
    let nowhere = (!nowhere.is_empty()).then(|| format!("samples {} are missing", nowhere.join(", ")));
    twice.chain(nowhere).collect::<Vec<_>>().join("; ")
}

/// Adds parts as they come. The order does not matter: sums are exact.
#[derive(Debug, Default)]
pub struct Merger {
    whole: Option<(Film, Fingerprint)>,
    /// The ranges and names of the parts.
    parts: Vec<(Range<u32>, String)>,
    spp: u32,
}

impl Merger {
    /// Adds a part; the name is for messages.
    ///
    /// # Errors
    /// [`MergeError::Unfinished`] and [`MergeError::Differs`].
    pub fn add(&mut self, part: FilmFile, name: &str) -> Result<(), MergeError> {
        if !part.is_complete() {
            let (part, drawn, wanted) = (name.to_owned(), part.film.drawn(), part.samples.len() as u32);
            return Err(MergeError::Unfinished { part, drawn, wanted });
        }
        match &mut self.whole {
            None => self.whole = Some((part.film, part.fingerprint)),
            Some((film, fingerprint)) => {
                let mut differences = part.fingerprint.differences(fingerprint);
                if differences.is_empty() && part.film.layer_names() != film.layer_names() {
                    differences.push("the layers".to_owned());
                }
                if differences.is_empty() && part.film.shape() != film.shape() {
                    differences.push("the size".to_owned());
                }
                if !differences.is_empty() {
                    let first = self.parts[0].1.clone();
                    return Err(MergeError::Differs { part: name.to_owned(), first, differences });
                }
                film.add(&part.film);
            }
        }
        self.parts.push((part.samples, name.to_owned()));
        self.spp = self.spp.max(part.spp);
        Ok(())
    }

    /// The whole: every sample of the render, each once.
    ///
    /// # Errors
    /// [`MergeError::Nothing`] and [`MergeError::Ranges`].
    pub fn finish(mut self) -> Result<FilmFile, MergeError> {
        let (film, fingerprint) = self.whole.ok_or(MergeError::Nothing)?;
        self.parts.sort_by_key(|(samples, _)| (samples.start, samples.end));
        let (mut doubled, mut missing) = (Vec::new(), Vec::new());
        // The part that reaches farthest so far.
        let (mut end, mut farthest) = (0, "");
        for (samples, name) in &self.parts {
            if samples.start > end {
                missing.push(end..samples.start);
            } else if samples.start < end {
                let samples = samples.start..samples.end.min(end);
                doubled.push(Overlap { samples, a: farthest.to_owned(), b: name.clone() });
            }
            if samples.end > end {
                (end, farthest) = (samples.end, name);
            }
        }
        if end < self.spp {
            missing.push(end..self.spp);
        }
        if doubled.is_empty() && missing.is_empty() {
            return Ok(FilmFile { film, fingerprint, samples: 0..self.spp, spp: self.spp });
        }
        Err(MergeError::Ranges { doubled, missing })
    }
}

#[cfg(test)]
mod tests {
    use aureole_scene::{Crop, Film as FilmShape};
    use aureole_spectrum::Spectrum;

    use super::*;
    use crate::film::tests::add;

    fn part(samples: Range<u32>, seed: u32) -> FilmFile {
        let mut film = Film::new(FilmShape::new(1, 1), samples.start);
        let mut tile = film.tile(Crop { x: 0, y: 0, width: 1, height: 1 });
        samples.clone().for_each(|s| assert!(add(&mut tile, 0, 0, Spectrum::splat(0.1 * s as f32), 1.0)));
        film.put(&tile);
        FilmFile { film, fingerprint: Fingerprint::from_text(&format!("seed\t{seed}")), samples, spp: 8 }
    }

    fn merge(parts: &[Range<u32>]) -> Result<FilmFile, MergeError> {
        let mut merger = Merger::default();
        for samples in parts {
            merger.add(part(samples.clone(), 0), &format!("{samples:?}"))?;
        }
        merger.finish()
    }

    #[test]
    fn any_split_in_any_order_is_the_whole() {
        let whole = part(0..8, 0);
        assert_eq!(merge(&[0..3, 3..5, 5..8]).unwrap(), whole);
        assert_eq!(merge(&[5..8, 0..3, 3..5]).unwrap(), whole);
    }

    #[test]
    fn what_is_wrong_has_a_name() {
        let message = |parts: &[Range<u32>]| merge(parts).unwrap_err().to_string();
        assert_eq!(message(&[]), "there is nothing to merge");
        assert_eq!(message(std::slice::from_ref(&(3..5))), "samples 0..3, 5..8 are missing");
        assert_eq!(message(&[0..5, 3..8]), "samples 3..5 are in both `0..5` and `3..8`");
        assert_eq!(
            message(&[1..6, 2..3, 4..7]),
            "samples 2..3 are in both `1..6` and `2..3`; samples 4..6 are in both `1..6` and `4..7`; \
             samples 0..1, 7..8 are missing"
        );
        let mut merger = Merger::default();
        merger.add(part(0..2, 0), "a").unwrap();
        let differs = merger.add(part(2..8, 1), "b").unwrap_err().to_string();
        assert_eq!(differs, "`b` does not belong to `a`: seed: 1, here 0");
        let unfinished =
            merger.add(FilmFile { samples: 2..9, ..part(2..4, 0) }, "c").unwrap_err().to_string();
        assert!(unfinished.contains("2 to 2 of 7"), "{unfinished}");
    }
}
