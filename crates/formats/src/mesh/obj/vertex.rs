//! Numbers of vertices: positions, texture coordinates, normals, colours.

use crate::mesh::colors;
use crate::mesh::lines::Notes;

/// The next number.
fn number(rest: &mut &[u8]) -> Option<f32> {
    *rest = rest.trim_ascii_start();
    let (value, length) = fast_float2::parse_partial(*rest).ok()?;
    *rest = &rest[length..];
    Some(value)
}

/// The next numbers; what comes after them is left.
pub(super) fn take_numbers<const N: usize>(rest: &mut &[u8]) -> Result<[f32; N], String> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = number(rest).ok_or_else(|| expected(&format!("{N} numbers"), rest))?;
    }
    Ok(values)
}

pub(super) fn numbers<const N: usize>(mut rest: &[u8]) -> Result<[f32; N], String> {
    take_numbers(&mut rest)
}

/// A texture coordinate may have one, two or three numbers; what is missing is zero.
pub(super) fn texture_coordinates(mut rest: &[u8]) -> Result<[f32; 2], String> {
    let u = number(&mut rest).ok_or_else(|| expected("a number", rest))?;
    Ok([u, number(&mut rest).unwrap_or(0.0)])
}

fn expected(what: &str, found: &[u8]) -> String {
    format!("{what} expected, found `{}`", String::from_utf8_lossy(found.trim_ascii()))
}

/// Colours of vertices: behind their positions (`v x y z r g b`), as many programs write them, or painted (`#MRGB`), as ZBrush does.
///
/// A position may have a weight before its colour, which only free-form surfaces need, and a colour an opacity behind it.
#[derive(Debug, Default)]
pub(super) struct VertexColors {
    /// The last four numbers behind each position; NaN where there are fewer. As long as the last coloured vertex needs it.
    numbers: Vec<[f32; 4]>,
    /// Of `#MRGB`, in the order of the vertices.
    painted: Vec<[f32; 3]>,
    /// A vertex with a number of numbers that says nothing.
    has_others: bool,
}

const NONE: [f32; 4] = [f32::NAN; 4];

impl VertexColors {
    /// Takes in what stands behind the position of a vertex.
    #[inline]
    pub(super) fn add(&mut self, vertex: usize, mut rest: &[u8]) {
        rest = rest.trim_ascii_start();
        if rest.is_empty() {
            return;
        }
        let mut found = [0.0; 5];
        let count = found.iter_mut().map_while(|x| number(&mut rest).map(|value| *x = value)).count();
        let numbers = match count {
            3 => [found[0], found[1], found[2], f32::NAN],
            4 => [found[0], found[1], found[2], found[3]],
            5 => [found[1], found[2], found[3], f32::NAN],
            _ => {
                self.has_others |= count == 2;
                return;
            }
        };
        self.numbers.resize(vertex, NONE);
        self.numbers.push(numbers);
    }

    /// Eight hexadecimal digits a vertex: a mask, red, green, blue.
    pub(super) fn add_painted(&mut self, rest: &[u8]) {
        let byte = |digits: &[u8]| {
            let digit = |b: u8| char::from(b).to_digit(16);
            Some((digit(digits[0])? * 16 + digit(digits[1])?) as f32 / 255.0)
        };
        let color = |word: &[u8]| Some([byte(&word[2..4])?, byte(&word[4..6])?, byte(&word[6..8])?]);
        self.painted.extend(rest.trim_ascii().chunks_exact(8).map_while(color));
    }

    /// The colours of so many vertices, where there are any.
    pub(super) fn finish(mut self, vertices: usize, notes: &mut Notes) -> Vec<Option<[f32; 3]>> {
        if self.has_others {
            notes.add(
                "two numbers behind a position are neither a weight nor a colour: they are left out",
                None,
            );
        }
        if self.numbers.is_empty() {
            self.painted.truncate(vertices);
            return self.painted.into_iter().map(Some).collect();
        }
        // Of four numbers the first is a weight, one for all that is not curved, or the last is an opacity.
        let of_four =
            |place: usize| self.numbers.iter().filter(|c| !c[3].is_nan()).all(move |c| c[place] == 1.0);
        let first = usize::from(of_four(0) && !of_four(3));
        let color = |c: &[f32; 4]| {
            let start = if c[3].is_nan() { 0 } else { first };
            [c[start], c[start + 1], c[start + 2]]
        };
        let colors: Vec<[f32; 3]> = self.numbers.iter().map(color).collect();
        if first == 0 && !of_four(3) {
            notes.add("opacities behind the colours of vertices are left out", None);
        }
        let span = colors::span(colors.iter().flatten().copied(), 65_535.0);
        colors.into_iter().map(|c| (!c[0].is_nan()).then(|| c.map(|x| x / span))).collect()
    }
}
