//! `portal_envmap`: surroundings from a picture that are seen through a window, and drawn through it.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `filename`, `scale`, `tint`, `illuminance`, `mapping`, `world_from_light` | | | as for `envmap`; without `filename`, white |
//! | `filter` | string | bilinear | `bilinear` or `nearest`, see below |
//! | `portal` | floats | | the window's four corners in the world, twelve numbers; its normal p03 × p01 points outwards |
//!
//! Light arrives only through the window. The picture is resampled so that straight lines of the world stay straight; what
//! a point sees of it is then a rectangle, from which directions are drawn. With the filter `nearest` that resampled picture,
//! with as many cells as there are texels across, is also what is seen, as in pbrt.
//!
//! References: [Bitterli et al. 2015] "Portal-Masked Environment Map Sampling"; pbrt-v4's `portal`.

mod windowed;

use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, PI};
use std::sync::Arc;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_image::Bitmap;
use aureole_math::{Bounds3, Point2, Point3, Vector3};
use aureole_spectrum::{Spectrum, Wavelengths, luminance};

use self::windowed::{Window, Windowed};
use super::{EnvironmentMap, LightContext, LightOps, LightSample};
use crate::{Element, Resolver, SurfacePoint};

/// Surroundings behind a window.
#[derive(Clone, Debug)]
pub struct PortalEnvironment {
    sky: EnvironmentMap,
    /// Two opposite corners.
    corners: [Point3; 2],
    /// Along the sides, and outwards.
    axes: [Vector3; 3],
    area: f32,
    /// The resampled picture, row by row, and its size, where that is what is seen.
    cells: Option<(Vec<Spectrum>, usize)>,
    distribution: Windowed,
    /// Mean radiance over the directions that can come through.
    mean: f32,
}

/// Cells along each side of the resampled picture, where it only guides what is drawn.
const CELLS: usize = 512;

impl Element for PortalEnvironment {
    const SUMMARY: &'static str = "Surroundings from a picture, seen and drawn through a window.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "filename", ty: "path", default: "", doc: "EXR, HDR, ..." },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor" },
        ParamDoc { name: "tint", ty: "spectrum", default: "1", doc: "another factor" },
        ParamDoc { name: "illuminance", ty: "float", default: "0", doc: "as for `envmap`" },
        ParamDoc { name: "mapping", ty: "string", default: "latlong", doc: "`latlong` or `equal_area`" },
        ParamDoc { name: "filter", ty: "string", default: "bilinear", doc: "`bilinear` or `nearest`" },
        ParamDoc { name: "world_from_light", ty: "transform", default: "identity", doc: "turns the picture" },
        ParamDoc { name: "portal", ty: "floats", default: "", doc: "four corners in the world" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("portal");
        let numbers = params.try_floats("portal")?.unwrap_or_default();
        let wrong =
            || SceneError::invalid("`portal` needs the four corners of a rectangle: twelve numbers", at);
        let corners: [f32; 12] = numbers.as_ref().try_into().map_err(|_| wrong())?;
        let corner = |i: usize| Point3::new(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
        let (x, y) = (corner(3) - corner(0), corner(1) - corner(0));
        let area = x.cross(y).length();
        let (x, y) = (x.try_normalized().ok_or_else(wrong)?, y.try_normalized().ok_or_else(wrong)?);
        let is_rectangle = x.dot(y).abs() < 1e-3
            && (corner(2) - corner(1)).try_normalized().is_some_and(|side| side.dot(x) > 0.999)
            && (corner(2) - corner(3)).try_normalized().is_some_and(|side| side.dot(y) > 0.999);
        if !is_rectangle {
            return Err(wrong());
        }
        let axes = [x, y, x.cross(y).normalized()];
        let sky = if params.has("filename") {
            EnvironmentMap::from_params(params, resolver)?
        } else {
            EnvironmentMap::of(Arc::new(Bitmap::placeholder([1.0; 3])), params)?
        };
        Ok(Self::new(sky, [corner(0), corner(2)], axes, area))
    }
}

impl PortalEnvironment {
    fn new(mut sky: EnvironmentMap, corners: [Point3; 2], axes: [Vector3; 3], area: f32) -> Self {
        let resampled = sky.resample();
        let size = resampled.unwrap_or(CELLS);
        let empty = Windowed::new(vec![1.0], 1);
        let mut this = Self { sky, corners, axes, area, cells: None, distribution: empty, mean: 0.0 };
        let scale = this.sky.strength(&Wavelengths::RGB);
        let (mut total, mut steradians) = (0.0, 0.0);
        let (mut cells, mut values) = (Vec::new(), Vec::new());
        for i in 0..size * size {
            let middle = |k: usize| (k as f32 + 0.5) / size as f32;
            let (w, density) = this.direction(Point2::new(middle(i % size), middle(i / size)));
            let color = this.sky.picture_along(w);
            let value = luminance((color * scale).rgb()).max(0.0) / density;
            total += f64::from(value);
            steradians += f64::from(1.0 / density);
            cells.push(color);
            values.push(value);
        }
        // A floor keeps what lies between the sampled places from being missed.
        let floor = 0.01 * total as f32 / values.len() as f32;
        this.distribution = Windowed::new(values.iter().map(|v| v + floor).collect(), size);
        this.mean = (total / steradians) as f32;
        this.cells = resampled.map(|size| (cells, size));
        this
    }

    /// Radiance along `w`, which is at a place of the resampled picture.
    fn radiance(&self, w: Vector3, uv: Point2, wavelengths: &Wavelengths) -> Spectrum {
        let color = match &self.cells {
            Some((cells, size)) => {
                let index = |v: f32| ((v * *size as f32) as usize).min(size - 1);
                cells[index(uv.y) * size + index(uv.x)]
            }
            None => self.sky.picture_along(w),
        };
        color * self.sky.strength(wavelengths)
    }

    /// The direction at a place of the resampled picture, and its area per steradian there.
    fn direction(&self, uv: Point2) -> (Vector3, f32) {
        let tan = |v: f32| ((v - 0.5) * PI).tan();
        let local = Vector3::new(tan(uv.x), tan(uv.y), 1.0).normalized();
        let [x, y, z] = self.axes;
        (x * local.x + y * local.y + z * local.z, density(local))
    }

    /// The place of a direction, and the area per steradian there; `None` for directions inwards.
    fn place(&self, w: Vector3) -> Option<(Point2, f32)> {
        let local = Vector3::new(w.dot(self.axes[0]), w.dot(self.axes[1]), w.dot(self.axes[2]));
        if local.z <= 0.0 {
            return None;
        }
        let angle = |a: f32| (a.atan2(local.z) + FRAC_PI_2) * FRAC_1_PI;
        Some((Point2::new(angle(local.x), angle(local.y)), density(local.try_normalized()?)))
    }

    /// What a point sees of the picture.
    fn window(&self, from: Point3) -> Option<Window> {
        let [(a, _), (b, _)] = [self.place(self.corners[0] - from)?, self.place(self.corners[1] - from)?];
        let low = Point2::new(a.x.min(b.x), a.y.min(b.y));
        let high = Point2::new(a.x.max(b.x), a.y.max(b.y));
        (low.x < high.x && low.y < high.y).then_some(Window { low, high })
    }
}

/// Area of the resampled picture per steradian [Bitterli et al. 2015, eq. 3].
fn density(local: Vector3) -> f32 {
    let side = |a: f32| (1.0 - a * a).max(1e-7);
    local.z.max(1e-7) / (PI * PI * side(local.x) * side(local.y))
}

impl LightOps for PortalEnvironment {
    fn sample(&self, at: &LightContext<'_>, reference: Point3, u: Point2) -> Option<LightSample> {
        let window = self.window(reference)?;
        let uv = self.distribution.sample(&window, u)?;
        let (wi, density) = self.direction(uv);
        let pdf_omega = self.distribution.pdf(&window, uv) * density;
        let radiance = self.radiance(wi, uv, &at.wavelengths);
        let is_usable = pdf_omega > 0.0 && pdf_omega.is_finite() && !radiance.is_black();
        is_usable.then_some(LightSample { wi, target: None, radiance, pdf_omega, is_delta: false })
    }

    fn pdf_omega(
        &self,
        _: &LightContext<'_>,
        reference: Point3,
        wi: Vector3,
        _: Option<&SurfacePoint>,
    ) -> f32 {
        match (self.window(reference), self.place(wi)) {
            (Some(window), Some((uv, density))) if window.contains(uv) => {
                self.distribution.pdf(&window, uv) * density
            }
            _ => 0.0,
        }
    }

    fn environment(&self, at: &LightContext<'_>, reference: Point3, w: Vector3) -> Spectrum {
        match (self.window(reference), self.place(w)) {
            (Some(window), Some((uv, _))) if window.contains(uv) => self.radiance(w, uv, &at.wavelengths),
            _ => Spectrum::ZERO,
        }
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn power(&self, _: &LightContext<'_>, _: &Bounds3) -> f32 {
        // Every direction of the half sphere sends through the window what its projected area lets.
        self.mean * self.area * PI
    }
}
