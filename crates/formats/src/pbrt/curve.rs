//! `Shape "curve"`: one strip of several segments.

use aureole_desc::{Params, SceneError, Value};

use super::params::ParamSet;
use super::shapes::missing;

/// A word for a known choice.
fn choice<'a>(given: &ParamSet, name: &str, known: &[(&'a str, &'a str)]) -> Result<&'a str, SceneError> {
    let Some(word) = given.text(name)? else { return Ok(known[0].1) };
    let found = known.iter().find(|(theirs, _)| *theirs == word);
    found.map(|(_, ours)| *ours).ok_or_else(|| SceneError::UnknownName {
        what: "kind of curve",
        name: word.to_owned(),
        known: known.iter().map(|(theirs, _)| (*theirs).to_owned()).collect(),
        at: given.at(name),
    })
}

/// Translates a curve; those of degree two become cubic.
pub(super) fn translate(given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
    let at = given.span;
    let style = choice(given, "type", &[("flat", "flat"), ("ribbon", "ribbon"), ("cylinder", "cylinder")])?;
    let mut basis = choice(given, "basis", &[("bezier", "bezier"), ("bspline", "bspline")])?;
    let list = given.floats("P")?.ok_or_else(|| missing("curve", "P", "control points", at))?;
    let mut points: Vec<[f32; 3]> = list.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let degree = given.int("degree", 3)?;
    if degree == 2 {
        points = raise(&points, basis == "bspline")
            .ok_or_else(|| SceneError::invalid("these control points do not make a curve", given.at("P")))?;
        basis = "bezier";
    } else if degree != 3 {
        return Err(SceneError::invalid("the degree of curves is 2 or 3", given.at("degree")));
    }
    let width = given.float("width", 1.0)?;
    for (theirs, ours) in [("width0", "width0"), ("width1", "width1")] {
        params.push(ours, Value::Float(given.float(theirs, width)?), at);
    }
    match given.floats("N")? {
        Some(normals) if style == "ribbon" => {
            params.push("normals", Value::Floats(normals.into()), given.at("N"));
        }
        None if style == "ribbon" => {
            return Err(missing("curve", "N", "a normal for each end of a segment", at));
        }
        _ => {}
    }
    given.get("splitdepth"); // for pbrt's own boxes
    params.push("points", Value::Floats(points.concat().into()), given.at("P"));
    params.push("basis", Value::String(basis.to_owned()), at);
    params.push("style", Value::String(style.to_owned()), at);
    Ok("curve")
}

/// The same quadratic curve as cubic Bézier segments.
fn raise(points: &[[f32; 3]], is_spline: bool) -> Option<Vec<[f32; 3]>> {
    let mix = |a: [f32; 3], b: [f32; 3], t: f32| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t);
    let quadratics: Vec<[[f32; 3]; 3]> = match is_spline {
        true => points.windows(3).map(|p| [mix(p[0], p[1], 0.5), p[1], mix(p[1], p[2], 0.5)]).collect(),
        false => (points.len() % 2 == 1)
            .then(|| points.windows(3).step_by(2).map(|p| [p[0], p[1], p[2]]).collect())?,
    };
    let mut cubic = vec![quadratics.first()?[0]];
    for [a, b, c] in quadratics {
        cubic.extend([mix(a, b, 2.0 / 3.0), mix(c, b, 2.0 / 3.0), c]);
    }
    Some(cubic)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raised_curves_stay_where_they_are() {
        let arc = [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [2.0, 0.0, 0.0]];
        assert_eq!(raise(&arc, false).map(|p| p.len()), Some(4));
        let spline = raise(&[arc[0], arc[1], arc[2], [3.0, 0.0, 1.0]], true).expect("is sound");
        assert_eq!(spline.len(), 7);
        assert_eq!([spline[0], spline[3]], [[0.5, 1.0, 0.0], [1.5, 1.0, 0.0]]);
        assert!(raise(&arc[..2], true).is_none() && raise(&arc[..2], false).is_none());
    }
}
