//! Camera, lights and ground for an object of any size.

use std::path::Path;

use aureole_desc::{Family, Mesh, Node, Params, SceneDesc, SceneError, Span, Value};
use aureole_math::{Bounds3, Point3, Transform, Vector3, spherical_direction};

use super::material;

/// Angle of view, degrees.
const FOV: f64 = 30.0;
/// Radiance of the surroundings, and of the key light above them.
const SKY: f64 = 0.4;
const KEY: f64 = 8.0;
/// Distance and radius of the key light, in radii of the object. With these a white surface that faces the light gets
/// about the radiance 1.2: KEY · (1.25 / 4)² + SKY.
const KEY_DISTANCE: f32 = 4.0;
const KEY_RADIUS: f32 = 1.25;
/// Radius of the ground, in radii of the object.
const GROUND: f32 = 40.0;

/// Sets the stage for meshes: adds everything but them.
///
/// # Errors
/// Meshes without a finite vertex.
pub(super) fn set<'a>(
    scene: &mut SceneDesc,
    meshes: impl Iterator<Item = &'a Mesh>,
    path: &Path,
    at: Span,
) -> Result<(), SceneError> {
    let points = meshes.flat_map(|mesh| &mesh.positions).map(|&p| Point3::from(p)).filter(|p| p.is_finite());
    let bounds = Bounds3::around(points);
    let radius = bounds.diagonal().length() / 2.0;
    if bounds.is_empty() || !radius.is_finite() {
        let message = "no vertex has finite coordinates".to_owned();
        return Err(SceneError::Asset { path: path.to_owned(), message, at });
    }
    // One point has no size; anything will do.
    let radius = if radius > 0.0 { radius } else { 1.0 };
    let center = bounds.centroid();
    add_camera(scene, &bounds, radius, at);
    add_lights(scene, center, radius, at);
    add_ground(scene, Point3::new(center.x, bounds.min.y, center.z), radius, at);
    let params = Params::new().with("width", Value::Int(800)).with("height", Value::Int(600));
    scene.film = Some(scene.add(Node::new(Family::Film, "film", params, at)));
    Ok(())
}

/// A direction by its angles from +Z around +Y, and above the horizon, in degrees.
fn direction(azimuth: f32, elevation: f32) -> Vector3 {
    let d = spherical_direction((90.0 - elevation).to_radians(), azimuth.to_radians());
    // The polar axis is Y here: x is across, z towards the viewer at azimuth 0.
    Vector3::new(d.y, d.z, d.x)
}

/// From a point, +Z towards a target.
fn aim(from: Point3, target: Point3) -> Transform {
    Transform::look_at(from, target, Vector3::Y).unwrap_or(Transform::IDENTITY)
}

fn add_camera(scene: &mut SceneDesc, bounds: &Bounds3, radius: f32, at: Span) {
    let (center, back) = (bounds.centroid(), direction(28.0, 22.0));
    let distance = framing_distance(bounds, back).max(1.1 * radius);
    let world_from_camera = aim(center + back * distance, center);
    let params = Params::new()
        .with("world_from_camera", Value::Transform(world_from_camera))
        .with("fov", Value::Float(FOV))
        .with("fov_axis", Value::String("smaller".to_owned()))
        .with("near_clip", Value::Float(f64::from(distance) * 1e-3))
        .with("far_clip", Value::Float(f64::from(distance) * 1e3));
    let camera = scene.add(Node::new(Family::Camera, "perspective", params, at).named("camera"));
    scene.cameras.push(camera);
}

/// How far back from its centre a box just fits between the rays at the border, with some room.
fn framing_distance(bounds: &Bounds3, back: Vector3) -> f32 {
    let center = bounds.centroid();
    let camera_from_world = aim(center + back, center).inverse();
    let slope = (FOV / 2.0).to_radians().tan() as f32;
    let distances = bounds.corners().map(|corner| {
        let v = camera_from_world.vector(corner - center);
        v.x.abs().max(v.y.abs()) / slope - v.z
    });
    1.15 * distances.into_iter().fold(0.0, f32::max)
}

fn add_lights(scene: &mut SceneDesc, center: Point3, radius: f32, at: Span) {
    let params = Params::new().with("radiance", Value::Float(SKY));
    let sky = scene.add(Node::new(Family::Light, "constant", params, at).named("sky"));
    scene.lights.push(sky);

    let params = Params::new().with("radiance", Value::Float(KEY));
    let emission = scene.add(Node::new(Family::Light, "area", params, at));
    let place = aim(center + direction(-35.0, 50.0) * (KEY_DISTANCE * radius), center);
    let black = scene.add(Node::new(
        Family::Bsdf,
        "diffuse",
        Params::new().with("reflectance", Value::Float(0.0)),
        at,
    ));
    let params = Params::new()
        .with("world_from_object", Value::Transform(place))
        .with("radius", Value::Float(f64::from(KEY_RADIUS * radius)))
        .with("bsdf", Value::Node(black))
        .with("emission", Value::Node(emission));
    let key = scene.add(Node::new(Family::Shape, "disk", params, at).named("key"));
    scene.shapes.push(key);
}

fn add_ground(scene: &mut SceneDesc, below: Point3, radius: f32, at: Span) {
    let bsdf = material::two_sided_diffuse(scene, Value::Float(0.35), at);
    // A disk lies in the plane z = 0; a hair lower than the object, so that flat undersides do not fight with it.
    let place = Transform::translate(below.to_vector() - Vector3::Y * (1e-4 * radius))
        * Transform::rotate(Vector3::X, -90.0);
    let params = Params::new()
        .with("world_from_object", Value::Transform(place))
        .with("radius", Value::Float(f64::from(GROUND * radius)))
        .with("bsdf", Value::Node(bsdf));
    let ground = scene.add(Node::new(Family::Shape, "disk", params, at).named("ground"));
    scene.shapes.push(ground);
}
