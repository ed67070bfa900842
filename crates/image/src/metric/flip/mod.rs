//! ꟻLIP: what an eye notices when two pictures alternate on a screen.
//!
//! [Andersson 2020] P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2) (HPG). The equations' numbers below
//! are the paper's.

mod color;
mod filter;

use rayon::prelude::*;

use self::color::{achromatic, hunt_lab, hyab, linear_from_opponent, opponent_from_linear};
use self::filter::{ContrastFilter, Plane, feature_magnitudes};
use crate::metric::ErrorMap;
use crate::{Image, ImageError, ToneMapping};

/// Pixels in a degree of sight: a screen of 3840 pixels on 0.7 m, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = 67.020_64;

/// Exponent of the colour difference (equation 6).
const Q_C: f32 = 0.7;
/// Exponent of the feature difference (equation 9).
const Q_F: f32 = 0.5;
/// Where the compression of large colour differences starts, as a fraction of the largest one, and what it is mapped to.
const P_C: f32 = 0.4;
const P_T: f32 = 0.95;

/// The visible difference of every pixel, from 0 (none) to 1, and with [`ErrorMap::mean`] that of the pictures.
///
/// Both images are shown through `tone` on an sRGB display.
///
/// # Errors
/// [`ImageError::Mismatch`] if the sizes differ or `pixels_per_degree` is not a positive number.
pub fn flip(
    reference: &Image,
    image: &Image,
    tone: &ToneMapping,
    pixels_per_degree: f32,
) -> Result<ErrorMap, ImageError> {
    reference.check_same_size(image)?;
    if !(pixels_per_degree > 0.0 && pixels_per_degree < 1e4) {
        return Err(ImageError::Mismatch(format!("{pixels_per_degree} pixels a degree cannot be seen")));
    }
    let (a, b) = (Seen::new(reference, tone, pixels_per_degree), Seen::new(image, tone, pixels_per_degree));
    let max_difference = hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])).powf(Q_C);
    let values = (0..a.colors.len())
        .into_par_iter()
        .map(|i| {
            let color = compress(hyab(a.colors[i], b.colors[i]).powf(Q_C), max_difference);
            let feature = (a.edges[i] - b.edges[i]).abs().max((a.points[i] - b.points[i]).abs());
            let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).powf(Q_F).clamp(0.0, 1.0);
            color.powf(1.0 - feature)
        })
        .collect();
    Ok(ErrorMap::new(reference.width(), reference.height(), values))
}

/// Maps a colour difference to [0, 1], leaving little room for those beyond what pictures have (section 4.1.3).
fn compress(difference: f32, max_difference: f32) -> f32 {
    let knee = P_C * max_difference;
    if difference < knee {
        P_T / knee * difference
    } else {
        P_T + (difference - knee) / (max_difference - knee) * (1.0 - P_T)
    }
}

/// What the eye makes of one picture.
struct Seen {
    /// Colours after the eye's blur, in Hunt-adjusted L*a*b*.
    colors: Vec<[f32; 3]>,
    /// Strength of edges and of points.
    edges: Vec<f32>,
    points: Vec<f32>,
}

impl Seen {
    fn new(image: &Image, tone: &ToneMapping, pixels_per_degree: f32) -> Self {
        let (width, height) = (image.width(), image.height());
        let opponent: Vec<[f32; 3]> = image
            .to_rgb()
            .into_par_iter()
            .map(|rgb| opponent_from_linear(color::displayed(rgb, tone)))
            .collect();
        let plane = |c: usize| Plane::new(width, height, opponent.iter().map(|color| color[c]).collect());
        let blurred = [
            ContrastFilter::achromatic(pixels_per_degree).apply(&plane(0)),
            ContrastFilter::red_green(pixels_per_degree).apply(&plane(1)),
            ContrastFilter::blue_yellow(pixels_per_degree).apply(&plane(2)),
        ];
        let colors = (0..opponent.len())
            .into_par_iter()
            .map(|i| {
                let rgb = linear_from_opponent([0, 1, 2].map(|c| blurred[c][i]));
                hunt_lab(rgb.map(|x| x.clamp(0.0, 1.0)))
            })
            .collect();
        let lightness = Plane::new(width, height, opponent.iter().map(|&color| achromatic(color)).collect());
        let (edges, points) = feature_magnitudes(&lightness, pixels_per_degree);
        Self { colors, edges, points }
    }
}

#[cfg(test)]
mod tests;
