//! Damaged files: what a reader must survive.
//!
//! [`Corruptor`] draws one of the ways in which files come to harm, by accident or by malice, and applies it to the bytes
//! of a good file. It knows no format, but it finds numbers: written out in texts, and as words of four bytes elsewhere.

use std::ops::Range;

use aureole::math::Pcg32;

/// Numbers that are right in no place or too large for most.
const HOSTILE_NUMBERS: &[&str] = &[
    "0",
    "-1",
    "-0.0",
    "1e-45",
    "1e38",
    "1e999",
    "-1e999",
    "nan",
    "inf",
    "2147483648",
    "4294967295",
    "1000000000",
    "99999999999999999999",
    "",
    "x",
];

/// The same as four bytes: counts, indices and floats.
const HOSTILE_WORDS: &[u32] = &[
    0,
    1,
    u32::MAX,
    i32::MAX as u32,
    i32::MIN as u32,
    1_000_000_000,
    0x7FC0_0000, // NaN
    0x7F80_0000, // infinity
    0x7F7F_FFFF, // the largest float
    0x0000_0100,
];

/// A damaged copy of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Corrupted {
    /// What was done, in words that fit into a file name.
    pub what: String,
    /// The damaged bytes.
    pub bytes: Vec<u8>,
}

/// Copies of a file that end at every multiple of `step`.
pub fn truncations(bytes: &[u8], step: usize) -> impl Iterator<Item = Corrupted> {
    (0..bytes.len())
        .step_by(step.max(1))
        .map(|end| Corrupted { what: format!("cut-{end}"), bytes: bytes[..end].to_vec() })
}

/// Draws ways of damaging files; the same seed draws the same ones.
#[derive(Clone, Debug)]
pub struct Corruptor {
    rng: Pcg32,
}

impl Corruptor {
    /// A corruptor from a seed.
    pub fn new(seed: u64) -> Self {
        Self { rng: Pcg32::new(seed) }
    }

    /// A damaged copy of `bytes`; most damages need at least a few of them.
    pub fn corrupt(&mut self, bytes: &[u8]) -> Corrupted {
        let mut bytes = bytes.to_vec();
        let what = match self.below(8) {
            0 => self.truncate(&mut bytes),
            1 | 2 => self.flip_bits(&mut bytes),
            3 => self.overwrite_word(&mut bytes),
            4 | 5 => self.replace_number(&mut bytes),
            6 => self.remove(&mut bytes),
            _ => self.repeat(&mut bytes),
        };
        Corrupted { what, bytes }
    }

    /// A random number below `n`, or 0 when there is none.
    fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.rng.next_u32()) * n as u64) >> 32) as usize
    }

    /// A random range of at most `longest` bytes.
    fn range(&mut self, len: usize, longest: usize) -> Range<usize> {
        let start = self.below(len);
        let length = 1 + self.below(longest);
        start..(start + length).min(len)
    }

    fn truncate(&mut self, bytes: &mut Vec<u8>) -> String {
        let end = self.below(bytes.len());
        bytes.truncate(end);
        format!("cut-{end}")
    }

    fn flip_bits(&mut self, bytes: &mut [u8]) -> String {
        let count = 1 + self.below(4);
        let mut last = 0;
        for _ in 0..count {
            last = self.below(bytes.len());
            let bit = self.below(8);
            if let Some(byte) = bytes.get_mut(last) {
                *byte ^= 1 << bit;
            }
        }
        format!("flip-{count}-at-{last}")
    }

    fn overwrite_word(&mut self, bytes: &mut [u8]) -> String {
        // Half of the time in the first kilobyte, which is where headers are.
        let region = if self.below(2) == 0 { bytes.len().min(1024) } else { bytes.len() };
        let at = self.below(region.saturating_sub(3));
        let word = HOSTILE_WORDS[self.below(HOSTILE_WORDS.len())];
        let word = if self.below(2) == 0 { word.to_le_bytes() } else { word.to_be_bytes() };
        if let Some(target) = bytes.get_mut(at..at + 4) {
            target.copy_from_slice(&word);
        }
        format!("word-at-{at}")
    }

    fn replace_number(&mut self, bytes: &mut Vec<u8>) -> String {
        let from = self.below(bytes.len());
        let Some(number) = next_number(bytes, from).or_else(|| next_number(bytes, 0)) else {
            return self.flip_bits(bytes);
        };
        let text = HOSTILE_NUMBERS[self.below(HOSTILE_NUMBERS.len())];
        let at = number.start;
        bytes.splice(number, text.bytes());
        format!("number-{text}-at-{at}")
    }

    fn remove(&mut self, bytes: &mut Vec<u8>) -> String {
        let range = self.range(bytes.len(), 64);
        let what = format!("remove-{}-at-{}", range.len(), range.start);
        bytes.drain(range);
        what
    }

    fn repeat(&mut self, bytes: &mut Vec<u8>) -> String {
        let range = self.range(bytes.len(), 64);
        let to = self.below(bytes.len());
        let copy = bytes[range.clone()].to_vec();
        bytes.splice(to..to, copy);
        format!("repeat-{}-at-{to}", range.len())
    }
}

/// The first number written in digits at or after `from`.
fn next_number(bytes: &[u8], from: usize) -> Option<Range<usize>> {
    let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e');
    let start = from + bytes.get(from..)?.iter().position(u8::is_ascii_digit)?;
    let length = bytes[start..].iter().position(|b| !is_part(b)).unwrap_or(bytes.len() - start);
    Some(start..start + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_does_the_same_damage() {
        let file = b"vertex 12 -3.5e2 and \x00\x01\x02\x03 bytes";
        let draw = |seed| {
            let mut corruptor = Corruptor::new(seed);
            (0..100).map(|_| corruptor.corrupt(file)).collect::<Vec<_>>()
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        let damaged = draw(1).iter().filter(|copy| copy.bytes != file).count();
        assert!(damaged > 90, "{damaged}");
    }

    #[test]
    fn short_files_can_be_damaged_too() {
        let mut corruptor = Corruptor::new(3);
        for len in 0..6 {
            for _ in 0..100 {
                corruptor.corrupt(&vec![b'1'; len]);
            }
        }
    }

    #[test]
    fn numbers_are_found() {
        let text = b"scale 1.5e3,2";
        assert_eq!(next_number(text, 0), Some(6..11));
        assert_eq!(next_number(text, 11), Some(12..13));
        assert_eq!(next_number(text, 13), None);
        assert_eq!(truncations(text, 4).map(|copy| copy.bytes.len()).collect::<Vec<_>>(), [0, 4, 8, 12]);
    }
}
