//! Sample generators: even, well-distributed, independent across pixels and dimensions, and pure.

use aureole_desc::{Family, Node, Params, Span};
use aureole_elements::Sampler;
use aureole_elements::sampler::SampleKey;
use aureole_testkit::{Chi2Config, chi2_counts, normal_two_sided};

use crate::world::{World, params};

const SAMPLES: u32 = 16;

fn samplers() -> impl Iterator<Item = (&'static str, Sampler)> {
    Sampler::KINDS.iter().map(|kind| {
        let params: Params = params([("sample_count", aureole_desc::Value::Int(SAMPLES.into()))]);
        let node = Node::new(Family::Sampler, *kind, params, Span::NONE);
        (
            *kind,
            Sampler::build(&node, &mut World::default()).unwrap_or_else(|error| panic!("{kind}: {error}")),
        )
    })
}

/// False alarm of each test: one in ten thousand seeds.
fn config() -> Chi2Config {
    Chi2Config { significance: 1e-4, ..Chi2Config::default() }
}

#[test]
fn numbers_are_pure_and_in_range() {
    for (kind, sampler) in samplers() {
        assert!(sampler.sample_count() >= SAMPLES, "{kind}");
        for i in 0..10_000_u32 {
            let key = SampleKey::new(3, i % 37, i % 11, i % 1000);
            let (x, p) = (sampler.get_1d(key, i % 50), sampler.get_2d(key, i % 50));
            assert!([x, p.x, p.y].iter().all(|x| (0.0..1.0).contains(x)), "{kind}: {x} {p:?}");
            assert_eq!((x, p), (sampler.get_1d(key, i % 50), sampler.get_2d(key, i % 50)), "{kind}");
        }
    }
}

/// The first sample of each of many pixels is uniform in every dimension: pixels are decorrelated.
#[test]
fn pixels_are_uniform_together() {
    let n = 40_000_u32;
    for (kind, sampler) in samplers() {
        for dimension in [0, 1, 2, 7, 20] {
            for sample in [0, 5] {
                let (mut line, mut square) = (vec![0.0; 64], vec![0.0; 64]);
                for i in 0..n {
                    let key = SampleKey::new(1, i % 200, i / 200, sample);
                    line[(sampler.get_1d(key, dimension) * 64.0) as usize] += 1.0;
                    let p = sampler.get_2d(key, dimension);
                    square[(p.x * 8.0) as usize * 8 + (p.y * 8.0) as usize] += 1.0;
                }
                for counts in [line, square] {
                    if let Err(error) = chi2_counts(&config(), &counts, &[f64::from(n) / 64.0; 64]) {
                        panic!("{kind}, dimension {dimension}, sample {sample}: {error}");
                    }
                }
            }
        }
    }
}

/// Draws of different dimensions, pixels, seeds and samples do not know of each other: |r| √n is standard normal.
/// False alarm: one in a thousand seeds.
#[test]
fn draws_are_uncorrelated() {
    let n = 20_000_u32;
    for (kind, sampler) in samplers() {
        let value = |seed: u64, i: u32, dx: u32, dimension: u32| {
            f64::from(sampler.get_1d(SampleKey::new(seed, i % 200 + dx, i / 200, 3), dimension)) - 0.5
        };
        let point = |i: u32, dimension: u32| {
            let p = sampler.get_2d(SampleKey::new(0, i % 200, i / 200, 3), dimension);
            [f64::from(p.x) - 0.5, f64::from(p.y) - 0.5]
        };
        let product = |what: &str, i: u32| match what {
            "dimensions" => value(0, i, 0, 4) * value(0, i, 0, 5),
            "far dimensions" => value(0, i, 0, 0) * value(0, i, 0, 31),
            "neighbours" => value(0, i, 0, 4) * value(0, i, 1, 4),
            "seeds" => value(0, i, 0, 4) * value(1, i, 0, 4),
            "coordinates" => point(i, 2)[0] * point(i, 2)[1],
            _ => point(i, 2)[0] * point(i, 3)[0],
        };
        for what in ["dimensions", "far dimensions", "neighbours", "seeds", "coordinates", "points"] {
            // Each product has mean zero and variance 1/144.
            let sum: f64 = (0..n).map(|i| product(what, i)).sum();
            let z = sum * 12.0 / f64::from(n).sqrt();
            assert!(normal_two_sided(z) > 1e-3 / 18.0, "{kind}, {what}: {z}");
        }
    }
}

/// Sixteen stratified samples fill sixteen strata, of a line and of a square.
#[test]
fn strata_are_filled() {
    for (kind, sampler) in samplers().filter(|(kind, _)| *kind != "independent") {
        for dimension in [0, 3, 10] {
            for pixel in 0..50 {
                let key = |sample| SampleKey::new(9, pixel, 2, sample);
                let (mut line, mut square) = ([0; 16], [0; 16]);
                for sample in 0..SAMPLES {
                    line[(sampler.get_1d(key(sample), dimension) * 16.0) as usize] += 1;
                    let p = sampler.get_2d(key(sample), dimension);
                    square[(p.x * 4.0) as usize * 4 + (p.y * 4.0) as usize] += 1;
                }
                assert_eq!(
                    (line, square),
                    ([1; 16], [1; 16]),
                    "{kind}, dimension {dimension}, pixel {pixel}"
                );
            }
        }
    }
}
