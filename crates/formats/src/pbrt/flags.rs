//! `Option`: a name between quotes and a value.

use aureole_desc::{SceneError, Span};

use super::lexer::{Lexer, Spanned, Token};
use super::params::number;
use super::state::Reader;

/// Options that have nothing to do with the picture, or say how pbrt runs.
const WITHOUT_EFFECT: [&str; 6] = [
    "disablewavelengthjitter",
    "msereferenceimage",
    "msereferenceout",
    "pixelstats",
    "rendercoordsys",
    "wavefront",
];
/// Options that would change the picture or its noise.
const IGNORED: [&str; 1] = ["seed"];

impl Reader<'_, '_> {
    pub(super) fn option(&mut self, lexer: &mut Lexer<'_>, at: Span) -> Result<(), SceneError> {
        let Some(Spanned { token: Token::Text(declaration), span }) = lexer.next()? else {
            return Err(SceneError::syntax("a name between quotes is wanted here", at));
        };
        let at = at.to(span);
        let value = single(lexer, at)?;
        // Some write a type before the name, as for parameters; capitals, dashes and underscores do not count.
        let name = declaration.split_whitespace().last().unwrap_or_default();
        let name: String =
            name.chars().filter(|c| !matches!(c, '-' | '_')).map(|c| c.to_ascii_lowercase()).collect();
        match name.as_str() {
            "forcediffuse" => self.flags.force_diffuse = boolean(&value, at)?,
            "disablepixeljitter" => self.flags.no_pixel_jitter = boolean(&value, at)?,
            "disabletexturefiltering" => self.flags.no_texture_filter = boolean(&value, at)?,
            "displacementedgescale" => {
                let scale = number(&value, at)?;
                if !(scale > 0.0 && scale.is_finite()) {
                    return Err(SceneError::invalid("this factor must be positive", at));
                }
                self.flags.edge_scale = scale;
            }
            name if WITHOUT_EFFECT.contains(&name) => {}
            name if IGNORED.contains(&name) => {
                // What is switched off already is no loss.
                if !(name != "seed" && value == "false") {
                    self.warn(format!("option `{name}` has no effect here"), at);
                }
            }
            _ => {
                let own = [
                    "disablepixeljitter",
                    "disabletexturefiltering",
                    "displacementedgescale",
                    "forcediffuse",
                ];
                let known = own.iter().chain(&WITHOUT_EFFECT).chain(&IGNORED);
                let known = known.map(|name| (*name).to_owned()).collect();
                return Err(SceneError::UnknownName { what: "option", name, known, at });
            }
        }
        Ok(())
    }
}

/// One value, with or without brackets or quotes.
fn single(lexer: &mut Lexer<'_>, at: Span) -> Result<String, SceneError> {
    let wanted = || SceneError::syntax("a value is wanted here", at);
    let mut token = lexer.next()?.ok_or_else(wanted)?.token;
    let has_brackets = matches!(token, Token::Open);
    if has_brackets {
        token = lexer.next()?.ok_or_else(wanted)?.token;
    }
    let value = match token {
        Token::Word(word) => word.to_owned(),
        Token::Text(text) => text,
        Token::Open | Token::Close => return Err(wanted()),
    };
    if has_brackets && !matches!(lexer.next()?, Some(Spanned { token: Token::Close, .. })) {
        return Err(wanted());
    }
    Ok(value)
}

fn boolean(value: &str, at: Span) -> Result<bool, SceneError> {
    match value {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(SceneError::syntax("`true` or `false` is wanted here", at)),
    }
}
