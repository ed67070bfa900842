//! Materials.

use aureole_desc::{Family, NodeId, SceneError, Value};
use aureole_spectrum::SpectrumSource;

use super::scope::Scope;
use super::translate::Translator;
use super::tree::Tag;
use crate::brdf;

/// Mitsuba's plugins and Aureole's words for them. Not all of the latter can be rendered yet.
pub(super) const KINDS: &[(&str, &str)] = &[
    ("diffuse", "diffuse"),
    ("conductor", "conductor"),
    ("roughconductor", "rough_conductor"),
    ("dielectric", "dielectric"),
    ("thindielectric", "thin_dielectric"),
    ("roughdielectric", "rough_dielectric"),
    ("plastic", "plastic"),
    ("roughplastic", "rough_plastic"),
    ("difftrans", "diffuse_transmission"),
    ("twosided", "two_sided"),
    ("mask", "mask"),
    ("blendbsdf", "blend"),
    ("bumpmap", "bump"),
    ("normalmap", "normal_map"),
    ("null", "null"),
    ("principled", "principled"),
    ("principledthin", "principled_thin"),
    ("hair", "hair"),
    // Not Mitsuba's, but asked for by that name.
    ("openpbr", "open_pbr"),
    ("measured", "measured"),
    ("measured_polarized", "measured_polarized"),
    ("pplastic", "baek_plastic"),
    // What optical filters are to light whose polarisation is not carried.
    ("polarizer", "null"),
    ("retarder", "null"),
    ("circular", "null"),
];

pub(super) fn translate<'a>(
    t: &mut Translator<'a, '_, '_>,
    mut scope: Scope<'a>,
) -> Result<NodeId, SceneError> {
    let mut kind = t.kind(&scope, Family::Bsdf, KINDS)?;
    // How normals are sampled changes noise, not pictures.
    scope.ignore(&["sample_visible"]);
    match scope.object.plugin.as_str() {
        "conductor" => metal(&mut scope),
        "roughconductor" => {
            metal(&mut scope);
            scope.default("distribution", word("beckmann"));
        }
        "roughdielectric" | "roughplastic" => scope.default("distribution", word("beckmann")),
        "hair" => hair(&mut scope),
        "principled" | "principledthin" => scope.ignore(&[
            "main_specular_sampling_rate",
            "clearcoat_sampling_rate",
            "specular_reflectance_sampling_rate",
            "specular_transmittance_sampling_rate",
            "diffuse_reflectance_sampling_rate",
            "diffuse_transmittance_sampling_rate",
        ]),
        "pplastic" => scope.default("distribution", word("beckmann")),
        "polarizer" | "retarder" | "circular" => filter(&mut scope),
        "measured" => {
            let (path, at) = t.path(&mut scope, "filename")?;
            let (found, params) = brdf::read(&path, &t.context.options.limits, at)?;
            kind = found;
            params.iter().for_each(|param| scope.out.set(param.clone()));
        }
        "measured_polarized" => t.put_path(&mut scope)?,
        "twosided" => {
            t.put_required(&mut scope, "bsdf", Tag::Bsdf)?;
            if let Some(back) = scope.take_child(&[Tag::Bsdf]) {
                t.put(&mut scope, "back", back)?;
            }
        }
        "mask" => t.put_required(&mut scope, "bsdf", Tag::Bsdf)?,
        "blendbsdf" => {
            t.put_required(&mut scope, "a", Tag::Bsdf)?;
            t.put_required(&mut scope, "b", Tag::Bsdf)?;
            scope.default("dirac", word("density_one"));
        }
        "bumpmap" | "normalmap" => {
            scope.rename("use_shadowing_function", "soften_terminator");
            t.put_required(&mut scope, "texture", Tag::Texture)?;
            t.put_required(&mut scope, "bsdf", Tag::Bsdf)?;
        }
        _ => {}
    }
    t.finish(scope, Family::Bsdf, kind)
}

fn word(text: &str) -> Value {
    Value::String(text.to_owned())
}

/// Mitsuba's metals are perfect mirrors unless a name or an index is given, and a missing half of the index is 0 or 1.
fn metal(scope: &mut Scope<'_>) {
    let uniform = |x| Value::Spectrum(SpectrumSource::Uniform(x));
    if scope.has("eta") || scope.has("k") {
        scope.default("eta", uniform(0.0));
        scope.default("k", uniform(1.0));
    } else {
        scope.default("material", word("none"));
    }
}

/// Polarisers take half of unpolarised light, at any angle; retarders change nothing but its phase.
fn filter(scope: &mut Scope<'_>) {
    if scope.object.plugin != "retarder" {
        scope.out.push("scale", Value::Float(0.5), scope.span());
    }
    for name in ["theta", "delta", "polarizing", "left_handed"] {
        scope.take(name);
        scope.take_named(name);
    }
}

/// Mitsuba's hair is known by other names, and meets its round curves by their normals.
fn hair(scope: &mut Scope<'_>) {
    for (theirs, ours) in
        [("longitudinal_roughness", "beta_m"), ("azimuthal_roughness", "beta_n"), ("scale_tilt", "alpha")]
    {
        scope.rename(theirs, ours);
    }
    scope.default("offset", word("normal"));
    scope.default("int_ior", word("amber"));
    if !scope.has("sigma_a") {
        scope.default("eumelanin", Value::Float(1.3));
        scope.default("pheomelanin", Value::Float(0.2));
    }
}
