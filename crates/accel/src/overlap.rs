//! Whether things are in a box themselves, not only their boxes.

use aureole_math::{Bounds3, Point3, Vector3};

/// Whether a triangle and a box have a point in common: they do unless one of 13 axes separates them.
///
/// # References
/// [Akenine-Möller 2001] "Fast 3D Triangle-Box Overlap Testing".
pub fn triangle_overlaps_box(vertices: [Point3; 3], bounds: &Bounds3) -> bool {
    let center = Point3::ORIGIN + ((bounds.min - Point3::ORIGIN) + (bounds.max - Point3::ORIGIN)) * 0.5;
    let half = (bounds.max - bounds.min) * 0.5;
    let v = vertices.map(|p| p - center);
    let edges = [v[1] - v[0], v[2] - v[1], v[0] - v[2]];
    let unit = [Vector3::X, Vector3::Y, Vector3::Z];
    let crossed = edges.into_iter().flat_map(|edge| unit.map(|axis| axis.cross(edge)));
    let normal = edges[0].cross(edges[1]);
    !unit.into_iter().chain([normal]).chain(crossed).any(|axis| {
        let radius = axis.abs().dot(half);
        let along = v.map(|p| p.dot(axis));
        let (low, high) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
        // Rounding must not separate what touches.
        let slack = 1e-5 * (radius + low.abs().max(high.abs()));
        low > radius + slack || high < -radius - slack
    })
}

/// Whether a ball and a box have a point in common.
///
/// # References
/// [Arvo 1990] "A Simple Method for Box-Sphere Intersection Testing".
pub fn ball_overlaps_box(center: Point3, radius: f32, bounds: &Bounds3) -> bool {
    let nearest = center.max(bounds.min).min(bounds.max);
    (nearest - center).length_squared() <= radius * radius * (1.0 + 1e-5)
}

#[cfg(test)]
mod tests {
    use aureole_math::Pcg32;

    use super::*;

    #[test]
    fn a_triangle_overlaps_where_its_points_are() {
        let mut rng = Pcg32::new(3);
        let unit = Bounds3::new(Point3::splat(0.0), Point3::splat(1.0));
        let (mut both, mut neither) = (0, 0);
        for _ in 0..3000 {
            let mut point =
                || Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 5.0 - Vector3::splat(2.0);
            let [a, b, c] = [point(), point(), point()];
            let steps = 80;
            let inside = (0..=steps).any(|i| {
                (0..=steps - i).any(|j| {
                    let (u, v) = (i as f32 / steps as f32, j as f32 / steps as f32);
                    let p = a + (b - a) * u + (c - a) * v;
                    p == p.max(unit.min).min(unit.max)
                })
            });
            let overlaps = triangle_overlaps_box([a, b, c], &unit);
            assert!(overlaps || !inside, "{a:?} {b:?} {c:?}");
            both += u32::from(overlaps && inside);
            // The sampled points may only just miss the box: an overlap without any is rare.
            neither += u32::from(overlaps && !inside);
        }
        assert!(both > 500 && neither < both / 10, "{both} {neither}");
    }

    #[test]
    fn a_ball_at_a_corner_need_not_overlap() {
        let unit = Bounds3::new(Point3::splat(0.0), Point3::splat(1.0));
        assert!(ball_overlaps_box(Point3::splat(1.5), 0.9, &unit));
        assert!(!ball_overlaps_box(Point3::splat(1.5), 0.8, &unit)); // its box does
        assert!(ball_overlaps_box(Point3::splat(0.5), 0.1, &unit));
    }
}
