//! Words of a pbrt file.

use aureole_desc::{SceneError, SourceId, Span};

/// What a word is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'a> {
    /// A directive, a number, `true` or `false`.
    Word(&'a str),
    /// What stood between quotes, escapes resolved.
    Text(String),
    /// `[`
    Open,
    /// `]`
    Close,
}

/// A word and its place.
#[derive(Clone, Debug)]
pub(super) struct Spanned<'a> {
    pub token: Token<'a>,
    pub span: Span,
}

/// Splits a text into words.
pub(super) struct Lexer<'a> {
    text: &'a str,
    source: SourceId,
    at: usize,
    peeked: Option<Spanned<'a>>,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a str, source: SourceId) -> Self {
        // A byte order mark is no word.
        let at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        Self { text, source, at, peeked: None }
    }

    /// The next word without taking it.
    pub(super) fn peek(&mut self) -> Result<Option<&Spanned<'a>>, SceneError> {
        if self.peeked.is_none() {
            self.peeked = self.lex()?;
        }
        Ok(self.peeked.as_ref())
    }

    /// Takes the next word.
    pub(super) fn next(&mut self) -> Result<Option<Spanned<'a>>, SceneError> {
        match self.peeked.take() {
            Some(word) => Ok(Some(word)),
            None => self.lex(),
        }
    }

    /// Where the text ends.
    pub(super) fn end(&self) -> Span {
        Span::new(self.source, self.text.len(), self.text.len())
    }

    fn span(&self, start: usize) -> Span {
        Span::new(self.source, start, self.at)
    }

    fn skip_blanks(&mut self) {
        let bytes = self.text.as_bytes();
        while let Some(&b) = bytes.get(self.at) {
            if b.is_ascii_whitespace() {
                self.at += 1;
            } else if b == b'#' {
                self.at += bytes[self.at..].iter().position(|&b| b == b'\n').unwrap_or(bytes.len() - self.at);
            } else {
                break;
            }
        }
    }

    fn lex(&mut self) -> Result<Option<Spanned<'a>>, SceneError> {
        self.skip_blanks();
        let start = self.at;
        let bytes = self.text.as_bytes();
        let Some(&first) = bytes.get(start) else { return Ok(None) };
        let token = match first {
            b'[' | b']' => {
                self.at += 1;
                if first == b'[' { Token::Open } else { Token::Close }
            }
            b'"' => Token::Text(self.quoted(start)?),
            _ => {
                let is_end = |b: &u8| b.is_ascii_whitespace() || matches!(b, b'"' | b'[' | b']' | b'#');
                self.at += bytes[start..].iter().position(is_end).unwrap_or(bytes.len() - start);
                Token::Word(&self.text[start..self.at])
            }
        };
        Ok(Some(Spanned { token, span: self.span(start) }))
    }

    fn quoted(&mut self, start: usize) -> Result<String, SceneError> {
        let mut out = String::new();
        let mut characters = self.text[start + 1..].char_indices();
        while let Some((i, c)) = characters.next() {
            match c {
                '"' => {
                    self.at = start + 1 + i + 1;
                    return Ok(out);
                }
                '\n' => break,
                '\\' => match characters.next() {
                    Some((_, 'n')) => out.push('\n'),
                    Some((_, 't')) => out.push('\t'),
                    Some((_, 'r')) => out.push('\r'),
                    Some((_, 'b')) => out.push('\u{8}'),
                    Some((_, 'f')) => out.push('\u{c}'),
                    Some((_, other)) => out.push(other),
                    None => break,
                },
                c => out.push(c),
            }
        }
        Err(SceneError::syntax("this string has no closing quote", Span::new(self.source, start, start + 1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_desc::Sources;

    #[test]
    fn words_strings_and_comments() {
        let text = "Shape \"a\\\"b\" [1 -2.5e3]# end\ntrue";
        let source = Sources::default().add_text("x.pbrt", text);
        let mut lexer = Lexer::new(text, source);
        let mut tokens = Vec::new();
        while let Some(word) = lexer.next().unwrap() {
            tokens.push(word.token);
        }
        use Token::{Close, Open, Text, Word};
        assert_eq!(
            tokens,
            [Word("Shape"), Text("a\"b".into()), Open, Word("1"), Word("-2.5e3"), Close, Word("true")]
        );
    }

    #[test]
    fn an_open_string_is_an_error_at_its_quote() {
        let source = Sources::default().add_text("x.pbrt", "");
        let error = Lexer::new("  \"abc\n\"", source).next().unwrap_err();
        assert_eq!(error.span().start, 2);
    }
}
