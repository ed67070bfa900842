//! How much light an endless scattering body gives back, and which medium inside gives back a wanted share.
//!
//! # Maths
//! Light that enters scatters isotropically; a boundary above throws part of it back inside. Without a boundary the
//! half space reflects radiance from μ' into μ by R(μ, μ') = (α/2) H(μ) H(μ') μ' / (μ + μ'), where H solves
//! Chandrasekhar's equation; with one, the upward radiance u is the sum of all further reflections: u = R (s + F u), where s
//! enters and F is Fresnel's reflectance from below. Both are solved by iteration on Gauss and Legendre's nodes. Other phase
//! functions by similarity: α' = α (1 - g) / (1 - α g), right within some parts in a hundred.
//!
//! # References
//! - [Chandrasekhar 1960] "Radiative Transfer", sections 28 and 33.
//! - [van de Hulst 1980] "Multiple Light Scattering", sections 9 and 14: similarity.

use super::directional::{QUADRATURE, gauss_legendre};
use super::fresnel;

/// Entries of an [`Albedos`] table.
const ENTRIES: usize = 33;

/// Directions below the boundary, by cosine, and their weights: half of them where nothing can leave.
type Nodes = [[f64; 2]; 2 * QUADRATURE];

fn nodes(eta: f32) -> Nodes {
    let critical = f64::from((1.0 - 1.0 / (eta * eta)).max(0.0).sqrt()).clamp(0.02, 0.98);
    let unit = gauss_legendre();
    std::array::from_fn(|i| {
        let [x, weight] = unit[i % QUADRATURE].map(f64::from);
        if i < QUADRATURE {
            [x * critical, weight * critical]
        } else {
            [critical + x * (1.0 - critical), weight * (1.0 - critical)]
        }
    })
}

/// Chandrasekhar's H function for isotropic scattering of albedo 1 - s².
fn h_function(nodes: &Nodes, s: f64) -> [f64; 2 * QUADRATURE] {
    let albedo = 1.0 - s * s;
    let mut h = [1.0; 2 * QUADRATURE];
    // The error shrinks by half or better at each step once every other step is averaged.
    for _ in 0..60 {
        let mut worst = 0.0_f64;
        let next = std::array::from_fn(|i| {
            let mu = nodes[i][0];
            let sum: f64 = nodes.iter().zip(&h).map(|([x, w], h)| w * x * h / (mu + x)).sum();
            let next = 0.5 * (h[i] + 1.0 / (s + 0.5 * albedo * sum));
            worst = worst.max((next - h[i]).abs());
            next
        });
        h = next;
        if worst < 1e-7 {
            break;
        }
    }
    h
}

/// The share of evenly diffuse light, of what enters, that a half space of albedo 1 - s² gives back through a boundary.
fn returned(nodes: &Nodes, eta: f32, s: f64) -> f64 {
    if s <= 0.0 {
        return 1.0;
    }
    let (albedo, h) = (1.0 - s * s, h_function(nodes, s));
    let inside = nodes.map(|[mu, _]| f64::from(fresnel::dielectric(-(mu as f32), eta).reflectance));
    // Evenly diffuse light keeps its radiance under the boundary but for what is reflected, and the squeeze.
    let entering = inside.map(|f| 1.0 - f);
    let reflect = |down: &[f64; 2 * QUADRATURE]| -> [f64; 2 * QUADRATURE] {
        std::array::from_fn(|i| {
            let terms = nodes.iter().zip(&h).zip(down);
            let sum: f64 = terms.map(|(([x, w], h), down)| w * h * down * x / (nodes[i][0] + x)).sum();
            0.5 * albedo * h[i] * sum
        })
    };
    let mut up = [0.0; 2 * QUADRATURE];
    for _ in 0..400 {
        let next = reflect(&std::array::from_fn(|i| entering[i] + inside[i] * up[i]));
        let change = next.iter().zip(&up).map(|(a, b): (&f64, &f64)| (a - b).abs()).fold(0.0, f64::max);
        up = next;
        if change < 1e-7 {
            break;
        }
    }
    let flux = |radiance: &dyn Fn(usize) -> f64| -> f64 {
        nodes.iter().enumerate().map(|(i, [mu, w])| w * mu * radiance(i)).sum()
    };
    flux(&|i| (1.0 - inside[i]) * up[i]) / flux(&|i| entering[i])
}

/// What a half space below a boundary returns, by its albedo: for one index of refraction.
#[derive(Clone, Debug)]
pub(super) struct Albedos {
    /// By s = sqrt(1 - albedo), from 0 to 1: from everything to nothing.
    returned: [f32; ENTRIES],
}

impl Albedos {
    /// The table for an index inside over outside.
    pub(super) fn new(eta: f32) -> Self {
        let nodes = nodes(eta);
        let step = 1.0 / (ENTRIES - 1) as f64;
        Self { returned: std::array::from_fn(|i| returned(&nodes, eta, i as f64 * step) as f32) }
    }

    /// The share of entering light that returns from a medium.
    pub(super) fn returned(&self, albedo: f32, g: f32) -> f32 {
        let similar = albedo * (1.0 - g) / (1.0 - albedo * g).max(1e-6);
        let x = (1.0 - similar.clamp(0.0, 1.0)).sqrt() * (ENTRIES - 1) as f32;
        let i = (x as usize).min(ENTRIES - 2);
        self.returned[i] + (self.returned[i + 1] - self.returned[i]) * (x - i as f32)
    }

    /// The albedo of scattering inside for which this share of entering light returns.
    pub(super) fn albedo(&self, returned: f32, g: f32) -> f32 {
        let wanted = returned.clamp(0.0, 1.0);
        let i = self.returned.partition_point(|&r| r > wanted).clamp(1, ENTRIES - 1);
        let [above, below] = [self.returned[i - 1], self.returned[i]];
        let t = ((above - wanted) / (above - below).max(1e-9)).clamp(0.0, 1.0);
        let s = ((i - 1) as f32 + t) / (ENTRIES - 1) as f32;
        ((1.0 - s * s) / (1.0 - g * s * s)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::{Pcg32, Vector3, warp};

    /// Without a boundary: van de Hulst's approximation of a half space's diffuse reflectance, good to some parts in a
    /// thousand, in the form of [Kulla and Conty 2017] "Revisiting Physically Based Shading at Imageworks".
    #[test]
    fn no_boundary_gives_van_de_hulsts_albedo() {
        let albedos = Albedos::new(1.0);
        for albedo in [0.2_f32, 0.5, 0.8, 0.9, 0.99, 0.999] {
            let s = (1.0 - albedo).sqrt();
            let fit = (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s);
            assert!((albedos.returned(albedo, 0.0) - fit).abs() < 3e-3, "{albedo}: {fit}");
        }
    }

    /// A walk in a half space below a boundary; both entering and leaving by Snell's law.
    fn walk(albedo: f32, g: f32, eta: f32, rng: &mut Pcg32) -> f64 {
        let phase = super::super::phase::HenyeyGreenstein { g };
        let outside = warp::square_to_cosine_hemisphere(rng.point2());
        let f = fresnel::dielectric(outside.z, eta);
        let mut w = Vector3::new(outside.x / eta, outside.y / eta, f.cos_t);
        let (mut z, entered) = (0.0_f32, f64::from(1.0 - f.reflectance));
        let mut weight = entered;
        for _ in 0..20_000 {
            z -= (1.0 - rng.next_f32()).ln() * w.z;
            if z >= 0.0 {
                // It meets the boundary from below.
                if rng.next_f32() >= fresnel::dielectric(-w.z, eta).reflectance {
                    return weight;
                }
                (z, w) = (0.0, Vector3::new(w.x, w.y, -w.z));
                continue;
            }
            weight *= f64::from(albedo);
            if weight < 0.05 {
                if rng.next_f32() >= 0.5 {
                    return 0.0;
                }
                weight *= 2.0;
            }
            w = phase.sample(w, rng.point2());
        }
        0.0
    }

    /// Against independent walks, which need no theory: five standard errors, and what similarity leaves out.
    #[test]
    fn the_table_is_what_walks_find() {
        let mut rng = Pcg32::new(8);
        for (albedo, g, eta, theory) in [
            (0.9_f32, 0.0_f32, 1.33_f32, 1.5e-3_f64),
            (0.99, 0.0, 1.5, 1.5e-3),
            (0.6, 0.0, 1.5, 1.5e-3),
            (0.8, 0.0, 1.0, 1.5e-3),
            (0.95, 0.6, 1.4, 0.02),
            (0.95, -0.4, 1.4, 0.02),
        ] {
            let n = 100_000;
            let entering = f64::from(1.0 - fresnel::mean_reflectance(eta));
            let values: Vec<f64> = (0..n).map(|_| walk(albedo, g, eta, &mut rng) / entering).collect();
            let mean = values.iter().sum::<f64>() / f64::from(n);
            let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n);
            let table = f64::from(Albedos::new(eta).returned(albedo, g));
            let tolerance = 5.0 * (variance / f64::from(n)).sqrt() + theory;
            assert!((mean - table).abs() < tolerance, "{albedo} {g} {eta}: {mean}, not {table}");
        }
    }

    #[test]
    fn the_table_can_be_read_backwards() {
        for eta in [1.0_f32, 1.33, 2.0] {
            let albedos = Albedos::new(eta);
            for returned in [0.0_f32, 0.05, 0.5, 0.9, 0.999, 1.0] {
                for g in [-0.5_f32, 0.0, 0.8] {
                    let albedo = albedos.albedo(returned, g);
                    assert!((albedos.returned(albedo, g) - returned).abs() < 2e-3, "{eta} {returned} {g}");
                }
            }
        }
    }
}
