//! One number per pixel.

use crate::Image;
use crate::metric::Colormap;

/// The error of every pixel, rows from top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl ErrorMap {
    /// `values` has `width * height` numbers.
    pub(crate) fn new(width: usize, height: usize, values: Vec<f32>) -> Self {
        debug_assert_eq!(values.len(), width * height);
        Self { width, height, values }
    }

    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The errors, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The mean error; errors that are not finite are left out.
    pub fn mean(&self) -> f64 {
        let finite = self.values.iter().filter(|value| value.is_finite());
        let (sum, n) = finite.fold((0.0, 0_usize), |(sum, n), &value| (sum + f64::from(value), n + 1));
        sum / n.max(1) as f64
    }

    /// The largest finite error.
    pub fn max(&self) -> f32 {
        self.values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f32::max)
    }

    /// A picture of the errors: `white` and beyond get the last colour; what is not finite is a bright cyan.
    pub fn to_image(&self, colormap: Colormap, white: f32) -> Image {
        let mut image = Image::new(self.width, self.height, &["R", "G", "B"]);
        let scale = if white > 0.0 { 1.0 / white } else { 0.0 };
        for (pixel, &value) in image.data_mut().as_chunks_mut().0.iter_mut().zip(&self.values) {
            *pixel = if value.is_finite() { colormap.linear(value * scale) } else { [0.0, 1.0, 1.0] };
        }
        image
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_is_left_out_and_shown() {
        let map = ErrorMap::new(2, 2, vec![1.0, f32::NAN, 3.0, f32::INFINITY]);
        assert_eq!((map.mean(), map.max()), (2.0, 3.0));
        assert_eq!(map.to_image(Colormap::Magma, 3.0).rgb(1, 0), [0.0, 1.0, 1.0]);
    }
}
