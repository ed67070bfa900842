//! Pictures of luminance and chroma.
//!
//! [OpenEXR] "Technical Introduction to OpenEXR", Luminance/Chroma Images: RY = (R - Y) / Y, BY = (B - Y) / Y, and Y the
//! luminance by the file's primaries. The chroma often has a quarter of the samples.

use aureole_spectrum::Primaries;

use crate::raster::{Raster, Texels};

/// Turns `Y`, `RY`, `BY` into `R`, `G`, `B`; anything else stays as it is.
pub(super) fn to_rgb(raster: &mut Raster, primaries: Primaries) {
    let find = |name: &str| raster.channels.iter().position(|channel| channel == name);
    let [Some(ry), Some(y), Some(by)] = ["RY", "Y", "BY"].map(find) else { return };
    let Some([red, green, blue]) = primaries.luminance() else { return };
    let stride = raster.channels.len();
    for (place, name) in [(ry, "R"), (y, "G"), (by, "B")] {
        name.clone_into(&mut raster.channels[place]);
    }
    let mut data = std::mem::replace(&mut raster.texels, Texels::Floats(Vec::new())).into_floats();
    for pixel in data.chunks_exact_mut(stride) {
        let luminance = f64::from(pixel[y]);
        let r = (f64::from(pixel[ry]) + 1.0) * luminance;
        let b = (f64::from(pixel[by]) + 1.0) * luminance;
        let g = (luminance - red * r - blue * b) / green;
        (pixel[ry], pixel[y], pixel[by]) = (r as f32, g as f32, b as f32);
    }
    raster.texels = Texels::Floats(data);
}
