//! `goniometric`: light from one point whose intensity depends on direction, by a picture or by measured tables.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `intensity` | spectrum | 1 | factor of what follows, W/sr |
//! | `filename` | path | | a square picture in the equal-area mapping, its middle towards +Z; its mean over the channels counts |
//! | `vertical` | floats | | instead of a picture: ascending angles from +Z, degrees |
//! | `horizontal` | floats | 0 | ascending angles around +Z from +X, degrees |
//! | `candela` | floats | | intensity for each horizontal angle, for each vertical one |
//! | `power` | float | 0 | if positive: scale to this power, W |
//! | `world_from_light` | transform | identity | |
//!
//! Tables are as in IES files (LM-63): horizontal angles that end at 0°, 90° or 180° stand for a light that is the same all
//! around, in every quadrant or on both sides. Between angles intensity is linear; beyond the vertical ones there is none.

use std::f32::consts::PI;
use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_image::{Bitmap, Encoding};
use aureole_math::{Bounds3, Point2, Point3, Transform, Vector3, warp};
use aureole_spectrum::{PreparedSpectrum, SpectrumRole, Wavelengths, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver};

/// A point light with a distribution over directions.
#[derive(Clone, Debug)]
pub struct Goniometric {
    light_from_world: Transform,
    position: Point3,
    intensity: PreparedSpectrum,
    scale: f32,
    diagram: Diagram,
    /// Mean of the diagram over the sphere.
    mean: f32,
}

/// Relative intensity over directions.
#[derive(Clone, Debug)]
enum Diagram {
    Picture(Arc<Bitmap>),
    Table { vertical: Arc<[f32]>, horizontal: Arc<[f32]>, candela: Arc<[f32]> },
}

impl Diagram {
    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("filename");
        if let Some(path) = params.try_path("filename")? {
            return Ok(Self::Picture(resolver.bitmap(&path, Encoding::Auto, at)?));
        }
        let at = params.span("candela");
        let vertical = params.try_floats("vertical")?.unwrap_or_default();
        let horizontal = params.try_floats("horizontal")?.unwrap_or_else(|| [0.0].into());
        let candela = params.try_floats("candela")?.ok_or_else(|| SceneError::MissingParam {
            element: "goniometric".into(),
            param: "filename".into(),
            wanted: "a picture, or tables of angles and intensities".into(),
            at: Span::NONE,
        })?;
        let ascends = |list: &[f32]| list.windows(2).all(|pair| pair[0] < pair[1]);
        let is_whole = !vertical.is_empty() && candela.len() == vertical.len() * horizontal.len();
        if !is_whole || !ascends(&vertical) || !ascends(&horizontal) {
            let message = "`candela` needs an intensity for each pair of angles, and angles that ascend";
            return Err(SceneError::invalid(message, at));
        }
        Ok(Self::Table { vertical, horizontal, candela })
    }

    /// The value in a unit direction of the light's space.
    fn value(&self, w: Vector3) -> f32 {
        match self {
            Self::Picture(picture) => lookup(picture, warp::square_from_sphere_equal_area(w)),
            Self::Table { vertical, horizontal, candela } => {
                let theta = warp::polar_angle(w).to_degrees();
                if theta < vertical[0] - 1e-3 || theta > vertical[vertical.len() - 1] + 1e-3 {
                    return 0.0;
                }
                let last = horizontal[horizontal.len() - 1];
                let (v, tv) = bracket(vertical, theta);
                let (h, th) = bracket(horizontal, fold(warp::azimuth(w.y, w.x).to_degrees(), last));
                let at = |h: usize, v: usize| candela[h * vertical.len() + v];
                let [low, high] = h.map(|h| at(h, v[0]) + (at(h, v[1]) - at(h, v[0])) * tv);
                low + (high - low) * th
            }
        }
    }

    /// The mean over the sphere, by a fine grid of equal solid angles.
    fn mean(&self) -> f32 {
        const N: usize = 256;
        let cell = |i: usize| {
            let z = 1.0 - 2.0 * ((i / N) as f32 + 0.5) / N as f32;
            let (sin, cos) = (2.0 * PI * ((i % N) as f32 + 0.5) / N as f32).sin_cos();
            let r = (1.0 - z * z).sqrt();
            f64::from(self.value(Vector3::new(r * cos, r * sin, z)))
        };
        ((0..N * N).map(cell).sum::<f64>() / (N * N) as f64) as f32
    }
}

/// An azimuth brought into the range that a table ending at `last` covers by its symmetry.
fn fold(phi: f32, last: f32) -> f32 {
    if last <= 0.0 {
        0.0
    } else if last <= 180.0 {
        // A mirror at both ends, half a turn or a quarter apart.
        let period = 2.0 * last;
        let p = phi.rem_euclid(period);
        if p > last { period - p } else { p }
    } else {
        phi
    }
}

/// The two entries of an ascending list around `x`, and the share of the second.
fn bracket(list: &[f32], x: f32) -> ([usize; 2], f32) {
    let high = list.partition_point(|&a| a <= x).min(list.len() - 1);
    let low = list.partition_point(|&a| a <= x).saturating_sub(1);
    let width = list[high] - list[low];
    ([low, high], if width > 0.0 { ((x - list[low]) / width).clamp(0.0, 1.0) } else { 0.0 })
}

/// The mean of the channels of a picture, interpolated.
fn lookup(picture: &Bitmap, uv: Point2) -> f32 {
    let (w, h) = (picture.width() as i64, picture.height() as i64);
    let texel = |x: i64, y: i64| {
        let [r, g, b] = picture.rgb(x.clamp(0, w - 1) as usize, y.clamp(0, h - 1) as usize);
        (r + g + b) / 3.0
    };
    let (x, y) = (uv.x * w as f32 - 0.5, uv.y * h as f32 - 0.5);
    let (x0, y0) = (x.floor(), y.floor());
    let row = |j: i64| {
        let (a, b) = (texel(x0 as i64, y0 as i64 + j), texel(x0 as i64 + 1, y0 as i64 + j));
        a + (b - a) * (x - x0)
    };
    let (top, bottom) = (row(0), row(1));
    top + (bottom - top) * (y - y0)
}

impl Element for Goniometric {
    const SUMMARY: &'static str =
        "Light from one point by a diagram over directions: a picture or measured tables.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "intensity", ty: "spectrum", default: "1", doc: "factor, W/sr" },
        ParamDoc { name: "filename", ty: "path", default: "", doc: "a picture in the equal-area mapping" },
        ParamDoc { name: "vertical", ty: "floats", default: "", doc: "angles from +Z, degrees" },
        ParamDoc { name: "horizontal", ty: "floats", default: "0", doc: "angles around +Z, degrees" },
        ParamDoc { name: "candela", ty: "floats", default: "", doc: "intensities, vertical angles fastest" },
        ParamDoc { name: "power", ty: "float", default: "0", doc: "if positive: scale to this power, W" },
        ParamDoc {
            name: "world_from_light",
            ty: "transform",
            default: "identity",
            doc: "where the light is",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let place = params.transform("world_from_light")?;
        let diagram = Diagram::from_params(params, resolver)?;
        let mean = diagram.mean();
        let power = params.float("power", 0.0)?;
        let intensity = params.spectrum("intensity", 1.0)?.prepare(SpectrumRole::Illuminant);
        let unscaled = luminance(intensity.eval(&Wavelengths::RGB).rgb()) * mean * 4.0 * PI;
        Ok(Self {
            light_from_world: place.inverse(),
            position: place.point(Point3::ORIGIN),
            intensity,
            scale: if power > 0.0 && unscaled > 0.0 { power / unscaled } else { 1.0 },
            diagram,
            mean,
        })
    }
}

impl LightOps for Goniometric {
    fn sample(&self, at: &LightContext<'_>, reference: Point3, _: Point2) -> Option<LightSample> {
        let d = self.position - reference;
        let d2 = d.length_squared();
        let wi = d.try_normalized()?;
        let value = self.diagram.value(self.light_from_world.vector(-wi).try_normalized()?);
        (value != 0.0).then(|| LightSample {
            wi,
            target: Some(self.position),
            radiance: self.intensity.eval(&at.wavelengths) * (self.scale * value / d2),
            pdf_omega: 1.0,
            is_delta: true,
        })
    }

    fn power(&self, _: &LightContext<'_>, _: &Bounds3) -> f32 {
        luminance(self.intensity.eval(&Wavelengths::RGB).rgb()) * self.scale * self.mean * 4.0 * PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetry_folds_the_horizon() {
        assert_eq!([10.0, 170.0, 190.0, 350.0].map(|phi| fold(phi, 90.0)), [10.0; 4]);
        assert_eq!([10.0, 350.0].map(|phi| fold(phi, 180.0)), [10.0; 2]);
        assert_eq!(fold(250.0, 360.0), 250.0);
        assert_eq!(fold(250.0, 0.0), 0.0);
    }

    #[test]
    fn tables_are_linear_between_their_angles() {
        let table = Diagram::Table {
            vertical: [0.0, 90.0].into(),
            horizontal: [0.0, 180.0].into(),
            candela: [4.0, 0.0, 8.0, 4.0].into(),
        };
        let at = |theta: f32, phi: f32| {
            table.value(aureole_math::spherical_direction(theta.to_radians(), phi.to_radians()))
        };
        assert!((at(45.0, 0.0) - 2.0).abs() < 1e-4 && (at(45.0, 180.0) - 6.0).abs() < 1e-4);
        assert!((at(45.0, 90.0) - 4.0).abs() < 1e-4 && (at(45.0, 270.0) - 4.0).abs() < 1e-4);
        assert_eq!(at(100.0, 0.0), 0.0);
    }
}
