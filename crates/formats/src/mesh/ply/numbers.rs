//! Numbers as text and as bytes.

use super::header::Scalar;
use crate::mesh::lines::line_ends;

/// A stream of numbers.
pub(super) trait Numbers {
    /// The next number.
    fn next(&mut self, scalar: Scalar) -> Option<f64>;
    /// Bytes that are left.
    fn left(&self) -> usize;
    /// Where the stream is, for messages.
    fn place(&self) -> String;
}

/// Numbers as text.
pub(super) struct Ascii<'a> {
    all: &'a [u8],
    rest: &'a [u8],
    header_lines: usize,
}

impl<'a> Ascii<'a> {
    pub(super) fn new(body: &'a [u8], header_lines: usize) -> Self {
        Self { all: body, rest: body, header_lines }
    }
}

impl Numbers for Ascii<'_> {
    #[inline]
    fn next(&mut self, _scalar: Scalar) -> Option<f64> {
        self.rest = self.rest.trim_ascii_start();
        let (value, length) = fast_float2::parse_partial(self.rest).ok()?;
        self.rest = &self.rest[length..];
        let ends = self.rest.first().is_none_or(u8::is_ascii_whitespace);
        ends.then_some(value)
    }

    fn left(&self) -> usize {
        self.rest.len()
    }

    fn place(&self) -> String {
        let read = &self.all[..self.all.len() - self.rest.len()];
        format!("line {}", self.header_lines + 1 + line_ends(read))
    }
}

/// Numbers as bytes.
pub(super) struct Binary<'a, const BIG: bool> {
    pub(super) rest: &'a [u8],
}

impl<const BIG: bool> Binary<'_, BIG> {
    #[inline]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&bytes, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(bytes)
    }
}

/// Reads a number of a type in either byte order.
macro_rules! take_number {
    ($self:ident, $ty:ty) => {{
        let bytes = $self.take()?;
        f64::from(if BIG { <$ty>::from_be_bytes(bytes) } else { <$ty>::from_le_bytes(bytes) })
    }};
}

impl<const BIG: bool> Numbers for Binary<'_, BIG> {
    #[inline]
    fn next(&mut self, scalar: Scalar) -> Option<f64> {
        Some(match scalar {
            Scalar::I8 => take_number!(self, i8),
            Scalar::U8 => take_number!(self, u8),
            Scalar::I16 => take_number!(self, i16),
            Scalar::U16 => take_number!(self, u16),
            Scalar::I32 => take_number!(self, i32),
            Scalar::U32 => take_number!(self, u32),
            Scalar::F32 => take_number!(self, f32),
            Scalar::F64 => take_number!(self, f64),
        })
    }

    fn left(&self) -> usize {
        self.rest.len()
    }

    fn place(&self) -> String {
        format!("{} bytes before the end", self.rest.len())
    }
}
