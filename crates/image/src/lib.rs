//! Pixel buffers, codecs, tone curves, image metrics.
