//! `curve`: thin strips along cubic curves: grass, fur and hair, as pbrt has them.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `points` | floats | | three numbers a control point |
//! | `basis` | string | bezier | `bezier`, `bspline` or `catmull_rom`, all cubic |
//! | `style` | string | flat | `flat` (turned to the ray), `ribbon` (turned by `normals`) or `cylinder` (flat, with a cylinder's normals) |
//! | `width0`, `width1` | float | 1 | full width at the first and the last control point |
//! | `normals` | floats | | of a ribbon: three numbers for each end of a segment |
//!
//! u runs along a segment, v across it. A strip has no fixed surface, so it cannot shine; rays that leave it start two
//! widths away.
//!
//! References: [PBRT4, section 6.7]; [Nakamaru and Ohno 2002] "Ray tracing for curves primitive", WSCG.

use std::f64::consts::{FRAC_PI_2, PI};

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Point2, Ray, Vector3};

use super::quadric::{ObjectRay, ObjectSpace};
use super::spline::{Basis, Cubic};
use super::{Geometry, Placement, ShapeHit, ShapeOps, SurfacePoint};
use crate::{Element, Resolver};

/// How a strip is turned about its curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Style {
    Flat,
    Ribbon,
    Cylinder,
}

/// Strips in an object space.
#[derive(Clone, Debug)]
pub struct Curve {
    space: ObjectSpace,
    points: Box<[[f32; 3]]>,
    basis: Basis,
    style: Style,
    /// At the first and the last control point.
    widths: [f64; 2],
    /// At the ends of segments.
    normals: Box<[[f32; 3]]>,
    segments: usize,
    orientation: f32,
}

/// Boxes that a segment is split into, so that they fit tightly.
const PARTS: usize = 4;

type Vec3 = [f64; 3];

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn scaled(a: Vec3, s: f64) -> Vec3 {
    a.map(|x| x * s)
}

fn unit(a: Vec3) -> Option<Vec3> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| scaled(a, 1.0 / length))
}

fn vector(a: Vec3) -> Vector3 {
    Vector3::from(a.map(|x| x as f32))
}

impl Curve {
    fn cubic(&self, segment: usize) -> Cubic<3> {
        let first = segment * self.basis.stride();
        self.basis.to_bezier([0, 1, 2, 3].map(|i| self.points[first + i].map(f64::from)))
    }

    /// The segment of a primitive, and which part of it.
    fn part(primitive: usize) -> (usize, [f64; 2]) {
        let part = (primitive % PARTS) as f64 / PARTS as f64;
        (primitive / PARTS, [part, part + 1.0 / PARTS as f64])
    }

    /// The strip's width before it is turned.
    fn width(&self, segment: usize, u: f64) -> f64 {
        let along = (segment as f64 + u) / self.segments as f64;
        self.widths[0] + (self.widths[1] - self.widths[0]) * along
    }

    /// A ribbon's normal, turned evenly from one end of the segment to the other.
    fn ribbon_normal(&self, segment: usize, u: f64) -> Vec3 {
        let [a, b] = [segment, segment + 1].map(|i| self.normals[i].map(f64::from));
        let angle = dot(a, b).clamp(-1.0, 1.0).acos();
        let sin = angle.sin();
        let (wa, wb) = match sin > 1e-6 {
            true => (((1.0 - u) * angle).sin() / sin, (u * angle).sin() / sin),
            false => (1.0 - u, u),
        };
        std::array::from_fn(|i| wa * a[i] + wb * b[i])
    }

    /// The width that a ray sees.
    fn seen_width(&self, segment: usize, u: f64, direction: Vec3) -> f64 {
        let width = self.width(segment, u);
        match self.style {
            Style::Ribbon => width * dot(self.ribbon_normal(segment, u), direction).abs(),
            _ => width,
        }
    }
}

/// Two unit vectors across a unit direction, which they follow in a right-handed frame [Duff et al. 2017].
fn across(z: Vec3) -> [Vec3; 2] {
    let sign = 1f64.copysign(z[2]);
    let a = -1.0 / (sign + z[2]);
    let b = z[0] * z[1] * a;
    [[1.0 + sign * z[0] * z[0] * a, sign * b, -sign * z[0]], [b, sign + z[1] * z[1] * a, -z[1]]]
}

/// The search for the nearest strip along the Z axis of the ray's own frame.
struct Search<'a> {
    curve: &'a Curve,
    segment: usize,
    /// Unit, in object space.
    direction: Vec3,
    half_width: f64,
    t_min: f64,
    t_max: f64,
    /// Distance, u and v.
    best: Option<[f64; 3]>,
}

impl Search<'_> {
    fn descend(&mut self, piece: &Cubic<3>, u0: f64, u1: f64, depth: u32) {
        let range = |axis: usize| {
            let each = piece.0.iter().map(|p| p[axis]);
            each.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let w = self.half_width;
        let around_ray = |[low, high]: [f64; 2]| low <= w && high >= -w;
        let [low, high] = range(2);
        if !around_ray(range(0)) || !around_ray(range(1)) || low - w > self.t_max || high + w < self.t_min {
            return;
        }
        if depth == 0 {
            return self.straight(piece, u0, u1);
        }
        let middle = 0.5 * (u0 + u1);
        let [first, second] = piece.halves();
        self.descend(&first, u0, middle, depth - 1);
        self.descend(&second, middle, u1, depth - 1);
    }

    /// Meets a nearly straight piece between the lines across its ends.
    fn straight(&mut self, piece: &Cubic<3>, u0: f64, u1: f64) {
        let [a, b, c, d] = piece.0;
        let beyond =
            |end: Vec3, inner: Vec3| end[0] * (end[0] - inner[0]) + end[1] * (end[1] - inner[1]) < 0.0;
        if beyond(a, b) || beyond(d, c) {
            return;
        }
        let chord = [d[0] - a[0], d[1] - a[1]];
        let length2 = chord[0] * chord[0] + chord[1] * chord[1];
        if length2 <= 0.0 {
            return;
        }
        let w = (-(a[0] * chord[0] + a[1] * chord[1]) / length2).clamp(0.0, 1.0);
        let u = u0 + (u1 - u0) * w;
        let at = piece.at(w);
        let [x, y, z] = at.value;
        let width = self.curve.seen_width(self.segment, u, self.direction);
        let distance = (x * x + y * y).sqrt();
        if distance > 0.5 * width || width <= 0.0 || !(z > self.t_min && z < self.t_max) {
            return;
        }
        // Which side of the curve the ray passes.
        let side = (x * at.first[1] - y * at.first[0]).signum();
        self.t_max = z;
        self.best = Some([z, u, 0.5 + side * distance / width]);
    }
}

impl Element for Curve {
    const SUMMARY: &'static str = "Thin strips along cubic curves: grass, fur and hair.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "points", ty: "floats", default: "", doc: "three numbers a control point" },
        ParamDoc {
            name: "basis",
            ty: "string",
            default: "bezier",
            doc: "`bezier`, `bspline` or `catmull_rom`",
        },
        ParamDoc { name: "style", ty: "string", default: "flat", doc: "`flat`, `ribbon` or `cylinder`" },
        ParamDoc { name: "width0", ty: "float", default: "1", doc: "width at the first control point" },
        ParamDoc { name: "width1", ty: "float", default: "1", doc: "width at the last control point" },
        ParamDoc {
            name: "normals",
            ty: "floats",
            default: "",
            doc: "of a ribbon: three numbers for each end of a segment",
        },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let invalid = |message: String| SceneError::invalid(message, Span::NONE);
        let triples = |list: Option<std::sync::Arc<[f32]>>| -> Box<[[f32; 3]]> {
            list.map_or_else(Box::default, |l| l.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
        };
        let points = triples(params.try_floats("points")?);
        let mut bases = Basis::NAMES.to_vec();
        bases.sort_by_key(|(name, _)| *name != "bezier"); // the first is the default
        let basis = params.one_of("basis", &bases)?;
        let styles = [("flat", Style::Flat), ("ribbon", Style::Ribbon), ("cylinder", Style::Cylinder)];
        let style = params.one_of("style", &styles)?;
        let segments = basis
            .segments(points.len())
            .ok_or_else(|| invalid(format!("{} control points do not make such a curve", points.len())))?;
        if points.iter().flatten().any(|x| !x.is_finite()) || segments * PARTS > u32::MAX as usize {
            return Err(invalid("`points` must be finite".to_owned()));
        }
        let [w0, w1] =
            [params.float_in("width0", 1.0, 0.0, f32::MAX)?, params.float_in("width1", 1.0, 0.0, f32::MAX)?];
        let normals: Box<_> = triples(params.try_floats("normals")?)
            .iter()
            .map(|n| Vector3::from(*n).try_normalized().unwrap_or(Vector3::Z).to_array())
            .collect();
        if style == Style::Ribbon && normals.len() != segments + 1 {
            let message = format!("a ribbon of {segments} segments needs {} normals", segments + 1);
            return Err(invalid(message));
        }
        let space = ObjectSpace::new(placement.world_from_object, false);
        let orientation = if placement.flip_normals { -1.0 } else { 1.0 };
        let widths = [f64::from(w0), f64::from(w1)];
        Ok(Self { space, points, basis, style, widths, normals, segments, orientation })
    }
}

impl ShapeOps for Curve {
    fn geometry(&self) -> Geometry {
        let around = |primitive: usize| {
            let (segment, [u0, u1]) = Self::part(primitive);
            let half = 0.5 * self.width(segment, u0).max(self.width(segment, u1));
            let hull = self.cubic(segment).part(u0, u1).0;
            let points = hull.iter().map(|p| vector(*p).to_point());
            let tight = Bounds3::around(points);
            let margin = Vector3::splat(half as f32);
            self.space.world_from_object.bounds(&Bounds3::new(tight.min - margin, tight.max + margin))
        };
        Geometry::Boxes((0..self.primitive_count()).map(around).collect())
    }

    fn bounds(&self) -> Bounds3 {
        let Geometry::Boxes(boxes) = self.geometry() else { return Bounds3::EMPTY };
        boxes.into_iter().fold(Bounds3::EMPTY, Bounds3::union)
    }

    fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
        let ObjectRay { o, d, t_min, t_max } = self.space.ray(ray);
        let direction = unit(d)?;
        let speed = dot(d, d).sqrt();
        let [x, y] = across(direction);
        let (segment, [u0, u1]) = Self::part(primitive as usize);
        let local = |p: Vec3| {
            let q = std::array::from_fn(|i| p[i] - o[i]);
            [dot(x, q), dot(y, q), dot(direction, q)]
        };
        let piece = Cubic(self.cubic(segment).part(u0, u1).0.map(local));
        let width = self.width(segment, u0).max(self.width(segment, u1));
        let depth = piece.halvings(0.05 * width.max(1e-12), 10);
        let (t_min, t_max) = (t_min * speed, t_max * speed);
        let half_width = 0.5 * width;
        let mut search = Search { curve: self, segment, direction, half_width, t_min, t_max, best: None };
        search.descend(&piece, u0, u1, depth);
        let [z, u, v] = search.best?;
        let t = (z / speed) as f32;
        let is_on_ray = t > ray.t_min && t < ray.t_max;
        is_on_ray.then_some(ShapeHit { t, primitive, uv: [u as f32, v as f32] })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (segment, _) = Self::part(hit.primitive as usize);
        let [u, v] = hit.uv.map(f64::from);
        let direction = unit(self.space.ray(ray).d).unwrap_or([0.0, 0.0, 1.0]);
        let [x, y] = across(direction);
        let width = self.seen_width(segment, u, direction);
        let du = self.cubic(segment).at(u).first;
        let dv = match self.style {
            Style::Ribbon => unit(cross(self.ribbon_normal(segment, u), du)),
            // In the plane that the ray sees, then about the curve by the angle at which a cylinder would be met.
            Style::Flat | Style::Cylinder => unit(cross(direction, du)).map(|flat| {
                let theta = if self.style == Style::Cylinder { PI * v - FRAC_PI_2 } else { 0.0 };
                let up = unit(cross(unit(du).unwrap_or(x), flat)).unwrap_or(direction);
                let (sin, cos) = theta.sin_cos();
                std::array::from_fn(|i| cos * flat[i] + sin * up[i])
            }),
        };
        // Where the ray runs along the curve there is no strip to speak of.
        let (du, dv) = dv.map_or((x, scaled(y, width)), |dv| (du, scaled(dv, width)));
        let (object_from_ray, p) = (self.space.world_from_object, ray.at(hit.t));
        let (dp_du, dp_dv) = (object_from_ray.vector(vector(du)), object_from_ray.vector(vector(dv)));
        let back = -ray.direction.normalized();
        let ng = dp_du.cross(dp_dv).try_normalized().unwrap_or(back);
        // Ribbons have two sides; what turns to the ray shows it its outside.
        let ng = if self.style == Style::Ribbon { ng } else { ng.face_forward(back) };
        let size = object_from_ray.vector(vector(scaled(x, width))).length();
        let error = Vector3::splat(2.0 * size);
        let uv = Point2::new(hit.uv[0], hit.uv[1]);
        let surface = SurfacePoint::new(p, error, ng * self.orientation, uv, dp_du, dp_dv);
        SurfacePoint { primitive: segment as u32, ..surface }
    }

    fn primitive_count(&self) -> usize {
        self.segments * PARTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::tests::NoResolver;
    use aureole_desc::Value;
    use aureole_math::Point3;

    fn strip(style: &str) -> Curve {
        let line = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.0, 0.0];
        let mut params = Params::new()
            .with("points", Value::Floats(line.into()))
            .with("style", Value::String(style.into()))
            .with("width0", Value::Float(0.2))
            .with("width1", Value::Float(0.4))
            .with("normals", Value::Floats([0.0, 0.0, 1.0, 0.0, 0.0, 1.0].into()));
        Curve::from_params(&mut params, &mut NoResolver::default()).expect("is sound")
    }

    fn hit(curve: &Curve, o: [f32; 3], d: [f32; 3]) -> Option<SurfacePoint> {
        let ray = Ray::new(Point3::from(o), Vector3::from(d));
        let hits = (0..curve.primitive_count() as u32).filter_map(|i| curve.intersect(&ray, i));
        hits.min_by(|a, b| a.t.total_cmp(&b.t)).map(|hit| curve.surface(&ray, &hit))
    }

    #[test]
    fn widths_are_whole_and_grow() {
        let flat = strip("flat");
        // At u = 1/2 the strip is 0.3 wide: 0.14 is inside, 0.16 is not.
        let inside = hit(&flat, [1.5, 0.14, 5.0], [0.0, 0.0, -2.0]).expect("inside");
        assert!((inside.uv.x - 0.5).abs() < 1e-5 && (inside.uv.y - 0.5).abs() > 0.46);
        assert!(hit(&flat, [1.5, 0.16, 5.0], [0.0, 0.0, -2.0]).is_none());
        assert!(hit(&flat, [3.05, 0.0, 5.0], [0.0, 0.0, -1.0]).is_none(), "strips end where they end");
    }

    #[test]
    fn ribbons_have_an_edge_and_flat_strips_have_none() {
        let (origin, sideways) = ([1.5, 5.0, 0.05], [0.0, -1.0, 0.0]);
        assert!(hit(&strip("ribbon"), origin, sideways).is_none());
        assert!(hit(&strip("flat"), origin, sideways).is_some());
    }

    #[test]
    fn cylinders_turn_their_normals() {
        let cylinder = strip("cylinder");
        let at = |y: f32| hit(&cylinder, [1.5, y, 5.0], [0.0, 0.0, -1.0]).expect("inside").ng;
        // A cylinder of radius 0.15 met at 60 % of it, by angle: v = 0.2 is 54 degrees off.
        let (low, high) = (at(-0.09), at(0.09));
        assert!((low.y + high.y).abs() < 1e-4 && (low.y.abs() - 54f32.to_radians().sin()).abs() < 1e-3);
        assert!(at(0.0).z.abs() > 0.999);
        assert!(low.y * low.z.signum() < 0.0, "normals spread outwards");
    }
}
