//! Light transport algorithms.

use aureole_desc::{Family, Node, Param, Params, SceneError, Value};

use super::scope::Scope;
use super::translate::Translator;
use super::tree::{ObjectId, Tag};

/// Mitsuba's plugins and Aureole's words for them. Wrappers have an empty word.
pub(super) const KINDS: &[(&str, &str)] = &[
    ("path", "path"),
    ("direct", "direct"),
    ("volpath", "path"),
    ("volpathmis", "path"),
    ("depth", "depth"),
    ("ptracer", "path"),
    ("prb", "path"),
    ("prb_basic", "path"),
    ("prb_projective", "path"),
    ("direct_projective", "direct"),
    ("prbvolpath", "path"),
    ("moment", ""),
    ("aov", ""),
    ("stokes", ""),
];

/// Parameters of derivatives, which no picture depends on.
const DERIVATIVES: [&str; 7] =
    ["sppc", "sppp", "sppi", "guiding", "guiding_proj", "guiding_rounds", "project_seed"];

/// Quantities of `aov` that are layers in Aureole by the same name.
const QUANTITIES: [&str; 12] = [
    "albedo",
    "depth",
    "position",
    "uv",
    "geo_normal",
    "sh_normal",
    "dp_du",
    "dp_dv",
    "duv_dx",
    "duv_dy",
    "prim_index",
    "shape_index",
];

/// Sets the scene's integrator.
pub(super) fn root(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<(), SceneError> {
    let tree = t.tree;
    let mut scope = Scope::new(tree, tree.get(id))?;
    if t.scene.integrator.is_some() {
        t.context.report.warn("a scene has one integrator: this one is ignored", scope.span());
        return Ok(());
    }
    let kind = t.kind(&scope, Family::Integrator, KINDS)?;
    let plugin = scope.object.plugin.as_str();
    if kind.is_empty() {
        return wrapper(t, scope);
    }
    if kind == "path" && !plugin.contains("volpath") {
        // There surfaces that are not there are vertices like all others, and hide lights of no size.
        scope.default("see_through", Value::Bool(false));
    }
    match plugin {
        "volpath" | "volpathmis" | "prbvolpath" if tree.has(Tag::Medium) => {
            let message =
                format!("participating media are not rendered yet: `{plugin}` is rendered as `path`");
            t.context.report.warn(message, scope.span());
        }
        // Mitsuba's rays begin at the near plane.
        "depth" => scope.default("from_near_clip", Value::Bool(true)),
        "direct" => {
            if let Some(count) = scope.int("shading_samples")? {
                scope.default("emitter_samples", Value::Int(count));
                scope.default("bsdf_samples", Value::Int(count));
            }
        }
        _ => {}
    }
    // How work is shared out.
    scope.ignore(&["samples_per_pass", "block_size", "timeout", "hq_emitter_sampling"]);
    if plugin.ends_with("_projective") {
        scope.ignore(&DERIVATIVES);
    }
    let node = t.finish(scope, Family::Integrator, kind)?;
    t.scene.integrator = Some(node);
    Ok(())
}

/// An integrator around others: the first one's is the picture, and what else is asked for are layers.
fn wrapper<'a>(t: &mut Translator<'a, '_, '_>, mut scope: Scope<'a>) -> Result<(), SceneError> {
    let plugin = scope.object.plugin.as_str();
    let inner = scope.take_child(&[Tag::Integrator]);
    if let Some(inner) = inner {
        // A wrapper inside itself by reference would never end.
        if t.tree.get(inner.id).plugin == plugin {
            return Err(SceneError::invalid(format!("`{plugin}` inside of `{plugin}`"), inner.span));
        }
        root(t, inner.id)?;
    }
    for other in std::iter::from_fn(|| scope.take_child(&[Tag::Integrator])) {
        t.context.report.warn(format!("`{plugin}` shows the first integrator inside alone"), other.span);
    }
    // What Mitsuba calls a child without a name.
    let name = inner.and_then(|inner| inner.name).unwrap_or("_arg_0");
    let layers = match plugin {
        "aov" => {
            let views = aovs(t, &mut scope)?;
            let picture = inner.map(|_| format!("{name}:radiance"));
            picture.into_iter().chain(views).collect()
        }
        "moment" => vec![format!("{name}:xyz"), format!("m2_{name}:xyz2")],
        _ => {
            let message =
                format!("`{plugin}` is left out: only the picture of the integrator inside is rendered");
            t.context.report.warn(message, scope.span());
            Vec::new()
        }
    };
    t.leave(&scope);
    let integrator = match (inner, t.scene.integrator) {
        (Some(_), Some(integrator)) => integrator,
        _ if plugin == "aov" => {
            let node = t.scene.add(Node::new(Family::Integrator, "aov", Params::new(), scope.span()));
            t.scene.integrator = Some(node);
            node
        }
        _ => return Err(scope.missing("integrator", "an integrator inside")),
    };
    let params = &mut t.scene[integrator].params;
    let inner_layers = params.try_string("layers")?;
    let inner_layers =
        inner_layers.iter().flat_map(|list| list.split(',')).map(|layer| format!("{name}.{layer}"));
    let all: Vec<String> = layers.into_iter().chain(inner_layers).collect();
    if !all.is_empty() {
        params.set(Param {
            name: "layers".to_owned(),
            value: Value::String(all.join(",")),
            span: scope.span(),
        });
    }
    Ok(())
}

/// The layers that `aovs` asks for.
fn aovs(t: &mut Translator<'_, '_, '_>, scope: &mut Scope<'_>) -> Result<Vec<String>, SceneError> {
    let at = scope.values.span("aovs");
    let text = scope.string("aovs")?.ok_or_else(|| scope.missing("aovs", "pairs `name:quantity`"))?;
    let mut layers = Vec::new();
    for pair in text.split(',').map(str::trim).filter(|pair| !pair.is_empty()) {
        match pair.rsplit_once(':') {
            Some((_, quantity)) if QUANTITIES.contains(&quantity.trim()) => layers.push(pair.to_owned()),
            _ => t.context.report.warn(format!("the layer `{pair}` is left out"), at),
        }
    }
    Ok(layers)
}
