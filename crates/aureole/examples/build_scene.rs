//! Builds a scene in code: three balls of gold on a floor, under a window of light.

use aureole::prelude::*;

fn node(desc: &mut SceneDesc, family: Family, kind: &str, params: Params) -> NodeId {
    desc.add(Node::new(family, kind, params, Span::NONE))
}

fn rgb(r: f32, g: f32, b: f32) -> Value {
    Value::Spectrum(SpectrumSource::Rgb([r, g, b]))
}

#[expect(clippy::print_stdout, reason = "it is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut desc = SceneDesc::default();

    for (i, alpha) in [0.05, 0.15, 0.4].into_iter().enumerate() {
        let gold =
            Params::new().with("material", Value::String("Au".into())).with("alpha", Value::Float(alpha));
        let gold = node(&mut desc, Family::Bsdf, "rough_conductor", gold);
        let center = Value::Vec3([2.2 * (i as f64 - 1.0), 1.0, 0.0]);
        let ball = Params::new().with("center", center).with("bsdf", Value::Node(gold));
        let ball = node(&mut desc, Family::Shape, "sphere", ball);
        desc.shapes.push(ball);
    }

    let up = Transform::rotate(Vector3::X, -90.0);
    let floor =
        Params::new().with("world_from_object", Value::Transform(up * Transform::scale(Vector3::splat(8.0))));
    let floor = node(&mut desc, Family::Shape, "rectangle", floor);

    let light = Params::new().with("radiance", rgb(8.0, 7.0, 6.0));
    let light = node(&mut desc, Family::Light, "area", light);
    let place =
        Transform::look_at(Point3::new(-3.0, 6.0, 3.0), Point3::ORIGIN, Vector3::Y).ok_or("degenerate")?;
    let window =
        Params::new().with("world_from_object", Value::Transform(place)).with("emission", Value::Node(light));
    let window = node(&mut desc, Family::Shape, "rectangle", window);
    desc.shapes.extend([floor, window]);

    let sky =
        node(&mut desc, Family::Light, "constant", Params::new().with("radiance", rgb(0.2, 0.25, 0.35)));
    desc.lights.push(sky);

    let eye = Transform::look_at(Point3::new(0.0, 3.0, 9.0), Point3::new(0.0, 0.8, 0.0), Vector3::Y);
    let camera = Params::new().with("world_from_camera", Value::Transform(eye.ok_or("degenerate")?));
    let camera = node(&mut desc, Family::Camera, "perspective", camera);
    desc.cameras.push(camera);

    let scene = compile(&desc, &CompileOptions::default(), &mut Report::default())?;
    let rendered = render(&scene, &RenderOptions { spp: Some(32), ..RenderOptions::default() }, &Silent)?;
    let file = std::env::temp_dir().join("build_scene.png");
    write_image(&rendered.image, &file, &WriteOptions::default())?;
    println!("{}", file.display());
    Ok(())
}
