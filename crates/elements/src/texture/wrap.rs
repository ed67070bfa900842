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
    /// What lies beyond the edges of the octahedron that the square is unfolded from.
    Octahedral,
}

impl Wrap {
    /// The texel of a picture that stands at a place; `None` for black.
    #[inline]
    pub(super) fn texel(self, place: [i64; 2], size: [i64; 2]) -> Option<[usize; 2]> {
        let [x, y] = if self == Self::Octahedral { unfold(place, size) } else { place };
        Some([self.index(x, size[0])?, self.index(y, size[1])?])
    }

    /// The texel that stands at an index of a row or column; `None` for black.
    #[inline]
    pub(super) fn index(self, i: i64, n: i64) -> Option<usize> {
        let wrapped = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp | Self::Octahedral => i.clamp(0, n - 1),
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

/// Where the unfolded octahedron goes on beyond an edge of its square: on the other half of the same edge. It repeats after
/// two squares.
fn unfold([x, y]: [i64; 2], [width, height]: [i64; 2]) -> [i64; 2] {
    let near = |i: i64, n: i64| if (-n..2 * n).contains(&i) { i } else { i.rem_euclid(2 * n) };
    let (mut x, mut y) = (near(x, width), near(y, height));
    // Before its first texel pbrt-v4 goes on at the second, after the last at the last.
    if !(0..width).contains(&x) {
        x = if x < 0 { -x } else { 2 * width - 1 - x };
        y = height - 1 - y;
    }
    if !(0..height).contains(&y) {
        y = if y < 0 { -y } else { 2 * height - 1 - y };
        x = width - 1 - x;
    }
    [x, y]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_its_edges_the_octahedron_goes_on_at_their_other_halves() {
        let at = |x, y| Wrap::Octahedral.texel([x, y], [4, 4]).expect("nothing is black");
        assert_eq!(at(1, 2), [1, 2]);
        assert_eq!(at(4, 0), [3, 3]);
        assert_eq!(at(5, 1), [2, 2]);
        assert_eq!(at(1, 4), [2, 3]);
        assert_eq!(at(-1, 1), [1, 2]);
        // Two squares on, everything is as it was.
        assert_eq!(at(9, 2), [1, 2]);
        assert_eq!(at(1, -6), [1, 2]);
    }

    #[test]
    fn wrapping() {
        let at = |wrap: Wrap| [-1, 0, 3, 4, 7].map(|i| wrap.index(i, 4));
        assert_eq!(at(Wrap::Repeat), [3, 0, 3, 0, 3].map(Some));
        assert_eq!(at(Wrap::Mirror), [0, 0, 3, 3, 0].map(Some));
        assert_eq!(at(Wrap::Clamp), [0, 0, 3, 3, 3].map(Some));
        assert_eq!(at(Wrap::Black), [None, Some(0), Some(3), None, None]);
    }
}
