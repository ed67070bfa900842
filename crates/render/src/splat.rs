//! Which pixels a sample adds to, and how much.
//!
//! A filter of more than one pixel covers samples of neighbouring pixels: each sample is drawn evenly in its pixel and
//! shared by all pixels whose filter covers it. At equal samples that leaves a third of the variance of samples that belong
//! to one pixel (for a Gaussian of standard deviation one half: 4π σ² = 3.14 times less). Filters of one pixel, and very
//! wide ones, are drawn from instead [Ernst et al. 2006].

use aureole_elements::Filter;
use aureole_math::{Point2, Vector2};
use aureole_scene::Scene;

/// The most pixels beside its own that a sample adds to along an axis.
const MOST: usize = 4;
/// Steps of a table from a filter's middle to its edge: finer than single precision sees.
const STEPS: usize = 4096;

/// How much a sample counts along one axis, for its own pixel and those beside it.
type Weights = [f32; 2 * MOST + 1];

/// A sample's place in its pixel and its weights around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    /// From the pixel's centre, in pixels.
    pub(crate) offset: Vector2,
    /// The middle of each is for the sample's own pixel.
    pub(crate) weights: [Weights; 2],
}

impl Footprint {
    /// All weights of an axis that has so many pixels on each side.
    #[inline]
    pub(crate) fn along(&self, axis: usize, border: u32) -> &[f32] {
        let border = (border as usize).min(MOST);
        &self.weights[axis][MOST - border..=MOST + border]
    }

    /// The weight for the sample's own pixel.
    pub(crate) fn own(&self) -> f32 {
        self.weights[0][MOST] * self.weights[1][MOST]
    }
}

/// Places samples by a scene's filter.
#[derive(Debug)]
pub(crate) struct Splatter {
    /// Profiles of a filter that is shared; none where it is drawn from.
    profiles: Option<[Profile; 2]>,
}

/// One factor of a filter, from its middle to its edge, with an integral of one.
#[derive(Debug)]
struct Profile {
    per_pixel: f32,
    border: usize,
    values: Vec<f32>,
}

impl Profile {
    /// Filters are products of an even function of x and one of y.
    fn new(radius: f32, border: u32, eval: impl Fn(f32) -> f32) -> Option<Self> {
        let step = radius / STEPS as f32;
        let mut values: Vec<f32> = (0..STEPS).map(|i| eval((i as f32 + 0.5) * step)).collect();
        let half = values.iter().map(|&x| f64::from(x)).sum::<f64>() * f64::from(step);
        if !(half.is_finite() && half.abs() > 1e-6) {
            return None;
        }
        values.iter_mut().for_each(|x| *x = (f64::from(*x) / (2.0 * half)) as f32);
        Some(Self { per_pixel: 1.0 / step, border: border as usize, values })
    }

    #[inline]
    fn at(&self, distance: f32) -> f32 {
        self.values.get((distance.abs() * self.per_pixel) as usize).copied().unwrap_or(0.0)
    }

    #[inline]
    fn weights(&self, offset: f32) -> Weights {
        let mut weights = [0.0; 2 * MOST + 1];
        let middle = MOST - self.border..=MOST + self.border;
        for (i, weight) in weights[middle].iter_mut().enumerate() {
            *weight = self.at(i as f32 - self.border as f32 - offset);
        }
        weights
    }
}

impl Splatter {
    pub(crate) fn new(scene: &Scene) -> Self {
        Self { profiles: profiles(&scene.filter, scene.film.border) }
    }

    /// Where a sample lies in its pixel, and what it adds around.
    #[inline]
    pub(crate) fn place(&self, filter: &Filter, u: Point2) -> Footprint {
        match &self.profiles {
            Some([x, y]) => {
                let offset = Vector2::new(u.x - 0.5, u.y - 0.5);
                Footprint { offset, weights: [x.weights(offset.x), y.weights(offset.y)] }
            }
            None => {
                let drawn = filter.sample(u);
                let mut weights = [[0.0; 2 * MOST + 1]; 2];
                weights[0][MOST] = drawn.weight;
                weights[1][MOST] = 1.0;
                Footprint { offset: Vector2::new(drawn.offset.x, drawn.offset.y), weights }
            }
        }
    }
}

fn profiles(filter: &Filter, [bx, by]: [u32; 2]) -> Option<[Profile; 2]> {
    if bx.max(by) == 0 || bx.max(by) as usize > MOST {
        return None;
    }
    let radius = filter.radius();
    Some([
        Profile::new(radius.x, bx, |x| filter.eval(Vector2::new(x, 0.0)))?,
        Profile::new(radius.y, by, |y| filter.eval(Vector2::new(0.0, y)))?,
    ])
}

#[cfg(test)]
mod tests {
    use aureole_desc::{Report, SceneDesc};
    use aureole_math::Pcg32;
    use aureole_scene::{CompileOptions, compile};

    use super::*;

    fn scene(kind: &str) -> Scene {
        let mut desc = SceneDesc::default();
        desc.set("filter.kind", kind).unwrap();
        compile(&desc, &CompileOptions::default(), &mut Report::default()).unwrap()
    }

    /// What [`Profile`] takes for granted.
    #[test]
    fn filters_are_products_of_even_functions() {
        for kind in Filter::KINDS {
            let filter = scene(kind).filter;
            let (r, middle) = (filter.radius(), filter.eval(Vector2::ZERO));
            let mut rng = Pcg32::new(1);
            for _ in 0..1000 {
                let at = Vector2::new((2.0 * rng.next_f32() - 1.0) * r.x, (2.0 * rng.next_f32() - 1.0) * r.y);
                let product = filter.eval(Vector2::new(at.x, 0.0)) * filter.eval(Vector2::new(0.0, -at.y));
                assert!((filter.eval(at) - product / middle).abs() < 1e-4 * middle.abs(), "{kind} {at:?}");
            }
        }
    }

    /// A pixel's weights sum to the number of samples; the mean of 100,000 is within 1 % of it.
    #[test]
    fn weights_have_a_mean_of_one() {
        for kind in Filter::KINDS {
            let scene = scene(kind);
            let splatter = Splatter::new(&scene);
            let mut rng = Pcg32::new(2);
            let n = 100_000;
            let sum = |footprint: Footprint| {
                let [x, y] = footprint.weights.map(|weights| weights.iter().sum::<f32>());
                f64::from(x * y)
            };
            let mean =
                (0..n).map(|_| sum(splatter.place(&scene.filter, rng.point2()))).sum::<f64>() / f64::from(n);
            assert!((mean - 1.0).abs() < 0.01, "{kind}: {mean}");
        }
    }
}
