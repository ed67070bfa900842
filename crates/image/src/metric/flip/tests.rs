use aureole_spectrum::srgb_to_linear;

use super::*;

const WIDTH: i64 = 64;
const HEIGHT: i64 = 48;

/// A byte that looks random.
fn hash(x: i64, y: i64, c: i64) -> i64 {
    let mixed = (x as u32).wrapping_mul(374_761_393);
    let mixed = mixed.wrapping_add((y as u32).wrapping_mul(668_265_263));
    let mixed = mixed.wrapping_add((c as u32).wrapping_mul(2_246_822_519));
    let mixed = (mixed ^ (mixed >> 13)).wrapping_mul(1_274_126_177);
    i64::from((mixed ^ (mixed >> 16)) & 255)
}

/// Display bytes of the reference.
fn base(x: i64, y: i64, c: i64) -> i64 {
    [x * 4, y * 5, 255 - 2 * (x + y)][c as usize].rem_euclid(256)
}

fn noisy(x: i64, y: i64, c: i64) -> i64 {
    (base(x, y, c) + hash(x, y, c) / 8 - 16).clamp(0, 255)
}

fn edges(x: i64, y: i64, c: i64) -> i64 {
    if (x / 8 + y / 8) % 5 == 0 { 255 - base(x, y, c) } else { base(x, y, c) }
}

fn dots(x: i64, y: i64, c: i64) -> i64 {
    if x % 11 == 5 && y % 7 == 3 { [255, 0, 128][c as usize] } else { base(x, y, c) }
}

fn shifted(x: i64, y: i64, c: i64) -> i64 {
    base((x + 1).min(WIDTH - 1), y, c)
}

fn picture(byte: fn(i64, i64, i64) -> i64) -> Image {
    let pixel = |i: i64| [0, 1, 2].map(|c| srgb_to_linear(byte(i % WIDTH, i / WIDTH, c) as f32 / 255.0));
    let pixels: Vec<_> = (0..WIDTH * HEIGHT).map(pixel).collect();
    Image::from_rgb(WIDTH as usize, HEIGHT as usize, &pixels).unwrap()
}

/// A picture's distance from the reference as the authors' evaluator (flip-evaluator 1.7) gives it.
struct Published {
    byte: fn(i64, i64, i64) -> i64,
    pixels_per_degree: f32,
    mean: f64,
    max: f32,
    /// At (10, 10) and at (5, 40).
    pixels: [f32; 2],
}

#[test]
fn values_are_those_of_the_authors_evaluator() {
    let case =
        |byte, pixels_per_degree, mean, max, pixels| Published { byte, pixels_per_degree, mean, max, pixels };
    let cases = [
        case(noisy, PIXELS_PER_DEGREE, 0.082_839_6, 0.258_108, [0.040_865_3, 0.056_598_8]),
        case(noisy, 30.0, 0.164_348_8, 0.395_846, [0.114_231_5, 0.223_648]),
        case(edges, PIXELS_PER_DEGREE, 0.351_343_8, 0.997_042, [0.140_404_3, 0.964_463_5]),
        case(edges, 30.0, 0.271_909_4, 0.998_237, [0.005_488_65, 0.972_561_3]),
        case(dots, PIXELS_PER_DEGREE, 0.053_188_6, 0.450_66, [0.015_526_3, 0.122_178_8]),
        case(dots, 30.0, 0.040_711_9, 0.970_833, [0.000_559_55, 0.015_576_95]),
        case(shifted, PIXELS_PER_DEGREE, 0.069_649_4, 0.109_103, [0.034_328_8, 0.050_913]),
        case(base, 30.0, 0.0, 0.0, [0.0, 0.0]),
    ];
    for (i, case) in cases.iter().enumerate() {
        let map = flip(&picture(base), &picture(case.byte), &ToneMapping::default(), case.pixels_per_degree)
            .unwrap();
        assert!((map.mean() - case.mean).abs() < 2e-4, "{i}: {} is not {}", map.mean(), case.mean);
        assert!((map.max() - case.max).abs() < 1e-3, "{i}: {} is not {}", map.max(), case.max);
        for ((x, y), expected) in [(10, 10), (5, 40)].into_iter().zip(case.pixels) {
            let value = map.values()[y * WIDTH as usize + x];
            assert!((value - expected).abs() < 1e-3, "{i} at {x} {y}: {value} is not {expected}");
        }
    }
}

#[test]
fn it_is_symmetric_and_survives_what_is_not_finite() {
    let (a, mut b) = (picture(base), picture(dots));
    let tone = ToneMapping::default();
    let there = flip(&a, &b, &tone, PIXELS_PER_DEGREE).unwrap();
    let back = flip(&b, &a, &tone, PIXELS_PER_DEGREE).unwrap();
    assert_eq!(there, back);
    b.data_mut()[..4].copy_from_slice(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0]);
    let map = flip(&a, &b, &tone, PIXELS_PER_DEGREE).unwrap();
    assert!(map.values().iter().all(|value| (0.0..=1.0).contains(value)));
    assert!(flip(&a, &b, &tone, 0.0).is_err() && flip(&a, &Image::new(1, 1, &["R"]), &tone, 60.0).is_err());
}
