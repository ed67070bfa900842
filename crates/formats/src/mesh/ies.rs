//! IES luminaire profiles (LM-63-1986 to 2002): how strongly a lamp shines in which direction.
//!
//! Keyword lines up to `TILT=`, then numbers: lamps, lumens a lamp, multiplier, counts of vertical and horizontal angles,
//! photometric type, units, three sizes, ballast factor, a factor for the future, watts; the vertical angles; the horizontal
//! ones; and the candelas of each horizontal angle.

use std::path::Path;

use aureole_desc::{Limits, SceneError, Span};

use crate::file;
use crate::mesh::MeshError;
use crate::mesh::error::check_count;

/// A luminaire's intensities.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Angles from straight down, degrees, ascending.
    pub vertical: Vec<f32>,
    /// Angles around, degrees, ascending.
    pub horizontal: Vec<f32>,
    /// Candelas, the vertical angle fastest, with all factors of the file.
    pub candela: Vec<f32>,
}

/// Reads a profile.
///
/// # Errors
/// A file that cannot be read or is malformed.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<Profile, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode(&String::from_utf8_lossy(&bytes), limits).map_err(|error| error.in_file(path, at))
}

/// Reads a profile from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(text: &str, limits: &Limits) -> Result<Profile, MeshError> {
    let tilt = text.find("TILT=").ok_or_else(|| MeshError::content("not an IES profile: no `TILT=`"))?;
    let (kind, body) = text[tilt + 5..].split_once(['\n', '\r']).unwrap_or(("", ""));
    let mut numbers = Numbers(body.split([' ', '\t', '\r', '\n', ',']).filter(|word| !word.is_empty()));
    match kind.trim() {
        "NONE" => {}
        // The lamp's loss when tilted: its position, angles and factors. It is mounted as measured.
        "INCLUDE" => {
            numbers.next("tilt")?;
            let pairs = numbers.count("tilt angles", limits)?;
            numbers.list(2 * pairs, "tilt")?;
        }
        other => {
            return Err(MeshError::content(format!("TILT={other} (a file of its own) is not supported")));
        }
    }
    let [_lamps, _lumens, multiplier] = numbers.array("the first line of numbers")?;
    let vertical = numbers.count("vertical angles", limits)?;
    let horizontal = numbers.count("horizontal angles", limits)?;
    let [photometry, _units, _width, _length, _height, ballast, _future, _watts] =
        numbers.array("the second line of numbers")?;
    if photometry != 1.0 {
        return Err(MeshError::content("only photometric type C is supported"));
    }
    let count = check_count("candelas", vertical as u64 * horizontal as u64, limits)?;
    let vertical = numbers.list(vertical, "vertical angles")?;
    let horizontal = numbers.list(horizontal, "horizontal angles")?;
    let mut candela = numbers.list(count, "candelas")?;
    candela.iter_mut().for_each(|c| *c = (*c * multiplier * ballast).max(0.0));
    if !candela.iter().all(|c| c.is_finite()) {
        return Err(MeshError::content("candelas and their factors are too large"));
    }
    let ascends = |list: &[f32]| !list.is_empty() && list.windows(2).all(|pair| pair[0] < pair[1]);
    if !ascends(&vertical) || !ascends(&horizontal) {
        return Err(MeshError::content("angles must ascend"));
    }
    Ok(Profile { vertical, horizontal, candela })
}

/// The numbers of the file, one by one.
struct Numbers<I>(I);

impl<'a, I: Iterator<Item = &'a str>> Numbers<I> {
    fn next(&mut self, what: &str) -> Result<f32, MeshError> {
        let word = self.0.next().ok_or_else(|| MeshError::content(format!("the file ends within {what}")))?;
        let number = word.parse::<f32>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| MeshError::content(format!("a number is wanted for {what}, not `{word}`")))
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[f32; N], MeshError> {
        let mut array = [0.0; N];
        for slot in &mut array {
            *slot = self.next(what)?;
        }
        Ok(array)
    }

    fn count(&mut self, what: &str, limits: &Limits) -> Result<usize, MeshError> {
        let n = self.next(what)?;
        if n < 1.0 || n.fract() != 0.0 {
            return Err(MeshError::content(format!("{n} {what}")));
        }
        check_count(what, n as u64, limits)
    }

    fn list(&mut self, n: usize, what: &str) -> Result<Vec<f32>, MeshError> {
        (0..n).map(|_| self.next(what)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n1 1000 2 3 2 1 2 0 0 0\n0.5 1 60\n\
                         0 45 90\n0 180\n10 5 0\n20, 10, 0\n";

    #[test]
    fn a_small_profile() -> Result<(), MeshError> {
        let profile = decode(SMALL, &Limits::default())?;
        assert_eq!(profile.vertical, [0.0, 45.0, 90.0]);
        assert_eq!(profile.horizontal, [0.0, 180.0]);
        assert_eq!(profile.candela, [10.0, 5.0, 0.0, 20.0, 10.0, 0.0]);
        Ok(())
    }

    #[test]
    fn broken_profiles_are_errors() {
        let limits = Limits::default();
        for n in 0..SMALL.len() - 2 {
            assert!(decode(&SMALL[..n], &limits).is_err(), "{n}");
        }
        assert!(decode(&SMALL.replace(" 3 2 1 2", " 3 2 2 2"), &limits).is_err());
        assert!(decode(&SMALL.replace("0 45 90", "0 45 45"), &limits).is_err());
        assert!(decode(&SMALL.replace(" 3 2 1 2", " 4000000000 2 1 2"), &limits).is_err());
        assert!(decode(&SMALL.replace("1 1000 2", "1 1000 1e38"), &limits).is_err());
    }
}
