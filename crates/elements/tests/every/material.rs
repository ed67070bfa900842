//! Materials: draws follow their density and value, no energy is made, light may walk either way.

mod examples;
mod table;

use aureole_desc::{Family, Value};
use aureole_elements::bsdf::{Bsdf, BsdfSample, MaterialContext, TransportMode};
use aureole_elements::{Material, TextureContext};
use aureole_math::{Frame, Id, Pcg32, Point2, Point3, Vector3, spherical_direction, warp};
use aureole_spectrum::Wavelengths;
use aureole_testkit::{Chi2Config, chi2_sphere, furnace, worst_asymmetry};

use crate::world::{World, rgb, word};
use examples::examples;

use TransportMode::{Importance, Radiance};
use Value::Float;

/// A material at a point seen from `wo`.
fn bsdf_at(world: &World, material: Id<Material>, frame: Frame, wo: Vector3) -> Bsdf {
    let texture = TextureContext {
        footprint: None,
        textures: &world.textures,
        wavelengths: Wavelengths::RGB,
        uv: Point2::new(0.4, 0.6),
        p: Point3::ORIGIN,
        n: frame.n,
        dp_duv: [frame.s, frame.t],
        mesh: None,
    };
    let at = MaterialContext {
        texture,
        materials: &world.materials,
        frame,
        ng: frame.n,
        dp_du: frame.s,
        dp_dv: frame.t,
        dn_duv: [Vector3::ZERO; 2],
        has_vertex_normals: false,
        wo,
    };
    let mut bsdf = Bsdf::new();
    world.materials[material].evaluate(&at, 1.0, &mut bsdf);
    bsdf
}

const UPRIGHT: Frame = Frame { s: Vector3::X, t: Vector3::Y, n: Vector3::Z };

/// Views from straight above to nearly grazing, and from below.
fn views() -> impl Iterator<Item = Vector3> {
    [2.0_f32, 30.0, 60.0, 84.0, 115.0, 160.0]
        .into_iter()
        .map(|theta| spherical_direction(theta.to_radians(), 0.7))
}

fn draw(bsdf: &Bsdf, wo: Vector3, mode: TransportMode, rng: &mut Pcg32) -> Option<BsdfSample> {
    bsdf.sample(wo, rng.next_f32(), rng.point2(), mode)
}

#[test]
fn every_kind_has_an_example() {
    let mut world = World::default();
    examples(&mut world);
    world.assert_complete(Family::Bsdf, Material::KINDS);
}

/// All tests together raise a false alarm in one of a hundred seeds.
#[test]
fn draws_follow_their_density() {
    let mut world = World::default();
    let examples = examples(&mut world);
    let test_count = examples.len() * views().count();
    let config = Chi2Config { sample_count: 100_000, test_count, ..Chi2Config::default() };
    let mut failures = Vec::new();
    for example in &examples {
        for wo in views() {
            let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
            if !bsdf.is_smooth() || bsdf.is_estimate() {
                continue;
            }
            let sample =
                |rng: &mut Pcg32| draw(&bsdf, wo, Radiance, rng).filter(|s| !s.flags.delta).map(|s| s.wi);
            if views().all(|wi| bsdf.pdf_omega(wo, wi) == 0.0) {
                // Black from this side: nothing may be drawn.
                let mut rng = Pcg32::new(1);
                assert!((0..1000).all(|_| sample(&mut rng).is_none()), "{}: {wo:?}", example.label);
                continue;
            }
            if let Err(error) = chi2_sphere(&config, sample, |wi| bsdf.pdf_omega(wo, wi)) {
                failures.push(format!("{} from {wo:?}: {error}", example.label));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn weights_are_value_over_density() {
    let mut world = World::default();
    let mut rng = Pcg32::new(2);
    for example in examples(&mut world) {
        for mode in [Radiance, Importance] {
            for wo in views() {
                let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
                if bsdf.is_estimate() {
                    continue;
                }
                for _ in 0..500 {
                    let Some(s) = draw(&bsdf, wo, mode, &mut rng).filter(|s| !s.flags.delta) else {
                        continue;
                    };
                    let (value, pdf) = (bsdf.eval_cos(wo, s.wi, mode), bsdf.pdf_omega(wo, s.wi));
                    assert!((s.wi.length() - 1.0).abs() < 1e-4, "{}: {s:?}", example.label);
                    assert!((s.pdf_omega / pdf - 1.0).abs() < 1e-2, "{}: {pdf} {s:?}", example.label);
                    let error = (s.weight - value / pdf).map(f32::abs).max_element();
                    assert!(error < 1e-2 * s.weight.max_element(), "{}: {s:?}", example.label);
                    assert_eq!(s.flags.transmission, s.wi.dot(Vector3::Z) * wo.z < 0.0, "{}", example.label);
                }
            }
        }
    }
}

/// Estimates by random walks are right on average: drawn weights sum to the integral of values. A false alarm is one of
/// ten thousand seeds.
#[test]
fn estimated_draws_have_the_mean_of_values() {
    let mut world = World::default();
    for example in examples(&mut world) {
        for wo in views() {
            let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
            if !bsdf.is_estimate() || !bsdf.is_smooth() {
                continue;
            }
            let drawn = furnace(100_000, 7, |rng| {
                draw(&bsdf, wo, Radiance, rng).filter(|s| !s.flags.delta).map(|s| s.weight.rgb()[0].into())
            });
            let valued = furnace(100_000, 8, |rng| {
                let wi = warp::square_to_uniform_sphere(rng.point2());
                let value = bsdf.eval_cos(wo, wi, Radiance).rgb()[0] / warp::UNIFORM_SPHERE_PDF;
                Some(value.into())
            });
            let error = (drawn.value - valued.value).abs();
            let sigma = drawn.standard_error.hypot(valued.standard_error);
            assert!(error < 4.5 * sigma + 2e-3, "{} from {wo:?}: {drawn:?} {valued:?}", example.label);
        }
    }
}

/// Importance keeps its energy across boundaries, radiance is squeezed: the furnace holds importance. A material that
/// returns everything fails in fewer than one of ten thousand seeds.
#[test]
fn no_energy_is_made() {
    let mut world = World::default();
    let mut failures = Vec::new();
    for example in examples(&mut world) {
        for wo in views() {
            let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
            for channel in 0..3 {
                let mean = furnace(20_000, 3, |rng| {
                    draw(&bsdf, wo, Importance, rng).map(|s| s.weight.rgb()[channel].into())
                });
                if !mean.is_at_most(1.0 + 5e-3, 4.0) {
                    failures.push(format!("{} from {wo:?}: {mean:?}", example.label));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Lossless rough surfaces return all light once what meets several facets is given back; without, they lose some. The
/// tables are linear between their entries, which leaves an error of a percent.
#[test]
fn compensation_gives_back_what_roughness_takes() {
    let mut world = World::default();
    let mut list = Vec::new();
    for alpha in [0.1, 0.4, 0.9] {
        for (kind, name) in [("rough_conductor", "material"), ("rough_dielectric", "distribution")] {
            for distribution in ["ggx", "beckmann"] {
                let materials = [false, true].map(|is_compensated| {
                    let metal = if name == "material" { word("none") } else { word(distribution) };
                    let node = world.add(
                        Family::Bsdf,
                        kind,
                        [
                            (name, metal),
                            ("distribution", word(distribution)),
                            ("alpha", Float(alpha)),
                            ("energy_compensation", Value::Bool(is_compensated)),
                        ],
                    );
                    world.material_of(&node)
                });
                list.push((format!("{kind} {distribution} {alpha}"), materials));
            }
        }
    }
    for (label, materials) in list {
        for theta in [5.0_f32, 45.0, 75.0] {
            let wo = spherical_direction(theta.to_radians(), 0.3);
            let [bare, whole] = materials.map(|material| {
                let bsdf = bsdf_at(&world, material, UPRIGHT, wo);
                furnace(50_000, 11, |rng| draw(&bsdf, wo, Importance, rng).map(|s| s.weight.rgb()[0].into()))
            });
            assert!((whole.value - 1.0).abs() < 0.015, "{label} at {theta}: {whole:?}");
            assert!(bare.value < whole.value + 5e-3, "{label} at {theta}: {bare:?}");
        }
    }
}

/// Where a mirror's Dirac counts as a density of one, light is lost as in Mitsuba 3.9.1 (`scalar_rgb`), which gave these shares
/// of even light for a mixture of grey and a perfect mirror seen from above. Five standard errors.
#[test]
fn counted_diracs_lose_what_mitsuba_loses() {
    let mut world = World::default();
    for (weight, expected) in [(0.25, 0.5644), (0.5, 0.6898), (0.75, 0.8387)] {
        let a = world.add(Family::Bsdf, "diffuse", [("reflectance", rgb(0.5, 0.5, 0.5))]);
        let b = world.add(Family::Bsdf, "conductor", [("material", word("none"))]);
        let dirac = ("dirac", word("density_one"));
        let node = world.add(Family::Bsdf, "blend", [("a", a), ("b", b), ("weight", Float(weight)), dirac]);
        let material = world.material_of(&node);
        let bsdf = bsdf_at(&world, material, UPRIGHT, Vector3::Z);
        let mean = furnace(100_000, 5, |rng| {
            draw(&bsdf, Vector3::Z, Radiance, rng).map(|s| s.weight.rgb()[0].into())
        });
        assert!((mean.value - expected).abs() < 5.0 * mean.standard_error + 1e-3, "{weight}: {mean:?}");
    }
}

/// f(wo, wi) for radiance is f(wi, wo) for importance [Veach 1997, section 3.7.5].
#[test]
fn light_may_walk_either_way() {
    let mut world = World::default();
    for example in examples(&mut world).into_iter().filter(|example| example.is_reciprocal) {
        if bsdf_at(&world, example.material, UPRIGHT, Vector3::Z).is_estimate() {
            continue;
        }
        let value = |wo: Vector3, wi: Vector3, mode| {
            bsdf_at(&world, example.material, UPRIGHT, wo).eval_cos(wo, wi, mode).rgb()[0] / wi.z.abs()
        };
        // The pair is ordered by height, so that both calls ask for the same walk.
        let walk = |a: Vector3, b: Vector3| {
            if a.z > b.z { value(a, b, Radiance) } else { value(a, b, Importance) }
        };
        let worst = worst_asymmetry(20_000, 4, 0.1, walk).expect("twenty thousand pairs");
        assert!(worst.relative < 5e-3, "{}: {worst:?}", example.label);
    }
}

#[test]
fn grazing_views_are_finite() {
    let mut world = World::default();
    let mut rng = Pcg32::new(5);
    for example in examples(&mut world) {
        for z in [0.0_f32, 1e-7, 1e-4, -1e-7, -1e-3] {
            let wo = Vector3::new((1.0 - z * z).sqrt(), 0.0, z);
            let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
            for _ in 0..200 {
                let wi = warp::square_to_uniform_sphere(rng.point2());
                for (wo, wi) in [(wo, wi), (wi, wo), (wo, wo), (wo, -wo)] {
                    let (value, pdf) = (bsdf.eval_cos(wo, wi, Radiance), bsdf.pdf_omega(wo, wi));
                    assert!(
                        value.is_finite() && pdf.is_finite() && pdf >= 0.0,
                        "{}: {wo:?} {wi:?}",
                        example.label
                    );
                }
                if let Some(s) = draw(&bsdf, wo, Radiance, &mut rng) {
                    assert!(s.weight.is_finite() && s.pdf_omega > 0.0, "{}: {s:?}", example.label);
                }
            }
        }
    }
}

/// Values times cosine (red) of Mitsuba 3.9 (`scalar_rgb`) for four pairs of directions: reflection, nearly grazing
/// reflection, and transmission from below and from above.
#[test]
fn values_are_those_of_mitsuba() {
    let expected = [
        ("diffuse", [0.15793, 0.16476, 0.0, 0.0]),
        ("ggx conductor", [0.59692, 0.39792, 0.0, 0.0]),
        ("anisotropic beckmann conductor", [1.1647, 0.26009, 0.0, 0.0]),
        ("ggx dielectric", [0.030592, 0.045976, 2.077, 0.59485]),
        ("beckmann dielectric", [0.03289, 0.0047745, 0.27626, 2.05e-05]),
        ("air bubble", [0.42956, 0.41627, 0.064128, 0.84962]),
        ("plastic", [0.13699, 0.087944, 0.0, 0.0]),
        ("nonlinear plastic", [0.15394, 0.098822, 0.0, 0.0]),
        ("principled", [0.15573, 0.088822, 0.089519, 0.019051]),
        ("principled by default", [0.13506, 0.1322, 0.0, 0.0]),
        ("principled glass", [0.019666, 0.029573, 1.0435, 0.62405]),
        ("thin principled", [0.045968, 0.050596, 0.093499, 0.1654]),
        ("rough plastic", [0.10504, 0.099856, 0.0, 0.0]),
        ("Baek's plastic", [0.118606, 0.102289, 0.0, 0.0]),
        ("two-sided plastic", [0.13699, 0.087944, 0.0, 0.0]),
        ("two-faced", [0.59692, 0.39792, 0.0, 0.0]),
        ("mask", [0.23877, 0.15917, 0.0, 0.0]),
        ("blend", [0.45997, 0.19336, 0.0, 0.0]),
        ("blend with glass", [0.042016, 0.039943, 0.0, 0.0]),
        ("Mitsuba's hair", [0.091242, 0.108038, 0.0051141, 0.540521]),
        ("normal map", [0.064176, 0.081464, 0.0, 0.0]),
        ("frosted under a normal map", [0.0032889, 0.0094125, 1.1246, 0.31621]),
        ("bump from a picture", [0.20211, 0.18998, 0.0, 0.0]),
    ];
    let pairs = [
        [Vector3::new(0.3, -0.5, 0.8), Vector3::new(-0.2, 0.6, 0.5)],
        [Vector3::new(0.9, 0.2, 0.15), Vector3::new(-0.7, 0.1, 0.6)],
        [Vector3::new(-0.4, 0.3, -0.7), Vector3::new(0.5, -0.2, 0.4)],
        [Vector3::new(0.5, 0.1, 0.6), Vector3::new(-0.6, -0.3, -0.9)],
    ]
    .map(|pair| pair.map(Vector3::normalized));
    let mut world = World::default();
    let examples = examples(&mut world);
    for (label, values) in expected {
        let example = examples.iter().find(|example| example.label == label).expect(label);
        for ([wo, wi], value) in pairs.into_iter().zip(values) {
            let bsdf = bsdf_at(&world, example.material, UPRIGHT, wo);
            let found = bsdf.eval_cos(wo, wi, Radiance).rgb()[0];
            assert!(
                (found - value).abs() <= 0.01 * value,
                "{label}: {found}, not {value}, for {wo:?} {wi:?}"
            );
        }
    }
}

#[test]
fn the_frame_does_not_matter() {
    let mut world = World::default();
    let tilted = Frame::from_normal_and_tangent(Vector3::new(0.3, -0.8, 0.4).normalized(), Vector3::X);
    let mut rng = Pcg32::new(6);
    for example in examples(&mut world) {
        if bsdf_at(&world, example.material, UPRIGHT, Vector3::Z).is_estimate() {
            continue;
        }
        for _ in 0..200 {
            let (wo, wi) =
                (warp::square_to_uniform_sphere(rng.point2()), warp::square_to_uniform_sphere(rng.point2()));
            let upright = bsdf_at(&world, example.material, UPRIGHT, wo).eval_cos(wo, wi, Radiance);
            let (wo, wi) = (tilted.to_world(wo), tilted.to_world(wi));
            let turned = bsdf_at(&world, example.material, tilted, wo).eval_cos(wo, wi, Radiance);
            let error = (upright - turned).map(f32::abs).max_element();
            assert!(
                error <= 1e-2 * upright.max_element() + 1e-4,
                "{}: {upright:?} {turned:?}",
                example.label
            );
        }
    }
}
