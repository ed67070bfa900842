//! Spectra in files of their own (`.spd`): a wavelength in nanometres and a value, again and again; `#` begins a comment.

use std::path::Path;

use aureole_desc::{Limits, SceneError, Span};
use aureole_spectrum::Tabulated;

use crate::file;
use crate::mesh::MeshError;
use crate::mesh::lines::{lines, without_mark};

/// Reads a spectrum.
///
/// # Errors
/// A file that cannot be read or is malformed.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<Tabulated, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode(&String::from_utf8_lossy(&bytes)).map_err(|error| error.in_file(path, at))
}

/// Reads a file of nothing but numbers, in the same notation.
pub(crate) fn read_numbers(path: &Path, limits: &Limits, at: Span) -> Result<Vec<f32>, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    numbers(&String::from_utf8_lossy(&bytes)).map_err(|error| error.in_file(path, at))
}

/// Reads a spectrum from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(text: &str) -> Result<Tabulated, MeshError> {
    let numbers = numbers(text)?;
    let (pairs, rest) = numbers.as_chunks::<2>();
    if !rest.is_empty() || pairs.is_empty() {
        let found = numbers.len();
        return Err(MeshError::content(format!(
            "pairs of wavelength and value are wanted, there are {found} numbers"
        )));
    }
    if let Some([before, after]) = pairs.array_windows().find(|[a, b]| a[0] >= b[0]) {
        let message = format!("wavelengths must ascend, but {} comes after {}", after[0], before[0]);
        return Err(MeshError::content(message));
    }
    let (lambda, values) = pairs.iter().map(|&[lambda, value]| (lambda, value)).unzip();
    Ok(Tabulated { lambda, values })
}

fn numbers(text: &str) -> Result<Vec<f32>, MeshError> {
    let mut numbers: Vec<f32> = Vec::new();
    for (line_number, line) in lines(without_mark(text.as_bytes())) {
        let line = String::from_utf8_lossy(line);
        let data = line.split('#').next().unwrap_or("");
        let words = data.split(|c: char| c == ',' || c == ';' || c.is_whitespace());
        for word in words.filter(|word| !word.is_empty()) {
            let number = word.parse::<f32>().ok().filter(|x| x.is_finite());
            numbers.push(number.ok_or_else(|| {
                let word: String = word.chars().take(32).collect();
                MeshError::content(format!("line {line_number}: a finite number is wanted, not `{word}`"))
            })?);
        }
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_comments_and_empty_lines() {
        let table =
            decode("\u{feff}# a lamp\r400 0.5 # violet\n\n500, 1\r\n600;2 700 3\n").expect("is sound");
        assert_eq!(table.lambda, [400.0, 500.0, 600.0, 700.0]);
        assert_eq!(table.values, [0.5, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn what_is_wrong_is_told() {
        for (text, words) in [
            ("", "0 numbers"),
            ("400 1\n500", "3 numbers"),
            ("400 1\n500 x", "line 2"),
            ("400 nan", "line 1"),
            ("400 1e99", "line 1"),
            ("400 1 400 2", "400 comes after 400"),
        ] {
            let message = decode(text).expect_err("is broken").to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
