//! Where light from a lens comes from, seen from the film.

use super::aperture::Aperture;
use super::lens::{Lens, Segment};

/// Rings of the film that have bounds of their own.
const RINGS: usize = 64;
/// Cells along a side of the grid of rays that looks for the pupil.
const CELLS: usize = 48;
/// How often the grid is drawn closer: a pupil that is a point stays one.
const MOST_LOOKS: usize = 8;
/// The finest grid that looks for a pupil of which nothing is found yet.
const MOST_CELLS: usize = 1024;

/// A rectangle in the plane of the rear surface's vertex; its x axis points away from the film's middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Bounds {
    pub(super) fn area(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }
}

/// For each ring of the film, from its middle to its corners, what all light that gets through the lens passes; `None`
/// where none does.
///
/// The stop counts as open as its picture reaches in any direction, since rings have no side: bounds that follow a
/// square would cut it off where the film is turned against it.
pub(super) fn exit_pupils(lens: &Lens, aperture: &Aperture, film_radius: f64) -> Vec<Option<Bounds>> {
    let ring = |i: usize| film_radius * i as f64 / RINGS as f64;
    (0..RINGS).map(|i| bounds(lens, aperture.reach(), [ring(i), ring(i + 1)])).collect()
}

/// Looks for the pupil of a ring, first behind the whole rear surface, then closer.
fn bounds(lens: &Lens, reach: f64, [r0, r1]: [f64; 2]) -> Option<Bounds> {
    // pbrt looks as far, too: the surface bulges, so that light may pass its plane outside of its rim.
    let side = 1.5 * lens.rear().1;
    let mut within = Bounds { min: [-side; 2], max: [side; 2] };
    let film = [r0, 0.5 * (r0 + r1), r1];
    let grids = std::iter::successors(Some(CELLS), |cells| Some(2 * cells));
    let mut grids = grids.take_while(|&cells| cells <= MOST_CELLS);
    within = grids.find_map(|cells| look(lens, reach, film, within, cells))?;
    for _ in 0..MOST_LOOKS {
        let Some(found) = look(lens, reach, film, within, CELLS) else { break };
        let is_settled = found.area() > 0.5 * within.area();
        within = found;
        if is_settled {
            break;
        }
    }
    Some(within)
}

/// Bounds of the rays of a grid that get through, a cell wider on each side.
fn look(lens: &Lens, reach: f64, film: [f64; 3], within: Bounds, cells: usize) -> Option<Bounds> {
    let step: [f64; 2] = std::array::from_fn(|i| (within.max[i] - within.min[i]) / cells as f64);
    let z = lens.rear().0;
    let mut found: Option<Bounds> = None;
    for (ix, iy) in (0..cells * cells).map(|i| (i % cells, i / cells)) {
        let p = [within.min[0] + step[0] * (ix as f64 + 0.5), within.min[1] + step[1] * (iy as f64 + 0.5)];
        let passes = film.iter().any(|&x| {
            let from = Segment { origin: [x, 0.0, 0.0], direction: [p[0] - x, p[1], z] };
            lens.trace(from, |[x, y]| f64::from(u8::from(x.hypot(y) <= reach))).is_some()
        });
        if passes {
            let known = found.get_or_insert(Bounds { min: p, max: p });
            *known = Bounds {
                min: std::array::from_fn(|i| known.min[i].min(p[i])),
                max: std::array::from_fn(|i| known.max[i].max(p[i])),
            };
        }
    }
    found.map(|Bounds { min, max }| Bounds {
        min: std::array::from_fn(|i| min[i] - step[i]),
        max: std::array::from_fn(|i| max[i] + step[i]),
    })
}
