//! Scenes of Mitsuba 0.6 and earlier in today's words.

use crate::mitsuba::tree::Tag;

/// Whether a scene's version is before 2.0. A scene without one is taken for a new one.
pub(super) fn is_legacy(version: Option<&str>) -> bool {
    let major = version
        .and_then(|version| version.split('.').next())
        .and_then(|major| major.trim().parse::<u32>().ok());
    major.is_some_and(|major| major < 2)
}

/// `toWorld` as `to_world`, `intIOR` as `int_ior`.
pub(super) fn snake_case(name: &str) -> String {
    let mut result = String::with_capacity(name.len() + 4);
    let mut after_lower = false;
    for c in name.chars() {
        if c.is_uppercase() && after_lower {
            result.push('_');
        }
        after_lower = c.is_lowercase() || c.is_ascii_digit();
        result.extend(c.to_lowercase());
    }
    result
}

/// Plugins that changed their names.
pub(super) fn plugin(tag: Tag, name: &str) -> &str {
    match (tag, name) {
        (Tag::Bsdf, "bump") => "bumpmap",
        (Tag::Bsdf, "lambertian") => "diffuse",
        (Tag::Bsdf, "mirror") => "conductor",
        (Tag::Film, "ldrfilm" | "exrfilm" | "pngfilm") => "hdrfilm",
        (Tag::Filter, "windowedsinc") => "lanczos",
        (Tag::Sampler, "halton" | "hammersley" | "sobol") => "ldsampler",
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_names_become_new_ones() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("sampleCount", "sample_count"),
            ("alphaU", "alpha_u"),
            ("fov", "fov"),
            ("color0", "color0"),
            ("diffuse_reflectance", "diffuse_reflectance"),
        ] {
            assert_eq!(snake_case(old), new);
        }
        assert!(is_legacy(Some("0.6.0")) && is_legacy(Some("1.2")));
        assert!(!is_legacy(Some("2.0.0")) && !is_legacy(Some("3.0.0")) && !is_legacy(None));
    }
}
