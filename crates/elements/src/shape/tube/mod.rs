//! `tube`: round tubes of varying radius around curves, such as Mitsuba's `bsplinecurve` and `linearcurve`.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `points` | floats | | x, y, z and radius of each control point; radii are in level space: transforms leave them alone |
//! | `counts` | ints | all | control points of each curve |
//! | `basis` | string | bspline | `bspline`, `bezier`, `catmull_rom` or `linear` |
//! | `cull_back` | bool | false | let rays through that come from inside, as Mitsuba does |
//!
//! u runs around a tube, v along all of them. Cubic tubes are open; linear ones have round joints and ends. Cubic tubes can
//! shine; where one bends more tightly than its radius, parts of its surface lie inside of it and are drawn in vain.
//!
//! References: [Van Wijk 1985] "Ray tracing objects defined by sweeping a sphere", Computers & Graphics 9(3).

mod round_cone;
mod sweep;

use std::f32::consts::TAU;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Discrete, Frame, Point2, Point3, Ray, Vector3, gamma};

use super::spline::{Basis, Cubic};
use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint};
use crate::{Element, Resolver};
use round_cone::{Neighbours, RoundCone};

/// Tubes in level space.
#[derive(Clone, Debug)]
pub struct Tube {
    /// Position and radius of control points.
    points: Box<[[f32; 4]]>,
    /// First control point of each segment.
    segments: Box<[u32]>,
    /// Cubic curves, or `None` for chains of straight pieces.
    basis: Option<Basis>,
    cull_back: bool,
    orientation: f32,
    /// Pieces of equal parameter range of all segments, by area; empty for tubes that do not shine.
    by_area: Option<Discrete>,
}

/// Boxes that a cubic segment is split into, so that they fit tightly.
const PARTS: u32 = 4;
/// Pieces of a segment that are told apart when it is sampled.
const CELLS: usize = 16;

/// What a point of a tube's surface looks like.
struct TubePoint {
    p: Point3,
    ng: Vector3,
    dp_du: Vector3,
    dp_dv: Vector3,
}

fn narrow(v: [f64; 3]) -> Vector3 {
    Vector3::from(v.map(|x| x as f32))
}

/// Two axes across unit direction `t`: angles count from the second to the first.
fn axes_across(t: Vector3) -> [Vector3; 2] {
    let first = (Vector3::Z - t * t.z).try_normalized().unwrap_or(Vector3::Y);
    [first, first.cross(t)]
}

/// The angle of a direction around a tube, in turns.
fn turns(t: Vector3, radial: Vector3) -> f32 {
    let [y, x] = axes_across(t);
    let angle = y.dot(radial).atan2(x.dot(radial)) / TAU;
    if angle < 0.0 { angle + 1.0 } else { angle }
}

impl Tube {
    fn wide(&self, point: u32) -> [f64; 4] {
        self.points[point as usize].map(f64::from)
    }

    fn cubic(&self, basis: Basis, segment: usize) -> Cubic<4> {
        let first = self.segments[segment];
        basis.to_bezier([0, 1, 2, 3].map(|i| self.wide(first + i)))
    }

    /// A straight piece; pieces of one chain have successive control points.
    fn cone(&self, segment: usize) -> RoundCone {
        let first = self.segments[segment];
        RoundCone::new(self.wide(first), self.wide(first + 1))
    }

    fn neighbours(&self, segment: usize) -> Neighbours {
        let first = self.segments[segment];
        let previous = segment.checked_sub(1).filter(|&s| self.segments[s] + 1 == first);
        let next = Some(segment + 1).filter(|&s| self.segments.get(s) == Some(&(first + 1)));
        Neighbours { previous: previous.map(|s| self.cone(s)), next: next.map(|s| self.cone(s)) }
    }

    /// The segment of a primitive, and which part of it.
    fn part(&self, primitive: u32) -> (usize, [f64; 2]) {
        if self.basis.is_none() {
            return (primitive as usize, [0.0, 1.0]);
        }
        let part = f64::from(primitive % PARTS) / f64::from(PARTS);
        ((primitive / PARTS) as usize, [part, part + 1.0 / f64::from(PARTS)])
    }

    fn v(&self, segment: usize, local: f32) -> f32 {
        (segment as f32 + local) / self.segments.len() as f32
    }

    /// The point of a cubic tube at a parameter, towards a direction from the axis (`radial` is made perpendicular).
    ///
    /// The derivative along the tube follows the frame of [`axes_across`] as it turns: for a unit tangent T the axis Y = Z
    /// minus its part along T, normalized, turns about T by (T'·X) Tz / √(1 - Tz²).
    fn cubic_point(&self, curve: &Cubic<4>, u: f32, radial: Vector3) -> Option<TubePoint> {
        let at = curve.at(f64::from(u));
        let [c, d1, d2] = [at.value, at.first, at.second].map(|v| narrow([v[0], v[1], v[2]]));
        let (r, dr) = (at.value[3] as f32, at.first[3] as f32);
        let speed = d1.length();
        let t = d1.try_normalized()?;
        let radial = (radial - t * radial.dot(t)).try_normalized()?;
        let stretch = speed - r * radial.dot(d2) / speed;
        let ng = (radial * stretch - t * dr).try_normalized()? * self.orientation;
        let around = t.cross(radial);
        let [_, x] = axes_across(t);
        let dt = (d2 - t * t.dot(d2)) / speed;
        let sin = (1.0 - t.z * t.z).max(0.0).sqrt();
        let twist = if sin > 1e-4 { dt.dot(x) * t.z / sin } else { 0.0 };
        let dv = t * stretch + radial * dr + around * (r * twist);
        let n = self.segments.len() as f32;
        Some(TubePoint { p: c.to_point() + radial * r, ng, dp_du: around * (TAU * r), dp_dv: dv * n })
    }

    /// The direction from the axis at a parameter, so many turns round.
    fn radial(curve: &Cubic<4>, u: f32, turns: f32) -> Option<Vector3> {
        let d1 = curve.at(f64::from(u)).first;
        let [y, x] = axes_across(narrow([d1[0], d1[1], d1[2]]).try_normalized()?);
        let (sin, cos) = (turns * TAU).sin_cos();
        Some(x * cos + y * sin)
    }

    /// Areas of the pieces of all segments.
    fn measure(&self, basis: Basis) -> Option<Discrete> {
        const AROUND: usize = 8;
        let cell = |i: usize| {
            let curve = self.cubic(basis, i / CELLS);
            let sum: f32 = (0..4 * AROUND)
                .map(|k| {
                    let u = ((i % CELLS) as f32 + ((k / AROUND) as f32 + 0.5) / 4.0) / CELLS as f32;
                    let turns = ((k % AROUND) as f32 + 0.5) / AROUND as f32;
                    Self::radial(&curve, u, turns)
                        .and_then(|radial| self.cubic_point(&curve, u, radial))
                        .map_or(0.0, |at| at.dp_du.cross(at.dp_dv).length())
                })
                .sum();
            sum / (4 * AROUND * CELLS * self.segments.len()) as f32
        };
        Discrete::new((0..self.segments.len() * CELLS).map(cell))
    }

    /// Density of sampling by area where the surface is stretched so much.
    fn pdf_area(&self, cell: usize, dp_du: Vector3, dp_dv: Vector3) -> f32 {
        let Some(by_area) = &self.by_area else { return 0.0 };
        by_area.pmf(cell) * (CELLS * self.segments.len()) as f32 / dp_du.cross(dp_dv).length()
    }

    fn error(p: Point3, radius: f32) -> Vector3 {
        (p.to_vector().abs() + Vector3::splat(radius)) * gamma(24)
    }
}

impl Element for Tube {
    const SUMMARY: &'static str = "Round tubes of varying radius around curves.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "points",
            ty: "floats",
            default: "",
            doc: "x, y, z and radius of each control point",
        },
        ParamDoc { name: "counts", ty: "ints", default: "all", doc: "control points of each curve" },
        ParamDoc {
            name: "basis",
            ty: "string",
            default: "bspline",
            doc: "`bspline`, `bezier`, `catmull_rom` or `linear`",
        },
        ParamDoc {
            name: "cull_back",
            ty: "bool",
            default: "false",
            doc: "let rays through that come from inside",
        },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let invalid = |message: &str| SceneError::invalid(message, Span::NONE);
        let list = params.try_floats("points")?.ok_or_else(|| invalid("tubes need `points`"))?;
        let place = |p: &[f32]| {
            let at = placement.world_from_object.point(Point3::new(p[0], p[1], p[2]));
            [at.x, at.y, at.z, p[3]]
        };
        let points: Box<[[f32; 4]]> = list.chunks_exact(4).map(place).collect();
        let is_sound = |p: &[f32; 4]| p.iter().all(|x| x.is_finite()) && p[3] >= 0.0;
        if !list.len().is_multiple_of(4) || points.len() > u32::MAX as usize || !points.iter().all(is_sound) {
            return Err(invalid("`points` must be four finite numbers a point, and radii not negative"));
        }
        let basis = match params.try_string("basis")?.as_deref() {
            Some("linear") => None,
            _ => Some(params.one_of("basis", &[&[("linear", Basis::BSpline)], Basis::NAMES].concat())?),
        };
        let counts = params.try_ints("counts")?.unwrap_or_else(|| [points.len() as i32].into());
        let segments = starts(&counts, points.len(), basis).map_err(|message| invalid(&message))?;
        let orientation = if placement.flip_normals { -1.0 } else { 1.0 };
        let cull_back = params.bool("cull_back", false)?;
        let mut tube = Self { points, segments, basis, cull_back, orientation, by_area: None };
        if let (Some(basis), true) = (basis, params.has("emission")) {
            tube.by_area = tube.measure(basis);
        }
        Ok(tube)
    }
}

/// First control points of the segments of curves of so many points each.
fn starts(counts: &[i32], points: usize, basis: Option<Basis>) -> Result<Box<[u32]>, String> {
    let mut segments = Vec::new();
    let mut first = 0usize;
    for &count in counts {
        let count = usize::try_from(count).map_err(|_| "`counts` must not be negative".to_owned())?;
        let (found, stride) = match basis {
            None => (count.checked_sub(1).filter(|&n| n > 0), 1),
            Some(basis) => (basis.segments(count), basis.stride()),
        };
        let found = found.ok_or_else(|| format!("{count} control points do not make such a curve"))?;
        if first + count > points {
            return Err(format!("`counts` ask for more than the {points} control points there are"));
        }
        segments.extend((0..found).map(|i| (first + i * stride) as u32));
        first += count;
    }
    if first != points || segments.len() > (u32::MAX / PARTS) as usize {
        return Err(format!("`counts` name {first} of {points} control points"));
    }
    Ok(segments.into())
}

impl ShapeOps for Tube {
    fn geometry(&self) -> Geometry {
        let around = |primitive: u32| {
            let (segment, [u0, u1]) = self.part(primitive);
            match self.basis {
                Some(basis) => sweep::bounds(&self.cubic(basis, segment).part(u0, u1)),
                None => self.cone(segment).bounds(),
            }
        };
        Geometry::Boxes((0..self.primitive_count() as u32).map(around).collect())
    }

    fn bounds(&self) -> Bounds3 {
        let around = |p: &[f32; 4]| {
            let (center, radius) = (Point3::new(p[0], p[1], p[2]), Vector3::splat(p[3]));
            Bounds3::new(center - radius, center + radius)
        };
        self.points.iter().map(around).fold(Bounds3::EMPTY, Bounds3::union)
    }

    fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
        let (segment, range) = self.part(primitive);
        let hit = match self.basis {
            Some(basis) => {
                sweep::closest_hit(&self.cubic(basis, segment).part(range[0], range[1]), ray, self.cull_back)
                    .map(|hit| sweep::Hit { u: range[0] + hit.u * (range[1] - range[0]), ..hit })
            }
            None => self.cone(segment).closest_hit(ray, &self.neighbours(segment), self.cull_back),
        }?;
        let t = hit.t as f32;
        let is_on_ray = t > ray.t_min && t < ray.t_max;
        is_on_ray.then_some(ShapeHit { t, primitive, uv: [hit.u as f32, 0.0] })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (segment, _) = self.part(hit.primitive);
        let local = hit.uv[0];
        let p = ray.at(hit.t);
        let (at, axis, radius) = match self.basis {
            Some(basis) => {
                let curve = self.cubic(basis, segment);
                let at = curve.at(f64::from(local));
                let center = narrow([at.value[0], at.value[1], at.value[2]]).to_point();
                let axis = narrow([at.first[0], at.first[1], at.first[2]]);
                (self.cubic_point(&curve, local, p - center), axis, at.value[3])
            }
            None => {
                let cone = self.cone(segment);
                let (center, radius) = cone.ball(f64::from(local));
                let axis = narrow(cone.axis());
                let n = (p - narrow(center).to_point()).try_normalized();
                let place = |n: Vector3| TubePoint {
                    p: narrow(center).to_point() + n * radius as f32,
                    ng: n * self.orientation,
                    dp_du: axis.try_normalized().unwrap_or(Vector3::Z).cross(n) * (TAU * radius as f32),
                    // On the side this is the axis plus the widening along n; on round ends it stays tangent.
                    dp_dv: (axis - n * axis.dot(n)) * self.segments.len() as f32,
                };
                (n.map(place), axis, radius)
            }
        };
        let error = Self::error(p, radius as f32);
        let Some(at) = at else {
            let frame = Frame::from_normal(-ray.direction.normalized());
            return SurfacePoint::new(p, error, frame.n, Point2::new(0.0, 0.0), frame.s, frame.t);
        };
        let axis = axis.try_normalized().unwrap_or(Vector3::Z);
        let uv = Point2::new(turns(axis, at.ng * self.orientation), self.v(segment, local));
        let surface = SurfacePoint::new(at.p, error, at.ng, uv, at.dp_du, at.dp_dv);
        SurfacePoint { primitive: segment as u32, ..surface }
    }

    fn area(&self) -> f32 {
        self.by_area.as_ref().map_or(f32::INFINITY, Discrete::sum)
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        let choice = self.by_area.as_ref()?.sample(u.x);
        let (segment, cell) = (choice.index / CELLS, choice.index % CELLS);
        let local = (cell as f32 + choice.u) / CELLS as f32;
        let curve = self.cubic(self.basis?, segment);
        let at = self.cubic_point(&curve, local, Self::radial(&curve, local, u.y)?)?;
        let pdf = self.pdf_area(choice.index, at.dp_du, at.dp_dv);
        let uv = Point2::new(u.y, self.v(segment, local));
        let primitive = segment as u32;
        pdf.is_finite().then(|| ShapeSample {
            p: at.p,
            error: Self::error(at.p, 0.0),
            ng: at.ng,
            uv,
            primitive,
            pdf,
        })
    }

    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        let local = surface.uv.y * self.segments.len() as f32 - surface.primitive as f32;
        let cell = ((local * CELLS as f32).max(0.0) as usize).min(CELLS - 1);
        let pdf = self.pdf_area(surface.primitive as usize * CELLS + cell, surface.dp_du, surface.dp_dv);
        let cos = wi.abs_dot(surface.ng);
        if cos > 0.0 { pdf * (surface.p - reference).length_squared() / cos } else { 0.0 }
    }

    fn primitive_count(&self) -> usize {
        self.segments.len() * if self.basis.is_some() { PARTS as usize } else { 1 }
    }
}
