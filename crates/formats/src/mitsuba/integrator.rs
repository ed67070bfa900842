//! Light transport algorithms.

use aureole_desc::{Family, Node, Params, SceneError, Value};

use super::scope::Scope;
use super::translate::Translator;
use super::tree::{ObjectId, Tag};

/// Mitsuba's plugins and Aureole's words for them. Wrappers have an empty word.
const KINDS: &[(&str, &str)] = &[
    ("path", "path"),
    ("direct", "direct"),
    ("volpath", "path"),
    ("volpathmis", "path"),
    ("depth", "depth"),
    ("ptracer", "path"),
    ("prb", "path"),
    ("prb_basic", "path"),
    ("prb_projective", "path"),
    ("prbvolpath", "path"),
    ("moment", ""),
    ("aov", ""),
    ("stokes", ""),
];

/// Quantities of `aov` that Aureole has a view of.
const VIEWS: [(&str, &str); 6] = [
    ("depth", "depth"),
    ("sh_normal", "normals"),
    ("geo_normal", "normals"),
    ("uv", "uv"),
    ("albedo", "albedo"),
    ("prim_index", "primitive_id"),
];

/// Sets the scene's integrator.
pub(super) fn root(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<(), SceneError> {
    let tree = t.tree;
    let mut scope = Scope::new(tree, tree.get(id))?;
    let kind = t.kind(&scope, Family::Integrator, KINDS)?;
    let plugin = scope.object.plugin.as_str();
    if kind.is_empty() {
        return wrapper(t, scope);
    }
    match plugin {
        "volpath" | "volpathmis" | "prbvolpath" if tree.has(Tag::Medium) => {
            let message =
                format!("participating media are not rendered yet: `{plugin}` is rendered as `path`");
            t.context.report.warn(message, scope.span());
        }
        "ptracer" | "prb" | "prb_basic" | "prb_projective" => {
            t.context.report.warn(format!("`{plugin}` is rendered as `path`"), scope.span());
        }
        "direct" => {
            if let Some(count) = scope.int("shading_samples")? {
                scope.default("emitter_samples", Value::Int(count));
                scope.default("bsdf_samples", Value::Int(count));
            }
        }
        _ => {}
    }
    // How work is shared out, and derivatives.
    scope.ignore(&["samples_per_pass", "block_size", "timeout", "hide_environment", "hq_emitter_sampling"]);
    let node = t.finish(scope, Family::Integrator, kind)?;
    t.scene.integrator = Some(node);
    Ok(())
}

/// An integrator around another: the other is what is rendered.
fn wrapper<'a>(t: &mut Translator<'a, '_, '_>, mut scope: Scope<'a>) -> Result<(), SceneError> {
    let plugin = scope.object.plugin.as_str();
    let inner = scope.take_child(&[Tag::Integrator]);
    if let Some(inner) = inner {
        if plugin != "moment" {
            let message =
                format!("`{plugin}` is left out: only the picture of the integrator inside is rendered");
            t.context.report.warn(message, scope.span());
        }
        // A wrapper inside itself by reference would never end.
        if t.tree.get(inner.id).plugin == plugin {
            return Err(SceneError::invalid(format!("`{plugin}` inside of `{plugin}`"), inner.span));
        }
        return root(t, inner.id);
    }
    let views = scope.string("aovs")?.unwrap_or_default();
    let found = views.split(',').find_map(|view| {
        let quantity = view.rsplit(':').next()?.trim();
        VIEWS.iter().find(|(name, _)| *name == quantity).map(|(_, kind)| *kind)
    });
    let kind = found.ok_or_else(|| scope.missing("integrator", "an integrator inside"))?;
    let node = t.scene.add(Node::new(Family::Integrator, kind, Params::new(), scope.span()));
    t.scene.integrator = Some(node);
    Ok(())
}
