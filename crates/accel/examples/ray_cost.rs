//! What a ray costs among 10³ to 10⁷ triangles: prints a table and draws `ray_cost.svg`.
//!
//! `cargo run --release -p aureole-accel --example ray_cost [LARGEST [SVG]]`

#![expect(clippy::print_stdout, reason = "a program that tells what it found")]

use std::error::Error;
use std::time::Instant;

use aureole_accel::{Accuracy, Config, Geometry, Hit, NoUserShapes, Quality, World};
use aureole_math::{Pcg32, Point3, Ray};
use plotters::prelude::*;

const RAYS: usize = 400_000;

/// A square of hills, seen from everywhere around it: `side`² · 2 triangles.
fn hills(side: usize) -> Geometry {
    let height =
        |x: f32, y: f32| 0.1 * (9.0 * x).sin() * (7.0 * y).cos() + 0.01 * (90.0 * x + 70.0 * y).sin();
    let at = |i: usize| i as f32 / side as f32;
    let vertices = (0..(side + 1) * (side + 1)).map(|i| (at(i % (side + 1)), at(i / (side + 1))));
    let positions = vertices.map(|(x, y)| [x, y, height(x, y)]).collect();
    let corner = |x: usize, y: usize| (y * (side + 1) + x) as u32;
    let squares = (0..side * side).map(|i| (i % side, i / side));
    let indices = squares.flat_map(|(x, y)| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x, y + 1), corner(x + 1, y + 1)];
        [[a, b, d], [a, d, c]]
    });
    Geometry::Triangles { positions, indices: indices.collect() }
}

/// From a point in the box around it to another, mostly through the hills.
fn rays() -> Vec<Ray> {
    let mut rng = Pcg32::new(1);
    let mut point = |z: f32| Point3::new(rng.next_f32(), rng.next_f32(), z);
    (0..RAYS).map(|_| (point(0.3), point(-0.1))).map(|(from, to)| Ray::new(from, to - from)).collect()
}

/// Nanoseconds a ray: the best of three runs, on one thread.
fn cost(world: &World, rays: &[Ray]) -> f64 {
    let mut hits = vec![Hit::NONE; rays.len()];
    let run = |hits: &mut [Hit]| {
        let start = Instant::now();
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = world.closest_hit(ray, &NoUserShapes).unwrap_or(Hit::NONE);
        }
        start.elapsed().as_secs_f64() * 1e9 / rays.len() as f64
    };
    (0..3).map(|_| run(&mut hits)).fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let largest: f64 = arguments.next().unwrap_or("1e7".into()).parse()?;
    let svg = arguments.next().unwrap_or("ray_cost.svg".into());
    let rays = rays();
    let mut points = Vec::new();
    println!(
        "| triangles | build, s | bytes a triangle | depth | SAH cost | watertight, ns a ray | fast, ns a ray |"
    );
    println!("|---|---|---|---|---|---|---|");
    for step in 0.. {
        let wanted = 10_f64.powf(3.0 + 0.5 * f64::from(step));
        if wanted > largest * 1.01 {
            break;
        }
        let mesh = hills((wanted / 2.0).sqrt() as usize);
        let build = |accuracy| {
            let config = Config { accuracy, quality: Quality::Medium, ..Config::default() };
            World::build(vec![mesh.clone()], 0, &config)
        };
        let start = Instant::now();
        let watertight = build(Accuracy::Watertight)?;
        let seconds = start.elapsed().as_secs_f64();
        let (stats, watertight) = (watertight.validate()?, cost(&watertight, &rays));
        let fast = cost(&build(Accuracy::Fast)?, &rays);
        let (bytes, depth, sah) = (stats.bytes_a_primitive(), stats.depth, stats.sah_cost);
        let n = stats.primitives;
        println!("| {n} | {seconds:.4} | {bytes:.1} | {depth} | {sah:.2} | {watertight:.0} | {fast:.0} |");
        points.push((n as f64, watertight, fast));
    }
    draw(&svg, &points)
}

fn draw(path: &str, points: &[(f64, f64, f64)]) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, (720, 420)).into_drawing_area();
    area.fill(&WHITE)?;
    let most = points.iter().fold(0.0, |most: f64, p| most.max(p.1).max(p.2));
    let last = points.last().map_or(1e4, |p| p.0);
    let mut chart = ChartBuilder::on(&area)
        .caption("What a ray costs", ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d((1e3..last * 1.1).log_scale(), 0.0..most * 1.1)?;
    chart
        .configure_mesh()
        .x_desc("triangles")
        .y_desc("nanoseconds a ray")
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .draw()?;
    for (name, color) in [("watertight", &BLUE), ("fast", &RED)] {
        let value = |p: &(f64, f64, f64)| if name == "fast" { p.2 } else { p.1 };
        chart
            .draw_series(LineSeries::new(points.iter().map(|p| (p.0, value(p))), color).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color));
    }
    chart.configure_series_labels().position(SeriesLabelPosition::UpperLeft).border_style(BLACK).draw()?;
    area.present()?;
    Ok(())
}
