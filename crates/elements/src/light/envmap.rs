//! `envmap`: surroundings from a picture, importance-sampled.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `filename` | path | | EXR, HDR, ... |
//! | `scale` | float | 1 | factor |
//! | `tint` | spectrum | 1 | another factor |
//! | `illuminance` | float | 0 | if positive: `scale` is relative to this irradiance of a plane that faces the light's +Z |
//! | `mapping` | string | latlong | `latlong` (+Y up, the left border towards −Z) or `equal_area` (pbrt-v4, +Z up) |
//! | `filter` | string | bilinear | between texels: `bilinear`, or the `nearest` one (pbrt) |
//! | `world_from_light` | transform | identity | |

use std::f32::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_image::{Bitmap, Encoding};
use aureole_math::{Bounds3, PiecewiseConstant2D, Point2, Point3, Transform, Vector3, warp};
use aureole_spectrum::{PreparedSpectrum, Spectrum, SpectrumRole, Wavelengths, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver, SurfacePoint};

/// How a picture covers the sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mapping {
    /// Longitude and latitude.
    LatLong,
    /// Clarberg's equal-area square.
    EqualArea,
}

/// What is seen between texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Filter {
    Bilinear,
    Nearest,
}

/// A place on the picture seen in a direction, and back.
impl Mapping {
    fn uv(self, w: Vector3) -> Point2 {
        match self {
            Self::LatLong => {
                let u = warp::azimuth(w.x, -w.z) / TAU;
                // The arc tangent keeps its digits at the poles, where densities have none to spare.
                Point2::new(u, w.x.hypot(w.z).atan2(w.y) * FRAC_1_PI)
            }
            Self::EqualArea => warp::square_from_sphere_equal_area(w),
        }
    }

    fn direction(self, uv: Point2) -> Vector3 {
        match self {
            Self::LatLong => {
                let (sin_theta, cos_theta) = (uv.y * PI).sin_cos();
                let (sin_phi, cos_phi) = (uv.x * TAU).sin_cos();
                Vector3::new(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta)
            }
            Self::EqualArea => warp::sphere_from_square_equal_area(uv),
        }
    }

    /// The irradiance that a picture gives a plane that faces +Z.
    fn irradiance(self, picture: &Bitmap) -> f32 {
        let (w, h) = (picture.width(), picture.height());
        let texel = |i: usize| {
            let (x, y) = (i % w, i / w);
            let uv = Point2::new((x as f32 + 0.5) / w as f32, (y as f32 + 0.5) / h as f32);
            let cos = self.direction(uv).z.max(0.0);
            f64::from(cos * self.stretch(uv.y) * luminance(picture.rgb(x, y)))
        };
        ((0..w * h).map(texel).sum::<f64>() / (w * h) as f64) as f32
    }

    /// Steradians per unit area of the picture at a height on it.
    fn stretch(self, v: f32) -> f32 {
        match self {
            Self::LatLong => 2.0 * PI * PI * (v * PI).sin(),
            Self::EqualArea => 4.0 * PI,
        }
    }
}

/// Surroundings from a picture.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    picture: Arc<Bitmap>,
    mapping: Mapping,
    filter: Filter,
    scale: PreparedSpectrum,
    world_from_light: Transform,
    light_from_world: Transform,
    distribution: Option<PiecewiseConstant2D>,
    /// Mean radiance over the sphere, before `scale`.
    mean: f32,
}

impl Element for EnvironmentMap {
    const SUMMARY: &'static str = "Surroundings from a picture.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "filename", ty: "path", default: "", doc: "EXR, HDR, ..." },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor" },
        ParamDoc { name: "tint", ty: "spectrum", default: "1", doc: "another factor" },
        ParamDoc {
            name: "illuminance",
            ty: "float",
            default: "0",
            doc: "if positive: the irradiance of a plane that faces +Z, before `scale`",
        },
        ParamDoc { name: "mapping", ty: "string", default: "latlong", doc: "`latlong` or `equal_area`" },
        ParamDoc { name: "filter", ty: "string", default: "bilinear", doc: "`bilinear` or `nearest`" },
        ParamDoc { name: "world_from_light", ty: "transform", default: "identity", doc: "turns the picture" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("filename");
        let path = params.try_path("filename")?.ok_or_else(|| SceneError::MissingParam {
            element: "envmap".into(),
            param: "filename".into(),
            wanted: "a picture file".into(),
            at: Span::NONE,
        })?;
        Self::of(resolver.bitmap(&path, Encoding::Auto, at)?, params)
    }
}

impl EnvironmentMap {
    /// Surroundings from pixels, with all parameters but the file's name.
    pub(super) fn of(picture: Arc<Bitmap>, params: &mut Params) -> Result<Self, SceneError> {
        let mapping =
            params.one_of("mapping", &[("latlong", Mapping::LatLong), ("equal_area", Mapping::EqualArea)])?;
        let filter =
            params.one_of("filter", &[("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)])?;
        let tint = params.spectrum("tint", 1.0)?.to_rgb(SpectrumRole::Illuminant);
        let mut scale = params.float_in("scale", 1.0, 0.0, f32::INFINITY)?;
        let illuminance = params.float("illuminance", 0.0)?;
        if illuminance > 0.0 {
            scale *= illuminance / mapping.irradiance(&picture).max(f32::MIN_POSITIVE);
        }
        let tinted = aureole_spectrum::SpectrumSource::Rgb(tint.map(|c| c * scale));
        Ok(Self::new(
            picture,
            (mapping, filter),
            tinted.prepare(SpectrumRole::Illuminant),
            params.transform("world_from_light")?,
        ))
    }

    fn new(
        picture: Arc<Bitmap>,
        (mapping, filter): (Mapping, Filter),
        scale: PreparedSpectrum,
        world_from_light: Transform,
    ) -> Self {
        let light_from_world = world_from_light.inverse();
        let mut this = Self {
            picture,
            mapping,
            filter,
            scale,
            world_from_light,
            light_from_world,
            distribution: None,
            mean: 0.0,
        };
        let (w, h) = (this.picture.width(), this.picture.height());
        // Each cell's weight is the mean of the interpolated picture over it: along rows [1 6 1] / 8; across them by midpoints, for the
        // rows of a latitude picture do not lie in the middles of the cells.
        let along = |x: i64, y: i64| -> f32 {
            [(-1, 0.125), (0, 0.75), (1, 0.125)]
                .map(|(i, wx)| wx * luminance(this.texel(x + i, y)))
                .iter()
                .sum()
        };
        let mut weights = vec![0.0; w * h];
        for y in 0..h {
            let stretch = mapping.stretch((y as f32 + 0.5) / h as f32);
            let mut rows = [0.0_f32; 4];
            let first = y as i64 - 1;
            for step in [0.125_f32, 0.375, 0.625, 0.875] {
                let row = this.row((y as f32 + step) / h as f32);
                let below = ((row.floor() as i64 - first).max(0) as usize).min(2);
                let fraction = row - row.floor();
                rows[below] += 0.25 * (1.0 - fraction);
                rows[below + 1] += 0.25 * fraction;
            }
            for x in 0..w {
                if filter == Filter::Nearest {
                    weights[y * w + x] = luminance(this.picture.rgb(x, y)).max(0.0) * stretch;
                    continue;
                }
                let parts = rows.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
                let sum: f32 = parts.map(|(j, weight)| weight * along(x as i64, first + j as i64)).sum();
                weights[y * w + x] = sum.max(0.0) * stretch;
            }
        }
        this.mean = weights.iter().map(|&x| f64::from(x)).sum::<f64>() as f32 / (w * h) as f32 / (4.0 * PI);
        this.distribution = PiecewiseConstant2D::new(&weights, w);
        this
    }

    #[inline]
    fn texel(&self, x: i64, y: i64) -> [f32; 3] {
        let (w, h) = (self.picture.width() as i64, self.picture.height() as i64);
        let x = if self.mapping == Mapping::LatLong { x.rem_euclid(w) } else { x.clamp(0, w - 1) };
        self.picture.rgb(x as usize, y.clamp(0, h - 1) as usize)
    }

    /// The row of the picture at a height, counted from the middle of the first.
    fn row(&self, v: f32) -> f32 {
        let h = self.picture.height() as f32;
        // The first and last rows of a latitude picture are at the poles themselves, as Mitsuba has it.
        if self.mapping == Mapping::LatLong { v * (h - 1.0) } else { v * h - 0.5 }
    }

    /// The picture at a place.
    fn lookup(&self, uv: Point2) -> Spectrum {
        if self.filter == Filter::Nearest {
            let (x, y) = (uv.x * self.picture.width() as f32, uv.y * self.picture.height() as f32);
            return Spectrum::from_rgb(self.texel(x as i64, y as i64));
        }
        let (x, y) = (uv.x * self.picture.width() as f32 - 0.5, self.row(uv.y));
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let texel = |i: i64, j: i64| Spectrum::from_rgb(self.texel(x0 as i64 + i, y0 as i64 + j));
        texel(0, 0).lerp(texel(1, 0), fx).lerp(texel(0, 1).lerp(texel(1, 1), fx), fy)
    }

    /// The picture along `w`, before it is scaled, for tables of it.
    pub(super) fn picture_along(&self, w: Vector3) -> Spectrum {
        self.lookup(self.mapping.uv(self.local(w)))
    }

    /// What the picture is scaled by.
    pub(super) fn strength(&self, wavelengths: &Wavelengths) -> Spectrum {
        self.scale.eval(wavelengths)
    }

    /// Texels across, where the nearest is seen; from then on what lies between them is interpolated.
    pub(super) fn resample(&mut self) -> Option<usize> {
        let is_nearest = std::mem::replace(&mut self.filter, Filter::Bilinear) == Filter::Nearest;
        is_nearest.then(|| self.picture.width())
    }

    fn local(&self, w: Vector3) -> Vector3 {
        self.light_from_world.vector(w).normalized()
    }
}

impl LightOps for EnvironmentMap {
    fn sample(&self, at: &LightContext<'_>, _: Point3, u: Point2) -> Option<LightSample> {
        let drawn = self.distribution.as_ref()?.sample(u)?;
        let stretch = self.mapping.stretch(drawn.p.y);
        let pdf_omega = drawn.pdf / stretch;
        let radiance = self.lookup(drawn.p) * self.scale.eval(&at.wavelengths);
        let wi = self.world_from_light.vector(self.mapping.direction(drawn.p)).try_normalized()?;
        let usable = stretch > 0.0 && pdf_omega > 0.0 && pdf_omega.is_finite() && !radiance.is_black();
        usable.then_some(LightSample { wi, target: None, radiance, pdf_omega, is_delta: false })
    }

    fn pdf_omega(&self, _: &LightContext<'_>, _: Point3, wi: Vector3, _: Option<&SurfacePoint>) -> f32 {
        let uv = self.mapping.uv(self.local(wi));
        let stretch = self.mapping.stretch(uv.y);
        match &self.distribution {
            Some(distribution) if stretch > 0.0 => distribution.pdf(uv) / stretch,
            _ => 0.0,
        }
    }

    fn environment(&self, at: &LightContext<'_>, _: Point3, w: Vector3) -> Spectrum {
        self.lookup(self.mapping.uv(self.local(w))) * self.scale.eval(&at.wavelengths)
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn power(&self, at: &LightContext<'_>, scene: &Bounds3) -> f32 {
        let radius = scene.radius();
        luminance(self.scale.eval(&at.wavelengths).rgb()) * self.mean * 4.0 * PI * PI * radius * radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Pcg32;

    #[test]
    fn directions_and_places_are_inverses() {
        let mut rng = Pcg32::new(4);
        for mapping in [Mapping::LatLong, Mapping::EqualArea] {
            for _ in 0..1000 {
                let w = warp::square_to_uniform_sphere(rng.point2());
                assert!((mapping.direction(mapping.uv(w)) - w).length() < 2e-3, "{mapping:?} {w:?}");
            }
        }
    }
}
