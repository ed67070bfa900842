//! Mitsuba's curve files: one control point a line, `x y z radius`; empty lines part curves.

use std::path::Path;
use std::sync::Arc;

use aureole_desc::{Limits, SceneError, Span};

use crate::file;
use crate::mesh::MeshError;
use crate::mesh::error::check_count;
use crate::mesh::lines::{lines, without_mark};

/// The control points of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// x, y, z and radius of each control point.
    pub points: Arc<[f32]>,
    /// Control points of each curve.
    pub counts: Arc<[i32]>,
}

/// Reads curves of at least `least` control points each.
///
/// # Errors
/// A file that cannot be read, or a line that is not four numbers, named by its number.
pub fn read(path: &Path, least: usize, limits: &Limits, at: Span) -> Result<Curves, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode(&bytes, least, limits).map_err(|error| error.in_file(path, at))
}

/// Reads curves from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(bytes: &[u8], least: usize, limits: &Limits) -> Result<Curves, MeshError> {
    let mut points: Vec<f32> = Vec::new();
    let mut counts: Vec<i32> = Vec::new();
    let mut in_curve = false;
    for (number, line) in lines(without_mark(bytes)) {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).peekable();
        if words.peek().is_none() {
            in_curve = false;
            continue;
        }
        for _ in 0..4 {
            let value = words.next().and_then(|word| fast_float2::parse::<f32, _>(word).ok());
            points.push(value.filter(|x| x.is_finite()).ok_or_else(|| {
                MeshError::content(format!("line {number} is not `x y z radius`, four finite numbers"))
            })?);
        }
        match counts.last_mut() {
            Some(count) if in_curve => *count += 1,
            _ => counts.push(1),
        }
        in_curve = true;
        check_count("control points", points.len() as u64 / 4, limits)?;
    }
    if counts.is_empty() {
        return Err(MeshError::content("there are no control points"));
    }
    if let Some(short) = counts.iter().position(|&n| (n as usize) < least) {
        let found = counts[short];
        return Err(MeshError::content(format!(
            "curve {} has {found} control points, it needs {least}",
            short + 1
        )));
    }
    Ok(Curves { points: points.into(), counts: counts.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Curves, MeshError> {
        decode(text.as_bytes(), 2, &Limits::default())
    }

    #[test]
    fn empty_lines_part_curves() {
        let curves = of("\n0 0 0 1\r\n1 0 0 1e-1\n \t\n\n0 1 0 1\n1 1 0 1\n2 1 0 .5\n").expect("is sound");
        assert_eq!(*curves.counts, [2, 3]);
        assert_eq!(curves.points.len(), 20);
        assert_eq!(curves.points[7], 0.1);
    }

    #[test]
    fn what_is_wrong_has_a_place() {
        for (text, words) in [
            ("", "no control points"),
            ("0 0 0 1\n0 0 1\n", "line 2"),
            ("0 0 0 1\n0 0 nan 1\n", "line 2"),
            ("0 0 0 1\n\n0 0 0 1\n1 1 1 1", "curve 1"),
        ] {
            let message = of(text).expect_err("is broken").to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
