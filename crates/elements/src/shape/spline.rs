//! Cubic curves in their Bézier form, whatever basis their control points are in.

/// How control points make a cubic curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Basis {
    /// Bézier: segments share an end point.
    Bezier,
    /// Uniform cubic B-spline.
    BSpline,
    /// Catmull-Rom: passes through its control points.
    CatmullRom,
}

impl Basis {
    /// The names of the bases in scenes.
    pub(super) const NAMES: &'static [(&'static str, Self)] =
        &[("bspline", Self::BSpline), ("bezier", Self::Bezier), ("catmull_rom", Self::CatmullRom)];

    /// Control points from the start of one segment to that of the next.
    pub(super) fn stride(self) -> usize {
        if self == Self::Bezier { 3 } else { 1 }
    }

    /// Segments of a curve of so many control points; `None` where the number does not fit.
    pub(super) fn segments(self, points: usize) -> Option<usize> {
        let beyond = points.checked_sub(4)?;
        beyond.is_multiple_of(self.stride()).then(|| beyond / self.stride() + 1)
    }

    /// Bézier control points of the segment that four control points make.
    pub(super) fn to_bezier<const N: usize>(self, p: [[f64; N]; 4]) -> Cubic<N> {
        let sum = |w: [f64; 4]| std::array::from_fn(|i| (0..4).map(|k| w[k] * p[k][i]).sum());
        let (third, sixth) = (1.0 / 3.0, 1.0 / 6.0);
        Cubic(match self {
            Self::Bezier => p,
            Self::BSpline => [
                sum([sixth, 4.0 * sixth, sixth, 0.0]),
                sum([0.0, 2.0 * third, third, 0.0]),
                sum([0.0, third, 2.0 * third, 0.0]),
                sum([0.0, sixth, 4.0 * sixth, sixth]),
            ],
            Self::CatmullRom => [p[1], sum([-sixth, 1.0, sixth, 0.0]), sum([0.0, sixth, 1.0, -sixth]), p[2]],
        })
    }
}

/// A cubic Bézier curve in N dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cubic<const N: usize>(pub [[f64; N]; 4]);

/// A point of a curve and its derivatives by the parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvePoint<const N: usize> {
    pub value: [f64; N],
    pub first: [f64; N],
    pub second: [f64; N],
}

impl<const N: usize> Cubic<N> {
    /// The point at a parameter.
    #[inline]
    pub(super) fn at(&self, u: f64) -> CurvePoint<N> {
        let [a, b, c, d] = &self.0;
        let w = 1.0 - u;
        let each = |f: &dyn Fn(usize) -> f64| std::array::from_fn(f);
        CurvePoint {
            value: each(&|i| {
                w * w * w * a[i] + 3.0 * u * w * w * b[i] + 3.0 * u * u * w * c[i] + u * u * u * d[i]
            }),
            first: each(&|i| {
                3.0 * (w * w * (b[i] - a[i]) + 2.0 * u * w * (c[i] - b[i]) + u * u * (d[i] - c[i]))
            }),
            second: each(&|i| 6.0 * (w * (c[i] - 2.0 * b[i] + a[i]) + u * (d[i] - 2.0 * c[i] + b[i]))),
        }
    }

    /// Both halves [de Casteljau].
    #[inline]
    pub(super) fn halves(&self) -> [Self; 2] {
        let [a, b, c, d] = self.0;
        let mid = |p: [f64; N], q: [f64; N]| std::array::from_fn(|i| 0.5 * (p[i] + q[i]));
        let (ab, bc, cd) = (mid(a, b), mid(b, c), mid(c, d));
        let (abc, bcd) = (mid(ab, bc), mid(bc, cd));
        let m = mid(abc, bcd);
        [Self([a, ab, abc, m]), Self([m, bcd, cd, d])]
    }

    /// The part between two parameters, by blossoming.
    pub(super) fn part(&self, u0: f64, u1: f64) -> Self {
        let lerp = |p: [f64; N], q: [f64; N], t: f64| std::array::from_fn(|i| p[i] + (q[i] - p[i]) * t);
        let blossom = |r: f64, s: f64, t: f64| {
            let [a, b, c, d] = self.0;
            let (ab, bc, cd) = (lerp(a, b, r), lerp(b, c, r), lerp(c, d, r));
            lerp(lerp(ab, bc, s), lerp(bc, cd, s), t)
        };
        Self([blossom(u0, u0, u0), blossom(u0, u0, u1), blossom(u0, u1, u1), blossom(u1, u1, u1)])
    }

    /// How often the curve must be halved until its pieces leave their chords by less than `tolerance`.
    ///
    /// # References
    /// [PBRT4, section 6.7.2], after Wang's bound on second differences.
    #[inline]
    pub(super) fn halvings(&self, tolerance: f64, most: u32) -> u32 {
        let bend = (0..2).flat_map(|k| (0..N).map(move |i| (k, i)));
        let bend = bend
            .map(|(k, i)| (self.0[k][i] - 2.0 * self.0[k + 1][i] + self.0[k + 2][i]).abs())
            .fold(0.0, f64::max);
        let ratio = std::f64::consts::SQRT_2 * 6.0 * bend / (8.0 * tolerance);
        if ratio > 1.0 { ((ratio.log2() * 0.5).ceil() as u32).min(most) } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_agree_on_a_straight_line() {
        // Evenly spaced points on a line: B-spline and Catmull-Rom run from the second to the third at constant speed.
        let p = [[0.0], [1.0], [2.0], [3.0]];
        for basis in [Basis::BSpline, Basis::CatmullRom] {
            let at = basis.to_bezier(p).at(0.25);
            assert!((at.value[0] - 1.25).abs() < 1e-12 && (at.first[0] - 1.0).abs() < 1e-12);
        }
        assert_eq!([4, 7, 8].map(|n| Basis::Bezier.segments(n)), [Some(1), Some(2), None]);
        assert_eq!([3, 4, 8].map(|n| Basis::BSpline.segments(n)), [None, Some(1), Some(5)]);
    }

    #[test]
    fn parts_are_the_same_curve() {
        let curve = Cubic([[0.0, 1.0], [2.0, -1.0], [0.5, 3.0], [1.0, 0.0]]);
        let part = curve.part(0.2, 0.7);
        let [low, high] = curve.halves();
        for i in 0..=4 {
            let u = f64::from(i) / 4.0;
            for c in 0..2 {
                assert!((part.at(u).value[c] - curve.at(0.2 + 0.5 * u).value[c]).abs() < 1e-12);
                assert!((low.at(u).value[c] - curve.at(0.5 * u).value[c]).abs() < 1e-12);
                assert!((high.at(u).value[c] - curve.at(0.5 + 0.5 * u).value[c]).abs() < 1e-12);
            }
        }
    }
}
