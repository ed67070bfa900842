//! Clouds of ellipsoids, which become stretched spheres.

use aureole_desc::{Family, Node, NodeId, Param, SceneError, Value};
use aureole_math::{Transform, Vector3};

use super::scope::Scope;
use super::shape::surface;
use super::translate::Translator;
use super::tree::ObjectId;
use crate::mesh::ply;

/// Columns of the files that Gaussian splatting writes: sizes are logarithms, turns are quaternions with the real part first.
const COLUMNS: [&str; 10] =
    ["x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"];

/// Adds a sphere for each ellipsoid.
pub(super) fn gather<'a>(
    t: &mut Translator<'a, '_, '_>,
    id: ObjectId,
    shapes: &mut Vec<NodeId>,
) -> Result<(), SceneError> {
    let mut scope = Scope::new(t.tree, t.tree.get(id))?;
    let (path, at) = t.path(&mut scope, "filename")?;
    let extent = scope.float("extent")?.unwrap_or(3.0) * scope.float("scale_factor")?.unwrap_or(1.0);
    let to_world = scope.values.transform("to_world")?;
    scope.ignore(&["to_world", "shell", "extent_adaptive_clamping"]);
    surface(t, &mut scope)?;
    let values = ply::read_columns(&path, &COLUMNS, &t.context.options.limits, at)?;
    for row in values.chunks_exact(COLUMNS.len()) {
        let place = to_world * Transform::translate(vector(&row[..3])) * turned(&row[6..]);
        let size = vector(&row[3..6]).to_array().map(|log| log.exp().max(1e-6) * extent as f32);
        let mut params = scope.out.clone();
        let world_from_object = Value::Transform(place * Transform::scale(Vector3::from(size)));
        params.set(Param { name: "world_from_object".to_owned(), value: world_from_object, span: at });
        shapes.push(t.scene.add(Node::new(Family::Shape, "sphere", params, scope.span())));
    }
    t.leave(&scope);
    Ok(())
}

fn vector(v: &[f32]) -> Vector3 {
    Vector3::new(v[0], v[1], v[2])
}

/// The rotation of a quaternion; none where it is zero.
fn turned(q: &[f32]) -> Transform {
    let axis = vector(&q[1..]);
    let angle = 2.0 * f64::from(axis.length()).atan2(f64::from(q[0]));
    match axis.try_normalized() {
        Some(axis) => Transform::rotate(axis, angle.to_degrees()),
        None => Transform::default(),
    }
}
