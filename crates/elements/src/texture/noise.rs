//! Gradient noise and sums of it.
//!
//! References: [Perlin 2002] "Improving Noise"; [Musgrave 1993] "Methods for Realistic Landscape Imaging".

use aureole_math::Point3;

/// Perlin's permutation of the bytes.
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99,
    37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27,
    166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244,
    102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130,
    116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147,
    118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119,
    248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110,
    79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179,
    162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184, 84, 204, 176,
    115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78,
    66, 215, 61, 156, 180,
];

fn permute(i: i64) -> i64 {
    i64::from(PERMUTATION[(i & 255) as usize])
}

/// The dot product of one of twelve gradients with the way from a lattice point.
fn gradient(hash: i64, x: f32, y: f32, z: f32) -> f32 {
    let h = hash & 15;
    let u = if h < 8 || h == 12 || h == 13 { x } else { y };
    let v = if h < 4 || h == 12 || h == 13 { y } else { z };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

/// Noise in about [-1, 1]: zero at whole numbers, smooth in between.
pub(super) fn noise(p: Point3) -> f32 {
    // Beyond this neither lattice nor fraction mean anything.
    let clip = |x: f32| if x.is_finite() { x.clamp(-1e9, 1e9) } else { 0.0 };
    let p = [clip(p.x), clip(p.y), clip(p.z)];
    let cell = p.map(f32::floor);
    let [dx, dy, dz] = [p[0] - cell[0], p[1] - cell[1], p[2] - cell[2]];
    let [ix, iy, iz] = cell.map(|c| c as i64);
    let corner = |i: i64, j: i64, k: i64| {
        let hash = permute(permute(permute(ix + i) + iy + j) + iz + k);
        gradient(hash, dx - i as f32, dy - j as f32, dz - k as f32)
    };
    let [wx, wy, wz] = [dx, dy, dz].map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let lerp = |t: f32, a: f32, b: f32| a + (b - a) * t;
    let along_x = |j: i64, k: i64| lerp(wx, corner(0, j, k), corner(1, j, k));
    let along_y = |k: i64| lerp(wy, along_x(0, k), along_x(1, k));
    lerp(wz, along_y(0), along_y(1))
}

/// How octaves of noise are added up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Octaves {
    /// How many.
    pub count: u32,
    /// The share of each in the one before.
    pub roughness: f32,
}

impl Octaves {
    /// Calls `add` with each octave's weight and place; frequencies a little less than doubled never line up.
    fn sum(self, p: Point3, term: impl Fn(f32) -> f32) -> f32 {
        let (mut sum, mut frequency, mut weight) = (0.0, 1.0, 1.0);
        for _ in 0..self.count {
            let at = Point3::new(p.x * frequency, p.y * frequency, p.z * frequency);
            sum += weight * term(noise(at));
            frequency *= 1.99;
            weight *= self.roughness;
        }
        sum
    }

    /// Fractional Brownian motion.
    pub(super) fn fbm(self, p: Point3) -> f32 {
        self.sum(p, |x| x)
    }

    /// The same with ridges: absolute values, and the mean of those that are left out.
    pub(super) fn turbulence(self, p: Point3) -> f32 {
        self.sum(p, f32::abs) + 0.2 * self.roughness.powi(self.count as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Pcg32;

    #[test]
    fn the_permutation_is_one() {
        let mut seen = [false; 256];
        PERMUTATION.iter().for_each(|&i| seen[usize::from(i)] = true);
        assert!(seen.iter().all(|&s| s));
    }

    #[test]
    fn noise_is_bounded_smooth_and_zero_on_the_lattice() {
        let mut rng = Pcg32::new(3);
        let mut sum = 0.0;
        for _ in 0..20_000 {
            let u = || 40.0;
            let p = Point3::new(
                rng.next_f32() * u() - 20.0,
                rng.next_f32() * u() - 20.0,
                rng.next_f32() * u() - 20.0,
            );
            let value = noise(p);
            assert!(value.abs() <= 1.05);
            assert!((noise(Point3::new(p.x + 1e-3, p.y, p.z)) - value).abs() < 1e-2);
            assert_eq!(noise(Point3::new(p.x.floor(), p.y.floor(), p.z.floor())), 0.0);
            sum += f64::from(value);
        }
        assert!((sum / 20_000.0).abs() < 0.01);
        assert!(noise(Point3::new(f32::NAN, f32::INFINITY, 1e30)).is_finite());
    }
}
