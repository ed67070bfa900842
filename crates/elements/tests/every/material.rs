//! Materials: draws follow their density and value, no energy is made, light may walk either way.

use aureole_desc::{Family, Value};
use aureole_elements::bsdf::{Bsdf, BsdfSample, MaterialContext, TransportMode};
use aureole_elements::{Material, TextureContext};
use aureole_math::{Frame, Id, Pcg32, Point2, Point3, Vector3, spherical_direction, warp};
use aureole_spectrum::Wavelengths;
use aureole_testkit::{Chi2Config, chi2_sphere, furnace, worst_asymmetry};

use crate::world::{World, rgb, word};

use TransportMode::{Importance, Radiance};
use Value::Float;

/// A material to test.
struct Example {
    label: &'static str,
    material: Id<Material>,
    /// Whether f(wo, wi) = f*(wi, wo) can be asked: bent normals measure cosines elsewhere.
    is_reciprocal: bool,
}

/// Materials of every kind.
fn examples(world: &mut World) -> Vec<Example> {
    let bsdf = Family::Bsdf;
    let diffuse = world.add(bsdf, "diffuse", [("reflectance", rgb(0.8, 0.5, 0.2))]);
    let ggx = world.add(
        bsdf,
        "rough_conductor",
        [("material", word("Cu")), ("distribution", word("ggx")), ("alpha", Float(0.3))],
    );
    let beckmann = world.add(
        bsdf,
        "rough_conductor",
        [
            ("material", word("none")),
            ("distribution", word("beckmann")),
            ("alpha_u", Float(0.15)),
            ("alpha_v", Float(0.5)),
        ],
    );
    let glass = world.add(bsdf, "dielectric", []);
    let frosted = |world: &mut World, distribution: &str, alpha: f64, int_ior: f64, ext_ior: f64| {
        world.add(
            bsdf,
            "rough_dielectric",
            [
                ("distribution", word(distribution)),
                ("alpha", Float(alpha)),
                ("int_ior", Float(int_ior)),
                ("ext_ior", Float(ext_ior)),
            ],
        )
    };
    let plastic = world.add(bsdf, "plastic", [("diffuse_reflectance", rgb(0.7, 0.3, 0.1))]);
    let lacquer = world.add(bsdf, "rough_plastic", [("distribution", word("ggx")), ("alpha", Float(0.25))]);
    let slope =
        world.add(Family::Texture, "bilerp", [("v01", rgb(0.0, 0.0, 0.0)), ("v10", rgb(0.4, 0.4, 0.4))]);
    let picture = world.add(Family::Texture, "bitmap", [("filename", Value::Path("bumps.exr".into()))]);
    let etched = frosted(world, "ggx", 0.3, 1.5, 1.0);
    let bent = world.add(Family::Texture, "constant", [("value", rgb(0.65, 0.4, 0.9))]);

    let list = [
        ("diffuse", true, diffuse.clone()),
        ("conductor", true, world.add(bsdf, "conductor", [("material", word("Au"))])),
        ("ggx conductor", true, ggx.clone()),
        ("anisotropic beckmann conductor", true, beckmann.clone()),
        ("dielectric", true, glass.clone()),
        ("thin dielectric", true, world.add(bsdf, "thin_dielectric", [])),
        ("ggx dielectric", true, frosted(world, "ggx", 0.3, 1.5, 1.0)),
        ("beckmann dielectric", true, frosted(world, "beckmann", 0.2, 1.33, 1.0)),
        ("air bubble", true, frosted(world, "ggx", 0.4, 1.0, 1.5)),
        ("plastic", true, plastic.clone()),
        ("nonlinear plastic", true, {
            world.add(
                bsdf,
                "plastic",
                [("diffuse_reflectance", Float(0.9)), ("nonlinear", Value::Bool(true))],
            )
        }),
        ("rough plastic", true, lacquer.clone()),
        ("diffuse transmission", true, {
            world.add(
                bsdf,
                "diffuse_transmission",
                [("reflectance", rgb(0.5, 0.3, 0.2)), ("transmittance", rgb(0.1, 0.4, 0.3))],
            )
        }),
        ("two-sided plastic", true, world.add(bsdf, "two_sided", [("bsdf", plastic.clone())])),
        ("two-faced", true, world.add(bsdf, "two_sided", [("bsdf", ggx.clone()), ("back", diffuse.clone())])),
        ("mask", true, world.add(bsdf, "mask", [("opacity", Float(0.4)), ("bsdf", ggx.clone())])),
        ("blend", true, {
            world.add(bsdf, "blend", [("weight", Float(0.3)), ("a", diffuse.clone()), ("b", beckmann)])
        }),
        ("blend with glass", true, {
            world.add(bsdf, "blend", [("weight", Float(0.6)), ("a", lacquer), ("b", glass)])
        }),
        ("coated diffuse", true, {
            world.add(
                bsdf,
                "coated_diffuse",
                [("reflectance", rgb(0.8, 0.5, 0.2)), ("alpha_u", Float(0.3)), ("alpha_v", Float(0.15))],
            )
        }),
        ("smoothly coated diffuse", true, {
            world.add(
                bsdf,
                "coated_diffuse",
                [
                    ("reflectance", Float(0.9)),
                    ("thickness", Float(0.5)),
                    ("albedo", rgb(0.9, 0.7, 0.4)),
                    ("g", Float(0.3)),
                    ("sample_count", Value::Int(2)),
                ],
            )
        }),
        ("coated conductor", true, {
            world.add(bsdf, "coated_conductor", [("alpha", Float(0.1)), ("base_alpha", Float(0.3))])
        }),
        ("smoothly coated conductor", true, {
            world.add(bsdf, "coated_conductor", [("reflectance", rgb(0.9, 0.6, 0.3))])
        }),
        ("principled", true, {
            world.add(
                bsdf,
                "principled",
                [
                    ("base_color", rgb(0.6, 0.4, 0.2)),
                    ("roughness", Float(0.4)),
                    ("anisotropic", Float(0.5)),
                    ("metallic", Float(0.3)),
                    ("spec_trans", Float(0.4)),
                    ("specular", Float(0.7)),
                    ("spec_tint", Float(0.5)),
                    ("sheen", Float(0.2)),
                    ("sheen_tint", Float(0.6)),
                    ("flatness", Float(0.3)),
                    ("clearcoat", Float(0.5)),
                    ("clearcoat_gloss", Float(0.2)),
                ],
            )
        }),
        ("principled by default", true, world.add(bsdf, "principled", [])),
        ("principled glass", true, {
            world.add(
                bsdf,
                "principled",
                [("base_color", Float(0.9)), ("spec_trans", Float(1.0)), ("eta", Float(1.33))],
            )
        }),
        ("thin principled", false, {
            world.add(
                bsdf,
                "principled_thin",
                [
                    ("base_color", rgb(0.6, 0.4, 0.2)),
                    ("roughness", Float(0.4)),
                    ("anisotropic", Float(0.5)),
                    ("spec_trans", Float(0.4)),
                    ("eta", Float(1.33)),
                    ("spec_tint", Float(0.3)),
                    ("sheen", Float(0.3)),
                    ("sheen_tint", Float(0.6)),
                    ("flatness", Float(0.3)),
                    ("diff_trans", Float(0.8)),
                ],
            )
        }),
        ("hair", false, {
            world.add(bsdf, "hair", [("beta_m", Float(0.4)), ("beta_n", Float(0.5)), ("alpha", Float(3.0))])
        }),
        ("smooth light hair", false, {
            world.add(bsdf, "hair", [("reflectance", rgb(0.9, 0.7, 0.4)), ("beta_m", Float(0.15))])
        }),
        ("null", true, world.add(bsdf, "null", [])),
        ("bump", false, world.add(bsdf, "bump", [("texture", slope), ("bsdf", diffuse.clone())])),
        ("bump from a picture", false, {
            world.add(bsdf, "bump", [("texture", picture), ("scale", Float(0.8)), ("bsdf", diffuse)])
        }),
        ("normal map", false, world.add(bsdf, "normal_map", [("texture", bent.clone()), ("bsdf", ggx)])),
        ("frosted under a normal map", false, {
            world.add(bsdf, "normal_map", [("texture", bent), ("bsdf", etched)])
        }),
    ];
    let example = |(label, is_reciprocal, node): (_, _, Value)| Example {
        label,
        material: world.material_of(&node),
        is_reciprocal,
    };
    list.into_iter().map(example).collect()
}

/// A material at a point seen from `wo`.
fn bsdf_at(world: &World, material: Id<Material>, frame: Frame, wo: Vector3) -> Bsdf {
    let texture = TextureContext {
        textures: &world.textures,
        wavelengths: Wavelengths::RGB,
        uv: Point2::new(0.4, 0.6),
        p: Point3::ORIGIN,
        mesh: None,
    };
    let at = MaterialContext {
        texture,
        materials: &world.materials,
        frame,
        ng: frame.n,
        dp_du: frame.s,
        dp_dv: frame.t,
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
            let mean = furnace(20_000, 3, |rng| {
                draw(&bsdf, wo, Importance, rng)
                    .map(|s| s.weight.rgb().into_iter().fold(0.0, f32::max).into())
            });
            if !mean.is_at_most(1.0 + 1e-3, 4.0) {
                failures.push(format!("{} from {wo:?}: {mean:?}", example.label));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
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
        ("two-sided plastic", [0.13699, 0.087944, 0.0, 0.0]),
        ("two-faced", [0.59692, 0.39792, 0.0, 0.0]),
        ("mask", [0.23877, 0.15917, 0.0, 0.0]),
        ("blend", [0.45997, 0.19336, 0.0, 0.0]),
        ("blend with glass", [0.042016, 0.039943, 0.0, 0.0]),
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
