//! A lens: spherical boundaries between glasses, and a stop, one behind the other.
//!
//! The axis is Z. The film lies at z = 0, and light is followed backwards, from there towards the scene at larger z.

use aureole_desc::{SceneError, Span};

/// The most surfaces that a lens may have: each ray passes all of them.
const MOST_SURFACES: usize = 256;

/// A boundary between two media, or the stop.
#[derive(Clone, Copy, Debug)]
struct Surface {
    /// Of curvature, positive where it bulges towards the scene; `None` for the stop.
    curvature: Option<f64>,
    /// Where it crosses the axis.
    z: f64,
    /// How far light passes from the axis.
    aperture: f64,
    /// The refractive index on the film's side over that on the scene's.
    eta: f64,
}

/// Surfaces from the film to the scene.
#[derive(Clone, Debug)]
pub(super) struct Lens {
    surfaces: Vec<Surface>,
    /// From the film to the principal plane on its side.
    pub image_distance: f64,
}

/// A straight piece of a path through a lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub origin: [f64; 3],
    /// Of any length.
    pub direction: [f64; 3],
}

/// The plane on one side where a lens seems to bend light, and where it gathers what comes in parallel from the other side.
#[derive(Clone, Copy, Debug)]
struct Cardinal {
    principal: f64,
    focus: f64,
}

impl Lens {
    /// A lens from rows of four numbers in millimetres, scene side first: radius of curvature (0 for the stop), distance
    /// to the next surface, refractive index after this one, diameter.
    ///
    /// Radii and distances are turned into metres; the last distance does not count, since the lens is moved until it
    /// shows what is `focus_distance` before the film.
    ///
    /// # Errors
    /// Rows that are no lens, or one that cannot be focused.
    pub(super) fn new(rows: &[f32], focus_distance: f64, at: Span) -> Result<Self, SceneError> {
        let (rows, rest) = rows.as_chunks::<4>();
        if !rest.is_empty() || rows.is_empty() || rows.len() > MOST_SURFACES {
            let message = format!(
                "a lens is made of rows of four numbers (radius, thickness, refractive index, diameter), at most \
                 {MOST_SURFACES}, not of {} numbers",
                4 * rows.len() + rest.len()
            );
            return Err(SceneError::invalid(message, at));
        }
        let rows: Vec<[f64; 4]> = rows.iter().map(|row| row.map(f64::from)).collect();
        if let Some((i, why)) = rows.iter().enumerate().find_map(|(i, row)| Some((i, fault(row)?))) {
            return Err(SceneError::invalid(format!("surface {} of the lens: {why}", i + 1), at));
        }
        let mut lens = Self { surfaces: surfaces(&rows), image_distance: 0.0 };
        lens.focus(focus_distance).map_err(|message| SceneError::invalid(message, at))?;
        Ok(lens)
    }

    /// Moves all surfaces so that what lies at a distance from the film is sharp on it, as a thick lens does
    /// [Pharr 2023, section 5.5.3]; says why where that cannot be.
    fn focus(&mut self, distance: f64) -> Result<(), String> {
        let [film_side, scene_side] = self.cardinal_points();
        let f = film_side.principal - film_side.focus;
        if !(f.is_finite() && f > 0.0) {
            return Err("this lens does not gather light: it has no focus behind it".into());
        }
        // With a from the film to the lens and b from there to what is sharp: 1/a + 1/b = 1/f, and a + b is known.
        let between = scene_side.principal - film_side.principal;
        let whole = distance - between;
        if whole <= 4.0 * f {
            let nearest = 4.0 * f + between;
            return Err(format!(
                "this lens cannot show what is {distance:.4} from the film, only beyond {nearest:.4}"
            ));
        }
        self.image_distance = 0.5 * (whole - (whole * (whole - 4.0 * f)).sqrt());
        let moved = self.image_distance - film_side.principal;
        self.surfaces.iter_mut().for_each(|surface| surface.z += moved);
        match self.rear().0 > 0.0 {
            true => Ok(()),
            false => Err("focused like this, the film would lie within the lens".into()),
        }
    }

    /// What paraxial rays see on the film's side and on the scene's.
    fn cardinal_points(&self) -> [Cardinal; 2] {
        let from_film = |s: &Surface| (s.z, s.curvature.map_or(0.0, |r| -1.0 / r), s.eta);
        let from_scene = |s: &Surface| (-s.z, s.curvature.map_or(0.0, f64::recip), s.eta.recip());
        let film_side = cardinal(self.surfaces.iter().rev().map(from_scene));
        let scene_side = cardinal(self.surfaces.iter().map(from_film));
        [Cardinal { principal: -film_side.principal, focus: -film_side.focus }, scene_side]
    }

    /// Where the surface next to the film lies, and how far it reaches from the axis.
    pub(super) fn rear(&self) -> (f64, f64) {
        self.surfaces.first().map_or((0.0, 0.0), |surface| (surface.z, surface.aperture))
    }

    /// Closes the stop to a radius; `None` for a lens without one, else how far it could be opened.
    pub(super) fn stop_down(&mut self, radius: f64) -> Option<f64> {
        let stops = self.surfaces.iter_mut().filter(|surface| surface.curvature.is_none());
        stops.fold(None, |widest: Option<f64>, stop| {
            let open = stop.aperture;
            stop.aperture = radius.min(open);
            Some(widest.map_or(open, |widest| widest.min(open)))
        })
    }

    /// Follows light from the film into the scene; `None` where it does not get through. `transmittance` is what passes
    /// the stop, at a place in units of its radius.
    pub(super) fn trace(
        &self,
        from: Segment,
        transmittance: impl Fn([f64; 2]) -> f64,
    ) -> Option<(Segment, f64)> {
        let Segment { mut origin, mut direction } = from;
        let mut weight = 1.0;
        for surface in &self.surfaces {
            let Some(radius) = surface.curvature else {
                let t = (surface.z - origin[2]) / direction[2];
                if !(t >= 0.0 && t.is_finite()) {
                    return None;
                }
                origin = at(origin, direction, t);
                weight *= transmittance([origin[0] / surface.aperture, origin[1] / surface.aperture]);
                if weight <= 0.0 {
                    return None;
                }
                continue;
            };
            let center = surface.z - radius;
            origin = sphere(origin, direction, center, radius)?;
            if origin[0] * origin[0] + origin[1] * origin[1] > surface.aperture * surface.aperture {
                return None;
            }
            let normal = [origin[0], origin[1], origin[2] - center].map(|x| x / radius);
            direction = refract(direction, normal, surface.eta)?;
        }
        Some((Segment { origin, direction }, weight))
    }
}

/// What makes a row no part of a lens.
fn fault(&[curvature, thickness, eta, diameter]: &[f64; 4]) -> Option<String> {
    let wrong = |what: &str, x: f64| Some(format!("{what}, not {x}"));
    match () {
        () if !curvature.is_finite() => wrong("the radius must be a number", curvature),
        () if !(thickness.is_finite() && thickness >= 0.0) => {
            wrong("the thickness must not be negative", thickness)
        }
        // Zero stands for air.
        () if !(eta == 0.0 || (0.1..=10.0).contains(&eta)) => {
            wrong("the refractive index must be between 0.1 and 10", eta)
        }
        () if !(diameter.is_finite() && diameter > 0.0) => wrong("the diameter must be positive", diameter),
        () => None,
    }
}

/// Rows as surfaces from the film to the scene.
fn surfaces(rows: &[[f64; 4]]) -> Vec<Surface> {
    let index = |row: &[f64; 4]| if row[2] == 0.0 { 1.0 } else { row[2] };
    let mut z = 0.0;
    (0..rows.len())
        .rev()
        .map(|i| {
            let [curvature, thickness, _, diameter] = rows[i];
            z += thickness / 1000.0;
            Surface {
                curvature: (curvature != 0.0).then_some(curvature / 1000.0),
                z,
                aperture: diameter / 2000.0,
                eta: index(&rows[i]) / if i > 0 { index(&rows[i - 1]) } else { 1.0 },
            }
        })
        .collect()
}

/// What a ray along the axis, at height one, tells of surfaces in its order: each with its place along the ray, its
/// curvature (positive where its centre lies ahead) and the ratio of refractive indices, before over behind.
fn cardinal(surfaces: impl Iterator<Item = (f64, f64, f64)>) -> Cardinal {
    let (mut height, mut slope, mut before) = (1.0, 0.0, None);
    for (z, curvature, eta) in surfaces {
        height += slope * (z - before.unwrap_or(z));
        slope = eta * slope + height * (eta - 1.0) * curvature;
        before = Some(z);
    }
    let last = before.unwrap_or(0.0);
    Cardinal { principal: last + (1.0 - height) / slope, focus: last - height / slope }
}

fn at(origin: [f64; 3], direction: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|i| origin[i] + t * direction[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Where light meets that half of a sphere around the axis which lies towards its vertex.
fn sphere(origin: [f64; 3], direction: [f64; 3], center: f64, radius: f64) -> Option<[f64; 3]> {
    let from_center = [origin[0], origin[1], origin[2] - center];
    let (a, b) = (dot(direction, direction), dot(from_center, direction));
    let discriminant = b * b - a * (dot(from_center, from_center) - radius * radius);
    if discriminant < 0.0 {
        return None;
    }
    // Bulging towards the scene, it is left there.
    let t = (-b + discriminant.sqrt().copysign(radius)) / a;
    (t >= 0.0).then(|| at(origin, direction, t))
}

/// The direction behind a boundary whose unit normal points along the light; `None` for total reflection.
fn refract(direction: [f64; 3], normal: [f64; 3], eta: f64) -> Option<[f64; 3]> {
    let length = dot(direction, direction).sqrt();
    let cos = dot(direction, normal) / length;
    let normal = normal.map(|x| x * cos.signum());
    let cos = cos.abs();
    let cos2_behind = 1.0 - eta * eta * (1.0 - cos * cos);
    (cos2_behind > 0.0).then(|| {
        std::array::from_fn(|i| eta * direction[i] / length + (cos2_behind.sqrt() - eta * cos) * normal[i])
    })
}
