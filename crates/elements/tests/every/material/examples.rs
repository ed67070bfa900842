//! Materials of every kind, for the tests to try.

use aureole_desc::{Family, Value};
use aureole_elements::Material;
use aureole_math::{Id, Pcg32};

use Value::Float;

use crate::world::{World, rgb, word};

/// A material to test.
pub(super) struct Example {
    pub label: &'static str,
    pub material: Id<Material>,
    /// Whether f(wo, wi) = f*(wi, wo) can be asked: bent normals measure cosines elsewhere.
    pub is_reciprocal: bool,
}

/// Materials of every kind.
pub(super) fn examples(world: &mut World) -> Vec<Example> {
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
        (
            "Baek's plastic",
            true,
            world.add(bsdf, "baek_plastic", [("distribution", word("ggx")), ("alpha", Float(0.3))]),
        ),
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
        ("sheen over a matte surface", false, {
            world.add(
                bsdf,
                "sheen",
                [("color", rgb(0.9, 0.6, 0.3)), ("roughness", Float(0.3)), ("bsdf", diffuse.clone())],
            )
        }),
        ("compensated conductor", false, {
            world.add(
                bsdf,
                "rough_conductor",
                [
                    ("material", word("none")),
                    ("distribution", word("ggx")),
                    ("alpha", Float(0.7)),
                    ("energy_compensation", Value::Bool(true)),
                ],
            )
        }),
        ("compensated dielectric", false, {
            world.add(
                bsdf,
                "rough_dielectric",
                [
                    ("distribution", word("ggx")),
                    ("alpha", Float(0.6)),
                    ("energy_compensation", Value::Bool(true)),
                ],
            )
        }),
        ("film on a conductor", true, {
            world.add(
                bsdf,
                "rough_conductor",
                [("material", word("Cr")), ("alpha", Float(0.3)), ("film_thickness", Float(300.0))],
            )
        }),
        ("film on a dielectric", true, {
            world.add(
                bsdf,
                "rough_dielectric",
                [("alpha", Float(0.3)), ("film_thickness", Float(400.0)), ("film_ior", Float(1.8))],
            )
        }),
        ("blend that counts Diracs", false, {
            let mirror = world.add(bsdf, "conductor", [("material", word("Au"))]);
            let [weight, dirac] = [("weight", Float(0.4)), ("dirac", word("density_one"))];
            world.add(bsdf, "blend", [("a", diffuse.clone()), ("b", mirror), weight, dirac])
        }),
        ("rough diffuse", true, {
            world.add(bsdf, "rough_diffuse", [("reflectance", rgb(0.9, 0.5, 0.2)), ("roughness", Float(0.7))])
        }),
        ("open_pbr by default", false, world.add(bsdf, "open_pbr", [])),
        ("open_pbr with everything", false, {
            world.add(
                bsdf,
                "open_pbr",
                [
                    ("base_color", rgb(0.8, 0.5, 0.3)),
                    ("base_diffuse_roughness", Float(0.4)),
                    ("base_metalness", Float(0.3)),
                    ("specular_color", rgb(0.9, 0.8, 0.7)),
                    ("specular_roughness_anisotropy", Float(0.4)),
                    ("transmission_weight", Float(0.3)),
                    ("transmission_color", rgb(0.6, 0.9, 0.7)),
                    ("subsurface_weight", Float(0.2)),
                    ("coat_weight", Float(0.6)),
                    ("coat_color", rgb(0.9, 0.8, 0.6)),
                    ("coat_roughness", Float(0.3)),
                    ("fuzz_weight", Float(0.4)),
                    ("fuzz_color", rgb(0.5, 0.6, 0.9)),
                    ("thin_film_weight", Float(0.5)),
                    ("geometry_opacity", Float(0.9)),
                ],
            )
        }),
        ("open_pbr body", false, {
            world.add(
                bsdf,
                "open_pbr",
                [("subsurface_weight", Float(1.0)), ("specular_roughness", Float(0.5))],
            )
        }),
        ("open_pbr sheet", false, {
            world.add(
                bsdf,
                "open_pbr",
                [
                    ("subsurface_weight", Float(0.8)),
                    ("subsurface_scatter_anisotropy", Float(0.3)),
                    ("geometry_thin_walled", Value::Bool(true)),
                ],
            )
        }),
        ("open_pbr cloudy glass", false, {
            world.add(
                bsdf,
                "open_pbr",
                [
                    ("transmission_weight", Float(1.0)),
                    ("transmission_depth", Float(0.5)),
                    ("transmission_scatter", rgb(0.2, 0.3, 0.4)),
                ],
            )
        }),
        ("open_pbr prism", false, {
            world.add(
                bsdf,
                "open_pbr",
                [
                    ("transmission_weight", Float(1.0)),
                    ("specular_roughness", Float(0.0)),
                    ("transmission_dispersion_scale", Float(1.0)),
                ],
            )
        }),
        ("open_pbr frosted prism", true, {
            world.add(
                bsdf,
                "open_pbr",
                [
                    ("transmission_weight", Float(1.0)),
                    ("specular_roughness", Float(0.5)),
                    ("transmission_dispersion_scale", Float(1.0)),
                ],
            )
        }),
        ("open_pbr under bent normals", false, {
            let coat_bent = world.add(Family::Texture, "constant", [("value", rgb(0.4, 0.6, 0.9))]);
            let tangent = world.add(Family::Texture, "constant", [("value", rgb(0.8, 0.9, 0.5))]);
            world.add(
                bsdf,
                "open_pbr",
                [
                    ("geometry_normal", bent.clone()),
                    ("geometry_coat_normal", coat_bent),
                    ("geometry_coat_tangent", tangent),
                    ("coat_weight", Float(0.7)),
                    ("coat_roughness", Float(0.4)),
                    ("coat_roughness_anisotropy", Float(0.6)),
                    ("fuzz_weight", Float(0.3)),
                ],
            )
        }),
        ("measured isotropic", false, measured(world, 1)),
        ("measured anisotropic", false, measured(world, 4)),
        ("merl", true, {
            let (size, half) = ([6, 5, 8], 5 * 8);
            let value =
                |i: i32| 0.3 * (-0.02 * (i % 240) as f32).exp() + 0.01 * (i % half) as f32 / half as f32;
            let values: Vec<f32> = (0..3 * 240).map(value).collect();
            let (values, size) = (Value::Floats(values.into()), Value::Ints(size.into()));
            world.add(bsdf, "merl", [("values", values), ("size", size)])
        }),
        ("hair", false, {
            world.add(bsdf, "hair", [("beta_m", Float(0.4)), ("beta_n", Float(0.5)), ("alpha", Float(3.0))])
        }),
        ("Mitsuba's hair", false, {
            world.add(
                bsdf,
                "hair",
                [
                    ("offset", word("normal")),
                    ("eumelanin", Float(0.4)),
                    ("pheomelanin", Float(0.2)),
                    ("beta_m", Float(0.35)),
                    ("beta_n", Float(0.4)),
                    ("alpha", Float(3.0)),
                    ("eta", Float(1.55)),
                ],
            )
        }),
        ("smooth light hair", false, {
            world.add(bsdf, "hair", [("reflectance", rgb(0.9, 0.7, 0.4)), ("beta_m", Float(0.15))])
        }),
        ("null", true, world.add(bsdf, "null", [])),
        ("filter", true, world.add(bsdf, "null", [("transmittance", rgb(0.7, 0.4, 0.2))])),
        ("bump", false, world.add(bsdf, "bump", [("texture", slope), ("bsdf", diffuse.clone())])),
        ("smooth subsurface", true, world.add(bsdf, "subsurface", [])),
        ("rough subsurface", true, {
            world.add(bsdf, "subsurface", [("alpha", Float(0.3)), ("reflectance", rgb(0.8, 0.5, 0.3))])
        }),
        ("smooth subsurface with a diffuse exit", false, {
            world.add(bsdf, "subsurface", [("exit", word("diffuse")), ("name", word("Skin1"))])
        }),
        ("rough subsurface with a diffuse exit", false, {
            let exit = ("exit", word("diffuse"));
            world.add(bsdf, "subsurface", [exit, ("alpha", Float(0.4)), ("int_ior", Float(1.5))])
        }),
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

/// A made-up measurement with so many azimuths of incidence.
fn measured(world: &mut World, azimuths: usize) -> Value {
    const N: usize = 6;
    const THETAS: usize = 4;
    let mut rng = Pcg32::new(21);
    let mut numbers = |count: usize, low: f32| -> Value {
        Value::Floats((0..count).map(|_| low + 0.2 * rng.next_f32()).collect())
    };
    let square = || Value::Ints([N as i32; 2].into());
    let even = |count: usize, low: f32, high: f32| -> Value {
        let step = (high - low) / (count - 1).max(1) as f32;
        Value::Floats((0..count).map(|i| low + step * i as f32).collect())
    };
    let cells = azimuths * THETAS * N * N;
    let list = [
        ("phi_i", even(azimuths, -std::f32::consts::PI, std::f32::consts::PI)),
        ("theta_i", even(THETAS, 0.0, 0.5 * std::f32::consts::PI)),
        ("ndf", numbers(N * N, 0.2)),
        ("ndf_size", square()),
        ("sigma", numbers(N * N, 1.0)),
        ("sigma_size", square()),
        ("vndf", numbers(cells, 0.4)),
        ("vndf_size", square()),
        ("luminance", numbers(cells, 0.3)),
        ("luminance_size", square()),
        ("spectra", numbers(3 * cells, 0.1)),
        ("wavelengths", even(3, 400.0, 700.0)),
    ];
    world.add(Family::Bsdf, "measured", list)
}
