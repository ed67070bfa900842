//! `<transform>`: a chain of maps, each applied after those before it.

use aureole_desc::{SceneError, Value};
use aureole_math::{Point3, Transform, Vector3};
use roxmltree::Node;

use super::FileInfo;
use super::define::Defines;
use super::element::Element;
use super::property::{numbers, vector};

/// Parses a transform; gives its name too.
pub(super) fn parse(
    node: Node<'_, '_>,
    element: &Element<'_>,
    file: &FileInfo,
    defines: &mut Defines,
) -> Result<(String, Value), SceneError> {
    let mut transform = Transform::IDENTITY;
    for child in node.children().filter(Node::is_element) {
        let step = Element::new(child, file, defines)?;
        transform = step_transform(&step)? * transform;
    }
    if !transform.is_invertible() {
        return Err(SceneError::invalid("the transform has no inverse", element.span()));
    }
    Ok((element.required("name")?, Value::Transform(transform)))
}

fn step_transform(step: &Element<'_>) -> Result<Transform, SceneError> {
    match step.tag().to_ascii_lowercase().as_str() {
        "translate" => {
            step.allow(&["value", "x", "y", "z"])?;
            Ok(Transform::translate(to_vector(vector(step, 0.0)?)))
        }
        "scale" => {
            step.allow(&["value", "x", "y", "z"])?;
            let factors = vector(step, 1.0)?;
            if factors.contains(&0.0) {
                return Err(SceneError::invalid("a scale by zero has no inverse", step.span()));
            }
            Ok(Transform::scale(to_vector(factors)))
        }
        "rotate" => rotate(step),
        "matrix" => matrix(step),
        "lookat" => look_at(step),
        unknown => Err(SceneError::UnknownName {
            what: "transform",
            name: unknown.to_owned(),
            known: ["translate", "scale", "rotate", "matrix", "lookat"].map(str::to_owned).to_vec(),
            at: step.span(),
        }),
    }
}

fn to_vector(v: [f64; 3]) -> Vector3 {
    Vector3::from(v.map(|x| x as f32))
}

fn rotate(step: &Element<'_>) -> Result<Transform, SceneError> {
    step.allow(&["value", "x", "y", "z", "angle"])?;
    let angle = step.required("angle")?;
    let angle = angle.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let angle = angle.ok_or_else(|| step.bad("angle", "an angle in degrees"))?;
    let axis = vector(step, 0.0)?;
    if axis == [0.0; 3] {
        return Err(SceneError::invalid("a rotation needs an axis: x, y or z", step.span()));
    }
    rotation(axis, angle).ok_or_else(|| SceneError::invalid("the rotation has no inverse", step.span()))
}

/// Rodrigues' formula with the axis as it is: Mitsuba 3 does not normalise it, so that one of another length than one stretches
/// as well.
fn rotation([x, y, z]: [f64; 3], angle: f64) -> Option<Transform> {
    let (sin, cos) = angle.to_radians().sin_cos();
    let t = 1.0 - cos;
    Transform::from_rows([
        [cos + t * x * x, t * x * y - sin * z, t * x * z + sin * y, 0.0],
        [t * x * y + sin * z, cos + t * y * y, t * y * z - sin * x, 0.0],
        [t * x * z - sin * y, t * y * z + sin * x, cos + t * z * z, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ])
}

/// Sixteen numbers by rows, or nine for the part without translation.
fn matrix(step: &Element<'_>) -> Result<Transform, SceneError> {
    step.allow(&["value"])?;
    step.required("value")?;
    let values = numbers(step.get("value").unwrap_or("")).unwrap_or_default();
    let rows: [[f64; 4]; 4] = match values.len() {
        16 => std::array::from_fn(|row| std::array::from_fn(|column| values[4 * row + column])),
        9 => std::array::from_fn(|row| {
            std::array::from_fn(|column| match (row, column) {
                (3, 3) => 1.0,
                (3, _) | (_, 3) => 0.0,
                _ => values[3 * row + column],
            })
        }),
        _ => return Err(step.bad("value", "16 or 9 numbers")),
    };
    Transform::from_rows(rows)
        .ok_or_else(|| SceneError::invalid("the matrix has no inverse", step.value_span()))
}

fn look_at(step: &Element<'_>) -> Result<Transform, SceneError> {
    step.allow(&["origin", "target", "up"])?;
    let three = |name: &str| match step.get(name).map(numbers) {
        Some(Some(v)) if v.len() == 3 => Ok([v[0], v[1], v[2]]),
        Some(_) => Err(step.bad(name, "three numbers")),
        None => step.required(name).map(|_| [0.0; 3]),
    };
    let point = |name: &str| three(name).map(|v| Point3::from(v.map(|x| x as f32)));
    let (origin, target) = (point("origin")?, point("target")?);
    // Any direction that is not the view's will do where none is given.
    let up = match step.has("up") {
        true => to_vector(three("up")?),
        false => {
            let d = target - origin;
            if d.x.abs() + d.z.abs() > 1e-3 * d.length() { Vector3::Y } else { Vector3::Z }
        }
    };
    Transform::look_at(origin, target, up)
        .ok_or_else(|| SceneError::invalid("origin, target and up lie on one line", step.span()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mitsuba 3.9.1's matrices for an axis of length one, and for others: rows of the linear part.
    #[test]
    fn axes_that_are_not_of_length_one_stretch() {
        for (axis, rows) in [
            ([0.0, 0.0, 1.0], [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            ([0.0, 0.0, 2.0], [[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 4.0]]),
            ([1.0, 1.0, 0.0], [[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, 0.0]]),
        ] {
            let found =
                rotation(axis, 90.0).map(|t| [Vector3::X, Vector3::Y, Vector3::Z].map(|v| t.vector(v)));
            let columns = found.expect("has an inverse");
            for (i, row) in rows.into_iter().enumerate() {
                for (j, value) in row.into_iter().enumerate() {
                    let x = columns[j].to_array()[i];
                    assert!((x - value).abs() < 1e-6, "{axis:?}: {columns:?}");
                }
            }
        }
    }
}
