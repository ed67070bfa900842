//! What the tests found, as tables to print: `cargo test -p aureole-elements --test every -- --ignored --nocapture table`.

use aureole_desc::{Family, Value};
use aureole_math::spherical_direction;
use aureole_testkit::{Chi2Config, chi2_sphere, furnace};

use super::TransportMode::{Importance, Radiance};
use super::examples::examples;
use super::{UPRIGHT, bsdf_at, draw, views};
use crate::world::{World, word};

/// p-values of the chi-square test from each view ("-": nothing but mirrors, or an estimate), and the furnace from 45 degrees.
#[test]
#[ignore = "prints a table"]
fn table_of_examples() {
    let mut world = World::default();
    println!(
        "| material | 2° | 30° | 60° | 84° | 115° | 160° | energy at 45°, R G B |\n|---|---|---|---|---|---|---|---|"
    );
    for example in examples(&mut world) {
        let p_value = |wo| {
            let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
            let is_black = views().all(|wi| bsdf.pdf_omega(wo, wi) == 0.0);
            if !bsdf.is_smooth() || bsdf.is_estimate() || is_black {
                return "-".to_owned();
            }
            let config = Chi2Config { sample_count: 100_000, ..Chi2Config::default() };
            let outcome = chi2_sphere(
                &config,
                |rng| draw(&bsdf, wo, Radiance, rng).filter(|s| !s.flags.delta).map(|s| s.wi),
                |wi| bsdf.pdf_omega(wo, wi),
            );
            outcome.map_or_else(|_| "fails".to_owned(), |outcome| format!("{:.3}", outcome.p_value))
        };
        let p_values: Vec<String> = views().map(p_value).collect();
        let wo = spherical_direction(45.0_f32.to_radians(), 0.3);
        let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
        let energy = [0, 1, 2].map(|c| {
            let mean =
                furnace(50_000, 3, |rng| draw(&bsdf, wo, Importance, rng).map(|s| s.weight.rgb()[c].into()));
            format!("{:.3}", mean.value)
        });
        println!("| {} | {} | {} |", example.label, p_values.join(" | "), energy.join(" "));
    }
}

/// Energy of lossless rough surfaces at three roughnesses, without and with compensation.
#[test]
#[ignore = "prints a table"]
fn table_of_energy() {
    let mut world = World::default();
    println!("| surface | compensation | alpha 0.1 | 0.4 | 0.9 |\n|---|---|---|---|---|");
    for (kind, name) in [("rough_conductor", "material"), ("rough_dielectric", "distribution")] {
        for distribution in ["ggx", "beckmann"] {
            for is_compensated in [false, true] {
                let energies = [0.1, 0.4, 0.9].map(|alpha| {
                    let material = if name == "material" { word("none") } else { word(distribution) };
                    let list = [
                        (name, material),
                        ("distribution", word(distribution)),
                        ("alpha", Value::Float(alpha)),
                        ("energy_compensation", Value::Bool(is_compensated)),
                    ];
                    let node = world.add(Family::Bsdf, kind, list);
                    let material = world.material_of(&node);
                    let values = [5.0_f32, 45.0, 75.0].map(|theta| {
                        let wo = spherical_direction(theta.to_radians(), 0.3);
                        let bsdf = bsdf_at(&world, material, UPRIGHT, wo);
                        furnace(50_000, 11, |rng| {
                            draw(&bsdf, wo, Importance, rng).map(|s| s.weight.rgb()[0].into())
                        })
                        .value
                    });
                    values.map(|value| format!("{value:.3}")).join(" ")
                });
                println!("| {kind}, {distribution} | {is_compensated} | {} |", energies.join(" | "));
            }
        }
    }
}
