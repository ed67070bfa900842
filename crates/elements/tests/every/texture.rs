//! Textures: means and derivatives agree with values.

use aureole_desc::{Family, Value};
use aureole_elements::texture::{Texture, TextureContext};
use aureole_math::{Id, Pcg32, Point2, Point3, Transform, Vector3};
use aureole_spectrum::Wavelengths;
use aureole_testkit::{derivative, mean_with_error};

use crate::world::{World, rgb, word};

fn examples(world: &mut World) -> Vec<(&'static str, Id<Texture>)> {
    let texture = Family::Texture;
    let picture = || ("filename", Value::Path("wood.png".into()));
    let twice = || ("to_uv", Value::Transform(Transform::scale(Vector3::new(2.0, 3.0, 1.0))));
    let thrice = || ("to_uv", Value::Transform(Transform::scale(Vector3::new(6.0, 6.0, 1.0))));
    let thrice_in_space = || ("texture_from_world", Value::Transform(Transform::scale(Vector3::splat(1.5))));
    let ramp = world.add(texture, "bilerp", [("v00", rgb(0.1, 0.1, 0.1)), ("v11", rgb(0.9, 0.8, 0.7))]);
    let wood = world.add(texture, "bitmap", [picture()]);
    let list = [
        ("constant", world.add(texture, "constant", [("value", rgb(0.2, 0.4, 0.6))])),
        ("bilerp", ramp.clone()),
        ("bitmap", wood.clone()),
        ("nearest bitmap", world.add(texture, "bitmap", [picture(), ("filter", word("nearest")), twice()])),
        ("mirrored bitmap", world.add(texture, "bitmap", [picture(), ("wrap", word("mirror")), twice()])),
        ("checkerboard", world.add(texture, "checkerboard", [("color0", ramp.clone()), twice()])),
        ("scale", world.add(texture, "scale", [("texture", wood.clone()), ("scale", ramp.clone())])),
        ("mix", world.add(texture, "mix", [("a", wood), ("b", ramp.clone()), ("amount", ramp.clone())])),
        (
            "power",
            world.add(texture, "power", [("texture", rgb(0.25, 0.5, 0.1)), ("exponent", Value::Float(0.5))]),
        ),
        ("checkerboard in space", {
            world.add(texture, "checkerboard", [("dimension", Value::Int(3)), ("color1", rgb(0.9, 0.5, 0.1))])
        }),
        ("spherical bitmap", world.add(texture, "bitmap", [picture(), ("mapping", word("spherical"))])),
        ("cylindrical dots", world.add(texture, "dots", [("mapping", word("cylindrical"))])),
        ("dots", world.add(texture, "dots", [("inside", ramp), thrice()])),
        ("planar checkerboard", world.add(texture, "checkerboard", [("mapping", word("planar")), thrice()])),
        ("clouds", world.add(texture, "fractal", [("octaves", Value::Int(3)), thrice_in_space()])),
        (
            "wrinkles",
            world.add(
                texture,
                "fractal",
                [("pattern", word("wrinkled")), ("octaves", Value::Int(2)), thrice_in_space()],
            ),
        ),
        ("waves", world.add(texture, "fractal", [("pattern", word("windy")), thrice_in_space()])),
        (
            "marble",
            world.add(texture, "marble", [("variation", Value::Float(1.0)), ("octaves", Value::Int(3))]),
        ),
        ("direction mix", world.add(texture, "direction_mix", [("a", rgb(0.2, 0.3, 0.4))])),
        ("grid", {
            let values = (0..24).map(|i| 0.1 + 0.03 * i as f32).collect::<Vec<_>>();
            world.add(
                texture,
                "grid",
                [
                    ("values", Value::Floats(values.into())),
                    ("resolution", Value::Ints([2, 2, 2].into())),
                    ("channels", Value::Int(3)),
                    ("wrap", word("mirror")),
                ],
            )
        }),
        ("mesh attribute", world.add(texture, "mesh_attribute", [])),
    ];
    list.into_iter().map(|(label, node)| (label, world.texture_of(&node))).collect()
}

fn at(world: &World, uv: Point2) -> TextureContext<'_> {
    // A plane in space, so that patterns in space vary too.
    let p = Point3::new(uv.x, 0.3 + 0.5 * uv.y, 0.7 * uv.y - 0.2);
    let dp_duv = [Vector3::X, Vector3::new(0.0, 0.5, 0.7)];
    let n = Vector3::new(0.0, -0.7, 0.5).normalized();
    TextureContext { p, n, dp_duv, ..TextureContext::at_uv(&world.textures, Wavelengths::RGB, uv) }
}

#[test]
fn every_kind_has_an_example() {
    let mut world = World::default();
    examples(&mut world);
    world.assert_complete(Family::Texture, Texture::KINDS);
}

/// Means guide the choice among lights and lobes and may be estimates: products take their factors for independent.
#[test]
fn means_are_those_of_the_unit_square() {
    let mut world = World::default();
    // What depends on where a surface is has no mean over its parameters, and attributes none without a mesh.
    let everywhere = [
        "mesh attribute",
        "checkerboard in space",
        "spherical bitmap",
        "cylindrical dots",
        "dots",
        "clouds",
        "wrinkles",
        "waves",
        "marble",
        "direction mix",
        "grid",
    ];
    for (label, id) in examples(&mut world).into_iter().filter(|(label, _)| !everywhere.contains(label)) {
        let stated = world.textures[id].mean(&world.textures).rgb();
        for c in 0..3 {
            let mean =
                mean_with_error(20_000, 1, |rng| f64::from(at(&world, rng.point2()).spectrum(id).rgb()[c]));
            let error = (f64::from(stated[c]) - mean.value).abs();
            assert!(error <= 0.2 * mean.value + 5.0 * mean.standard_error, "{label}: {stated:?} {mean:?}");
        }
    }
}

#[test]
fn gradients_are_derivatives() {
    let mut world = World::default();
    let mut rng = Pcg32::new(2);
    // Picking the nearest texel has no useful derivative; bump maps get that of the interpolated picture instead.
    for (label, id) in examples(&mut world).into_iter().filter(|(label, _)| *label != "nearest bitmap") {
        let (mut tested, mut wrong) = (0, 0);
        for _ in 0..300 {
            let uv = rng.point2();
            let value = |u: f64, v: f64| f64::from(at(&world, Point2::new(u as f32, v as f32)).float(id));
            let (u, v) = (f64::from(uv.x), f64::from(uv.y));
            let expected = [derivative(u, 1e-3, |u| value(u, v)), derivative(v, 1e-3, |v| value(u, v))];
            let found = at(&world, uv).gradient(id);
            let error = (f64::from(found.x) - expected[0]).abs() + (f64::from(found.y) - expected[1]).abs();
            tested += 1;
            wrong += u32::from(error > 0.02 * (expected[0].abs() + expected[1].abs()) + 1e-2);
        }
        // Where two texels or two squares meet there is no derivative.
        assert!(wrong * 10 < tested, "{label}: {wrong} of {tested}");
    }
}

#[test]
fn values_are_finite_everywhere() {
    let mut world = World::default();
    for (label, id) in examples(&mut world) {
        for u in [-1e6_f32, -1.5, -0.0, 0.0, 1.0, 7.25, 1e6] {
            for v in [-1e6_f32, -0.5, 0.0, 0.999_999_94, 1.0, 1e6] {
                let value = at(&world, Point2::new(u, v)).spectrum(id);
                assert!(value.is_finite(), "{label} at {u}, {v}: {value:?}");
            }
        }
    }
}
