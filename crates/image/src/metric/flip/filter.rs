//! The filters of the metric: contrast sensitivity, edges and points. All are sums of products of one filter across and one
//! down, which turns thousands of multiplications a pixel into dozens.

use std::f32::consts::PI;

use rayon::prelude::*;

/// One number a pixel.
pub(super) struct Plane {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Plane {
    pub(super) fn new(width: usize, height: usize, values: Vec<f32>) -> Self {
        Self { width, height, values }
    }

    /// Filters across by one kernel and down by another; beyond its border the picture goes on with the border's value.
    fn convolved(&self, across: &[f32], down: &[f32]) -> Vec<f32> {
        let (width, height) = (self.width, self.height);
        let mut rows = vec![0.0; self.values.len()];
        rows.par_chunks_mut(width).zip(self.values.par_chunks(width)).for_each(|(to, from)| {
            let radius = across.len() / 2;
            for (x, to) in to.iter_mut().enumerate() {
                let tap =
                    |(i, weight): (usize, &f32)| weight * from[(x + i).saturating_sub(radius).min(width - 1)];
                *to = across.iter().enumerate().map(tap).sum();
            }
        });
        let mut out = vec![0.0; self.values.len()];
        out.par_chunks_mut(width).enumerate().for_each(|(y, to)| {
            let radius = down.len() / 2;
            for (i, weight) in down.iter().enumerate() {
                let from = (y + i).saturating_sub(radius).min(height - 1) * width;
                to.iter_mut().zip(&rows[from..from + width]).for_each(|(to, from)| *to += weight * from);
            }
        });
        out
    }
}

/// A Gaussian in the frequency domain: its height and width (table 1 of the paper).
#[derive(Clone, Copy)]
struct Lobe {
    a: f32,
    b: f32,
}

const ACHROMATIC: Lobe = Lobe { a: 1.0, b: 0.0047 };
const RED_GREEN: Lobe = Lobe { a: 1.0, b: 0.0053 };
const BLUE_YELLOW: [Lobe; 2] = [Lobe { a: 34.1, b: 0.04 }, Lobe { a: 13.5, b: 0.025 }];

/// The eye's blur of one opponent channel (equations 1 to 3).
pub(super) struct ContrastFilter {
    /// Kernels, each for both directions, and their shares of the sum.
    lobes: Vec<(Vec<f32>, f32)>,
}

impl ContrastFilter {
    pub(super) fn achromatic(pixels_per_degree: f32) -> Self {
        Self::new(&[ACHROMATIC], pixels_per_degree)
    }

    pub(super) fn red_green(pixels_per_degree: f32) -> Self {
        Self::new(&[RED_GREEN], pixels_per_degree)
    }

    pub(super) fn blue_yellow(pixels_per_degree: f32) -> Self {
        Self::new(&BLUE_YELLOW, pixels_per_degree)
    }

    fn new(lobes: &[Lobe], pixels_per_degree: f32) -> Self {
        // Three standard deviations of the widest lobe of all.
        let widest = BLUE_YELLOW[0].b;
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
        let kernels = lobes.iter().map(|lobe| {
            let mut kernel: Vec<f32> = (-radius..=radius)
                .map(|i| {
                    let x = i as f32 / pixels_per_degree;
                    (-PI * PI * x * x / lobe.b).exp()
                })
                .collect();
            let sum: f32 = kernel.iter().sum();
            kernel.iter_mut().for_each(|weight| *weight /= sum);
            (kernel, lobe.a * (PI / lobe.b).sqrt() * sum * sum)
        });
        let mut lobes: Vec<_> = kernels.collect();
        let total: f32 = lobes.iter().map(|(_, share)| share).sum();
        lobes.iter_mut().for_each(|(_, share)| *share /= total);
        Self { lobes }
    }

    pub(super) fn apply(&self, plane: &Plane) -> Vec<f32> {
        let mut out = vec![0.0; plane.values.len()];
        for (kernel, share) in &self.lobes {
            let blurred = plane.convolved(kernel, kernel);
            out.iter_mut().zip(blurred).for_each(|(to, from)| *to += share * from);
        }
        out
    }
}

/// The strength of edges and of points at every pixel: lengths of the first and second derivatives of a Gaussian-blurred
/// picture along both axes (section 4.2).
pub(super) fn feature_magnitudes(plane: &Plane, pixels_per_degree: f32) -> (Vec<f32>, Vec<f32>) {
    /// The width of the eye's edge detector in degrees, from peak to trough.
    const WIDTH: f32 = 0.082;
    let deviation = 0.5 * WIDTH * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as i32;
    let kernel = |weight: &dyn Fn(f32) -> f32| -> Vec<f32> {
        let gaussian = |x: f32| (-x * x / (2.0 * deviation * deviation)).exp();
        balanced((-radius..=radius).map(|i| weight(i as f32) * gaussian(i as f32)).collect())
    };
    let blur = kernel(&|_| 1.0);
    let magnitude = |derivative: &[f32]| {
        let (across, down) = (plane.convolved(derivative, &blur), plane.convolved(&blur, derivative));
        across.into_par_iter().zip(down).map(|(x, y)| x.hypot(y)).collect()
    };
    let edge = kernel(&|x| -x);
    let point = kernel(&|x| x * x / (deviation * deviation) - 1.0);
    (magnitude(&edge), magnitude(&point))
}

/// Scales the positive weights to a sum of 1 and the negative ones to -1.
fn balanced(mut kernel: Vec<f32>) -> Vec<f32> {
    let positive: f32 = kernel.iter().filter(|&&weight| weight > 0.0).sum();
    let negative: f32 = kernel.iter().filter(|&&weight| weight < 0.0).sum();
    for weight in &mut kernel {
        if *weight > 0.0 {
            *weight /= positive;
        } else if *weight < 0.0 {
            *weight /= -negative;
        }
    }
    kernel
}
