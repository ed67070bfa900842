//! Signs by which scenes of pbrt's third version are known, which the fourth converts.

use aureole_desc::SceneError;

use super::params::ParamSet;
use super::state::Reader;

/// Kinds that the third version had and the fourth has no more.
const KINDS: &[(&str, &[&str])] = &[
    ("Film", &["image"]),
    ("Sampler", &["02sequence", "lowdiscrepancy", "maxmindist", "random"]),
    ("Integrator", &["directlighting", "whitted"]),
    ("Shape", &["cone", "heightfield", "heightfield2", "hyperboloid", "nurbs", "paraboloid"]),
    ("LightSource", &["exinfinite"]),
    ("Texture", &["color", "uv"]),
    ("Camera", &["environment"]),
    (
        "Material",
        &[
            "disney",
            "fourier",
            "glass",
            "kdsubsurface",
            "matte",
            "metal",
            "mirror",
            "plastic",
            "substrate",
            "translucent",
            "uber",
        ],
    ),
];

/// Parameters that have other names in the fourth version.
const PARAMETERS: &[(&str, &[&str])] = &[
    ("PixelFilter", &["xwidth", "ywidth"]),
    ("LightSource", &["mapname"]),
    ("Material", &["Kd", "Ks", "Kr", "Kt", "bumpmap"]),
];

fn has(table: &[(&str, &[&str])], directive: &str, word: &str) -> bool {
    let directive = if directive == "MakeNamedMaterial" { "Material" } else { directive };
    table.iter().any(|(known, words)| *known == directive && words.contains(&word))
}

impl Reader<'_, '_> {
    /// Looks for a sign of version 3 in a directive. The first one is a warning that says how such scenes are converted.
    pub(super) fn look_for_version3(&mut self, directive: &str, kind: &str, params: &ParamSet) {
        if self.is_version3 {
            return;
        }
        let kind = if directive == "MakeNamedMaterial" { params.peek_text("type") } else { Some(kind) };
        let sign = match kind {
            Some(kind) if has(KINDS, directive, kind) => (format!("{directive} \"{kind}\""), params.span),
            _ => {
                let mut names = params.names();
                let Some((name, at)) = names.find(|(name, _)| has(PARAMETERS, directive, name)) else {
                    return;
                };
                (format!("`{name}` of {directive}"), at)
            }
        };
        self.is_version3 = true;
        let (sign, at) = sign;
        self.context.report.warn_with_help(
            format!("this is a scene of pbrt version 3, by its {sign}: what is read is version 4"),
            Some("`pbrt --upgrade OLD.pbrt > NEW.pbrt` (of pbrt-v4) converts it".to_owned()),
            at,
        );
    }
}

/// The error that ends the reading of such a scene, if there is no use in going on: every material would be another.
pub(super) fn give_up(error: &SceneError) -> Option<SceneError> {
    let is_hopeless = matches!(error, SceneError::UnknownKind { .. } | SceneError::UnknownName { .. });
    let message =
        format!("{error}: convert the scene from pbrt version 3 with `pbrt --upgrade` (of pbrt-v4)");
    is_hopeless.then(|| SceneError::syntax(message, error.span()))
}
