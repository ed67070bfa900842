//! How much an image file may ask for.

use crate::error::Fault;

/// What an image file may ask for; checked before memory is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageLimits {
    /// Pixels of one image (default 2²⁸, a square of 16384).
    pub max_pixels: u64,
    /// Bytes that one decoded image may take (default 8 GiB: 2²⁸ pixels of eight floats).
    pub max_bytes: u64,
}

impl Default for ImageLimits {
    fn default() -> Self {
        Self { max_pixels: 1 << 28, max_bytes: 8 << 30 }
    }
}

impl ImageLimits {
    /// Checks a size given by an untrusted header; returns the number of values in the image.
    pub(crate) fn check(
        &self,
        width: u64,
        height: u64,
        channels: u64,
        bytes_per_value: u64,
    ) -> Result<usize, Fault> {
        if width == 0 || height == 0 || channels == 0 {
            return Err(Fault::content(format!(
                "it has no pixels ({width} x {height}, {channels} channels)"
            )));
        }
        let pixels = width.saturating_mul(height);
        if pixels > self.max_pixels {
            return Err(Fault::TooLarge {
                what: format!("{width} x {height} pixels"),
                limit: self.max_pixels,
            });
        }
        let bytes = pixels.saturating_mul(channels).saturating_mul(bytes_per_value);
        if bytes > self.max_bytes {
            return Err(Fault::TooLarge { what: format!("{bytes} bytes"), limit: self.max_bytes });
        }
        usize::try_from(pixels * channels)
            .map_err(|_| Fault::TooLarge { what: format!("{bytes} bytes"), limit: usize::MAX as u64 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_sizes_do_not_overflow() {
        let limits = ImageLimits::default();
        assert_eq!(limits.check(1920, 1080, 3, 4).unwrap(), 1920 * 1080 * 3);
        assert!(matches!(limits.check(u64::MAX, u64::MAX, 4, 4), Err(Fault::TooLarge { .. })));
        assert!(matches!(limits.check(1 << 14, 1 << 14, u64::MAX, 4), Err(Fault::TooLarge { .. })));
        assert!(matches!(limits.check(0, 5, 3, 4), Err(Fault::Content(_))));
    }
}
