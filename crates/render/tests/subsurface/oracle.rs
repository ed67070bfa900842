//! What scattering bodies look like, found without anything of the renderer: in double precision, one colour at a time.

use std::f64::consts::PI;

/// A mean and how far it may be off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub value: f64,
    pub standard_error: f64,
}

impl Estimate {
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|x| (x - value).powi(2)).sum::<f64>() / (n - 1.0);
        Self { value, standard_error: (variance / n).sqrt() }
    }

    pub(crate) fn is_near(&self, expected: f64, tolerance: f64) -> bool {
        (self.value - expected).abs() < 5.0 * self.standard_error + tolerance
    }

    pub(crate) fn agrees(&self, other: &Self, tolerance: f64) -> bool {
        let error = self.standard_error.hypot(other.standard_error);
        (self.value - other.value).abs() < 5.0 * error + tolerance
    }
}

/// A generator of its own: SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn along(p: V, d: V, t: f64) -> V {
    [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]]
}

/// Turns a direction by Henyey and Greenstein's phase function.
fn turned(d: V, g: f64, random: &mut Random) -> V {
    let x = 2.0 * random.next() - 1.0;
    let cos = if g == 0.0 { x } else { (1.0 + g * g - ((1.0 - g * g) / (1.0 + g * x)).powi(2)) / (2.0 * g) };
    let (sin, phi) = ((1.0 - cos * cos).max(0.0).sqrt(), 2.0 * PI * random.next());
    // Any two directions across `d`, by the cross product with the axis it is least along.
    let axis = if d[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let cross =
        |a: V, b: V| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let s = cross(d, axis);
    let length = dot(s, s).sqrt();
    let s = s.map(|x| x / length);
    let t = cross(d, s);
    std::array::from_fn(|i| cos * d[i] + sin * (phi.cos() * s[i] + phi.sin() * t[i]))
}

/// The unit ball, of one colour, without a refracting boundary.
pub(crate) struct Ball {
    pub absorption: f64,
    pub scattering: f64,
    pub g: f64,
}

impl Ball {
    /// Radiance along -z through (0.3, 0.2) from a lamp of radiance 1: the square |x|, |z| < 2 at y = 3, shining down.
    pub(crate) fn seen_under_a_lamp(&self, walks: usize, seed: u64) -> Estimate {
        let mut random = Random(seed);
        let extinction = self.absorption + self.scattering;
        Estimate::of((0..walks).map(|_| {
            let mut p = [0.3, 0.2, (1.0_f64 - 0.3 * 0.3 - 0.2 * 0.2).sqrt()];
            let mut d = [0.0, 0.0, -1.0];
            loop {
                // Inside, the far crossing of the sphere is ahead.
                let b = dot(p, d);
                let out = -b + (b * b - dot(p, p) + 1.0).max(0.0).sqrt();
                let flight = -(1.0 - random.next()).ln() / extinction;
                if flight >= out {
                    let p = along(p, d, out);
                    let up = (3.0 - p[1]) / d[1];
                    let lamp = along(p, d, up);
                    let is_lit = d[1] > 0.0 && lamp[0].abs() < 2.0 && lamp[2].abs() < 2.0;
                    return f64::from(u8::from(is_lit));
                }
                if random.next() * extinction >= self.scattering {
                    return 0.0;
                }
                p = along(p, d, flight);
                d = turned(d, self.g, &mut random);
            }
        }))
    }
}

/// Fresnel's reflectance at a boundary of relative index `eta`, for a cosine on the first side.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos * cos) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2).sqrt();
    let s = (cos - eta * cos_t) / (cos + eta * cos_t);
    let p = (eta * cos - cos_t) / (eta * cos + cos_t);
    0.5 * (s * s + p * p)
}

/// What a boundary reflects of evenly diffuse light.
pub(crate) fn mean_fresnel(eta: f64) -> f64 {
    let n = 20_000;
    (0..n).map(|i| fresnel(((f64::from(i) + 0.5) / f64::from(n)).sqrt(), eta)).sum::<f64>() / f64::from(n)
}

/// Radiance of a flat, endless, isotropically scattering body in even surroundings of radiance one: what the boundary
/// mirrors, and what comes out of the body [Chandrasekhar 1960, "Radiative Transfer", section 33].
///
/// By reciprocity it is the share of a beam from the viewer that comes back: r(μ0) of a bare half space, of which the
/// boundary throws parts back inside.
pub(crate) fn half_space(albedo: f64, eta: f64, cos: f64) -> f64 {
    let n = 400;
    let cosines: Vec<f64> = (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).collect();
    let step = 1.0 / f64::from(n);
    // H(μ) = 1 / (sqrt(1 - a) + a/2 ∫ x H(x) / (μ + x) dx)
    let mut h = vec![1.0; cosines.len()];
    let equation = |h: &[f64], mu: f64| {
        let integral: f64 = cosines.iter().zip(h).map(|(x, h)| x * h / (mu + x) * step).sum();
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * integral)
    };
    for _ in 0..100 {
        h = cosines.iter().zip(&h).map(|(&mu, old)| 0.5 * (old + equation(&h, mu))).collect();
    }
    let below = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
    let h0 = equation(&h, below);
    // Upward radiance after the first passage, of a beam of unit flux; then again for all that the boundary threw back.
    let mut up: Vec<f64> =
        cosines.iter().zip(&h).map(|(mu, h)| 0.5 * albedo * h * h0 / (mu + below)).collect();
    let mut out = 0.0;
    for _ in 0..2000 {
        let inner: Vec<f64> = cosines.iter().map(|&mu| fresnel(mu, 1.0 / eta)).collect();
        out += cosines.iter().zip(&up).zip(&inner).map(|((mu, u), f)| mu * u * (1.0 - f) * step).sum::<f64>();
        let down: Vec<f64> = up.iter().zip(&inner).map(|(u, f)| u * f).collect();
        if down.iter().sum::<f64>() * step < 1e-7 {
            break;
        }
        up = cosines
            .iter()
            .zip(&h)
            .map(|(mu, hm)| {
                let terms = cosines.iter().zip(&h).zip(&down);
                let sum: f64 = terms.map(|((x, hx), d)| hx * d * x / (mu + x) * step).sum();
                0.5 * albedo * hm * sum
            })
            .collect();
    }
    let mirrored = fresnel(cos, eta);
    mirrored + (1.0 - mirrored) * out
}
