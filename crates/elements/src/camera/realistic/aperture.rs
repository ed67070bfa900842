//! What passes the stop of a lens.

use std::f64::consts::{E, PI, TAU};

use aureole_desc::{Params, SceneError};
use aureole_image::{Bitmap, Encoding};

use crate::Resolver;

/// The shape of the stop's opening, in units of its radius.
///
/// All but the circle are scaled so that as much light passes as through the circle.
#[derive(Clone, Debug)]
pub(super) enum Aperture {
    Circular,
    Gaussian,
    Polygon {
        corners: Vec<[f64; 2]>,
        scale: f64,
    },
    /// Rows from the top of the square around the circle, with the right of the image at the right.
    Picture {
        width: usize,
        height: usize,
        values: Vec<f32>,
    },
}

impl Aperture {
    pub(super) fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("aperture_picture");
        if let Some(path) = params.try_path("aperture_picture")? {
            let picture = resolver.bitmap(&path, Encoding::Auto, at)?;
            return Self::picture(&picture)
                .ok_or_else(|| SceneError::invalid("no light passes this picture of an aperture", at));
        }
        params
            .one_of::<fn() -> Self>(
                "aperture",
                &[
                    ("circular", || Self::Circular),
                    ("gaussian", || Self::Gaussian),
                    ("square", || {
                        Self::polygon(4, 0.5_f64.sqrt(), |i| PI / 4.0 + TAU * f64::from(i) / 4.0, 1.0)
                    }),
                    ("pentagon", || Self::polygon(5, 0.8, |i| TAU * (f64::from(i) / 5.0 - 0.25), 1.0)),
                    // The five sides of a pentagram meet in points this much nearer to its middle than its tips are.
                    ("star", || {
                        Self::polygon(
                            10,
                            1.0,
                            |i| PI * f64::from(i) / 5.0,
                            (TAU / 5.0).cos() / (PI / 5.0).cos(),
                        )
                    }),
                ],
            )
            .map(|make| make())
    }

    /// Corners at a distance from the middle, every second one nearer by a factor.
    fn polygon(count: u32, radius: f64, angle: impl Fn(u32) -> f64, second: f64) -> Self {
        let corners: Vec<[f64; 2]> = (0..count)
            .map(|i| {
                let radius = if i % 2 == 1 { radius * second } else { radius };
                [radius * angle(i).cos(), radius * angle(i).sin()]
            })
            .collect();
        let area: f64 = sides(&corners).map(|[a, b]| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum();
        Self::Polygon { corners, scale: PI / area }
    }

    /// The mean of a picture's colours; `None` for a black one.
    fn picture(bitmap: &Bitmap) -> Option<Self> {
        let (width, height) = (bitmap.width(), bitmap.height());
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let values: Vec<f32> =
            texels.map(|(x, y)| bitmap.rgb(x, y).iter().sum::<f32>().max(0.0) / 3.0).collect();
        let mean = values.iter().map(|&x| f64::from(x)).sum::<f64>() / values.len() as f64;
        let scale = (PI / 4.0 / mean) as f32;
        (mean > 0.0 && scale.is_finite()).then(|| Self::Picture {
            width,
            height,
            values: values.iter().map(|x| x * scale).collect(),
        })
    }

    /// How far from the middle light may pass.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::Circular | Self::Gaussian | Self::Polygon { .. } => 1.0,
            Self::Picture { .. } => 2.0_f64.sqrt(),
        }
    }

    /// How much light passes at a place.
    pub(super) fn transmittance(&self, p @ [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::Circular => f64::from(u8::from(x * x + y * y <= 1.0)),
            // Falls to zero at the rim; the integral over the circle of exp(-r²) - 1/e is π (1 - 2/e).
            Self::Gaussian => ((-x * x - y * y).exp() - 1.0 / E).max(0.0) / (1.0 - 2.0 / E),
            Self::Polygon { corners, scale } => {
                if is_inside(corners, p) {
                    *scale
                } else {
                    0.0
                }
            }
            Self::Picture { width, height, values } => {
                // The right of the image is at negative x.
                let (u, v) = (0.5 - 0.5 * x, 0.5 - 0.5 * y);
                bilinear(values, [*width, *height], [u, v])
            }
        }
    }
}

fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1)).map(|(a, b)| [a, b])
}

/// Whether a line from a place to the right leaves a polygon once more than it enters.
fn is_inside(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let crosses = |[a, b]: &[[f64; 2]; 2]| {
        (a[1] <= y) != (b[1] <= y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
    };
    sides(corners).filter(crosses).count() % 2 == 1
}

/// A picture's value at a place in the unit square; black around it.
fn bilinear(values: &[f32], [width, height]: [usize; 2], [u, v]: [f64; 2]) -> f64 {
    let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
    let (x0, y0) = (x.floor(), y.floor());
    let value = |x: f64, y: f64| {
        let inside = (0.0..width as f64).contains(&x) && (0.0..height as f64).contains(&y);
        if inside { f64::from(values[y as usize * width + x as usize]) } else { 0.0 }
    };
    let (dx, dy) = (x - x0, y - y0);
    (1.0 - dy) * ((1.0 - dx) * value(x0, y0) + dx * value(x0 + 1.0, y0))
        + dy * ((1.0 - dx) * value(x0, y0 + 1.0) + dx * value(x0 + 1.0, y0 + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Aperture {
        let mut params = Params::new().with("aperture", aureole_desc::Value::String(name.into()));
        Aperture::from_params(&mut params, &mut crate::element::tests::NoResolver::default())
            .expect("is known")
    }

    /// As much light passes as through the circle, and none beyond the reach.
    #[test]
    fn all_shapes_pass_as_much_light_as_the_circle() {
        let bitmap = Bitmap::from_floats(3, 2, 1, vec![0.0, 3.0, 1.0, 2.0, 0.5, 9.0], Encoding::Linear)
            .expect("six values");
        let picture = Aperture::picture(&bitmap).expect("is not black");
        let shapes = ["circular", "gaussian", "square", "pentagon", "star"].map(named);
        for shape in shapes.iter().chain([&picture]) {
            // The sides of the square lie between columns.
            const N: i32 = 999;
            let place = |i: i32| 1.5 * (2.0 * f64::from(i) + 1.0 - f64::from(N)) / f64::from(N);
            let mut sum = 0.0;
            for p in (0..N * N).map(|i| [place(i % N), place(i / N)]) {
                let t = shape.transmittance(p);
                // A picture's border is blurred by half a texel.
                let blurred = matches!(shape, Aperture::Picture { .. });
                assert!(t == 0.0 || blurred || p[0].hypot(p[1]) <= shape.reach(), "{p:?}");
                sum += t * (3.0 / f64::from(N)).powi(2);
            }
            assert!((sum / PI - 1.0).abs() < 2e-3, "{shape:?}: {sum}");
        }
    }

    /// Where pbrt's rasters have their corners: its pictures of shapes are upside down, and its right is at -x.
    #[test]
    fn shapes_point_where_pbrt_points_them() {
        let is_open = |name: &str, p: [f64; 2]| named(name).transmittance(p) > 0.0;
        assert!(is_open("pentagon", [0.0, -0.79]) && !is_open("pentagon", [0.0, 0.79]));
        assert!(is_open("pentagon", [0.0, 0.64]) && !is_open("pentagon", [0.0, 0.66]));
        assert!(is_open("star", [0.99, 0.0]) && !is_open("star", [-0.99, 0.0]));
        assert!(is_open("star", [-0.38, 0.0]) && !is_open("star", [-0.39, 0.0]));
        assert!(is_open("square", [0.49, -0.49]) && !is_open("square", [0.51, 0.0]));
        let picture = Aperture::picture(
            &Bitmap::from_floats(2, 2, 1, vec![0.0, 1.0, 0.0, 0.0], Encoding::Linear).expect("four"),
        );
        // Bright at the top right.
        let at = |p| picture.as_ref().expect("is not black").transmittance(p);
        assert!(at([-0.5, 0.5]) > 3.0 && at([0.5, 0.5]) == 0.0 && at([-0.5, -0.5]) == 0.0);
    }
}
