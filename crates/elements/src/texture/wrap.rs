//! What a picture or grid shows beyond its borders.

/// What stands beyond the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrap {
    /// The picture again.
    Repeat,
    /// The picture turned round.
    Mirror,
    /// Its border.
    Clamp,
    /// Nothing.
    Black,
}

impl Wrap {
    /// The texel that stands at an index; `None` for black.
    #[inline]
    pub(super) fn index(self, i: i64, n: i64) -> Option<usize> {
        let wrapped = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let j = i.rem_euclid(2 * n);
                if j < n { j } else { 2 * n - 1 - j }
            }
            Self::Black if (0..n).contains(&i) => i,
            Self::Black => return None,
        };
        Some(wrapped as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping() {
        let at = |wrap: Wrap| [-1, 0, 3, 4, 7].map(|i| wrap.index(i, 4));
        assert_eq!(at(Wrap::Repeat), [3, 0, 3, 0, 3].map(Some));
        assert_eq!(at(Wrap::Mirror), [0, 0, 3, 3, 0].map(Some));
        assert_eq!(at(Wrap::Clamp), [0, 0, 3, 3, 3].map(Some));
        assert_eq!(at(Wrap::Black), [None, Some(0), Some(3), None, None]);
    }
}
