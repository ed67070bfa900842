//! Participating media: parsed, and kept for the day when they are rendered.

use aureole_desc::{Family, NodeId, SceneError, Value};

use super::scope::Scope;
use super::translate::Translator;
use super::tree::Tag;

const KINDS: &[(&str, &str)] = &[("homogeneous", "homogeneous"), ("heterogeneous", "heterogeneous")];

const VOLUMES: &[(&str, &str)] = &[("gridvolume", "grid"), ("constvolume", "constant")];

pub(super) fn translate<'a>(
    t: &mut Translator<'a, '_, '_>,
    mut scope: Scope<'a>,
) -> Result<NodeId, SceneError> {
    let kind = t.kind(&scope, Family::Medium, KINDS)?;
    if let Some(phase) = scope.take_child(&[Tag::Phase]) {
        let phase = t.tree.get(phase.id);
        scope.out.push("phase", Value::String(phase.plugin.clone()), phase.span);
        for param in phase.values.iter() {
            scope.out.set(param.clone());
        }
    }
    t.finish(scope, Family::Medium, kind)
}

/// A quantity in space: a constant, or a file.
pub(super) fn volume<'a>(t: &mut Translator<'a, '_, '_>, mut scope: Scope<'a>) -> Result<Value, SceneError> {
    match t.kind(&scope, Family::Medium, VOLUMES)? {
        "constant" => {
            let value = scope.spectrum("value")?;
            t.leave(&scope);
            value.map(Value::Spectrum).ok_or_else(|| scope.missing("value", "a colour or number"))
        }
        _ => {
            let path = t.path(&mut scope, "filename")?.0;
            t.leave(&scope);
            Ok(Value::Path(path))
        }
    }
}
