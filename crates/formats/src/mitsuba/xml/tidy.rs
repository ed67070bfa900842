//! What Mitsuba's parser (pugixml) lets pass, as well-formed XML.
//!
//! Everything keeps its place, so that messages point into the file as it is: comments, processing instructions (the
//! declaration in the first line among them) and document types become blanks, and an ampersand that stands for itself becomes
//! a byte that no scene has. With the document type go its entities: nothing is ever expanded.

use std::borrow::Cow;
use std::ops::Range;

/// Stands for an ampersand that begins no reference: DEL, which XML allows and nobody types.
const AMPERSAND: char = '\u{7f}';

/// The text with all that stands in the way of a strict parser taken out.
pub(super) fn tidy(text: &str) -> Cow<'_, str> {
    let mut bytes = Cow::Borrowed(text.as_bytes());
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        let end = |mark: &str, from: usize| rest.get(from..)?.find(mark).map(|i| at + from + i + mark.len());
        let (skipped, is_blank) = if rest.starts_with("<!--") {
            (end("-->", 4), true)
        } else if rest.starts_with("<?") {
            (end("?>", 2), true)
        } else if rest.starts_with("<![CDATA[") {
            (end("]]>", 9), false)
        } else if rest.starts_with("<!") {
            (declaration_length(rest).map(|length| at + length), true)
        } else {
            tidy_character(rest, at, &mut bytes);
            at += rest.chars().next().map_or(1, char::len_utf8);
            continue;
        };
        // What has no end is left to the parser to complain about.
        let Some(next) = skipped else { break };
        if is_blank {
            blank(bytes.to_mut(), at..next);
        }
        at = next;
    }
    match bytes {
        Cow::Borrowed(_) => Cow::Borrowed(text),
        Cow::Owned(bytes) => Cow::Owned(String::from_utf8(bytes).expect("whole characters became ASCII")),
    }
}

/// An attribute's value as it was meant.
pub(super) fn restore(value: &str) -> Cow<'_, str> {
    if value.contains(AMPERSAND) { Cow::Owned(value.replace(AMPERSAND, "&")) } else { Cow::Borrowed(value) }
}

/// Replaces the first character of `rest` where XML does not allow it.
fn tidy_character(rest: &str, at: usize, bytes: &mut Cow<'_, [u8]>) {
    match rest.as_bytes()[0] {
        b'&' if !is_reference(rest) => bytes.to_mut()[at] = AMPERSAND as u8,
        0..=8 | 11 | 12 | 14..=31 => bytes.to_mut()[at] = b' ',
        0xef if rest.starts_with(['\u{feff}', '\u{fffe}', '\u{ffff}']) => blank(bytes.to_mut(), at..at + 3),
        _ => {}
    }
}

/// Whether a text that starts with an ampersand starts with one of the five entities of XML or a character's number.
fn is_reference(text: &str) -> bool {
    const LONGEST: usize = 10;
    let Some(end) = text.bytes().take(LONGEST).position(|b| b == b';') else { return false };
    let name = &text[1..end];
    let number = name.strip_prefix('#').map(|digits| match digits.strip_prefix('x') {
        Some(hex) => u32::from_str_radix(hex, 16),
        None => digits.parse(),
    });
    match number {
        Some(Ok(code)) => char::from_u32(code).is_some_and(|c| c >= ' ' || matches!(c, '\t' | '\n' | '\r')),
        Some(Err(_)) => false,
        None => matches!(name, "amp" | "lt" | "gt" | "quot" | "apos"),
    }
}

/// How long `<!DOCTYPE ...>` is, with what it has between brackets.
fn declaration_length(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    let mut quote = None;
    let mut at = 0;
    while let Some(&b) = text.as_bytes().get(at) {
        match (quote, b) {
            (Some(open), _) if b == open => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => quote = Some(b),
            (None, b'<') if text[at..].starts_with("<!--") => at += text[at..].find("-->")? + 2,
            (None, b'<' | b'[') => depth += 1,
            (None, b'>' | b']') => depth = depth.checked_sub(1)?,
            (None, _) => {}
        }
        at += 1;
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

/// Makes blanks of all but line ends.
fn blank(bytes: &mut [u8], range: Range<usize>) {
    bytes[range].iter_mut().filter(|b| !matches!(b, b'\n' | b'\r')).for_each(|b| *b = b' ');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_parser_lets_pass_becomes_blank() {
        for (text, expected) in [
            ("\n<?xml version='1.0'?>\n<a/>", "\n                     \n<a/>"),
            ("<a><!-- b -- c --><!----></a>", "<a>                      </a>"),
            (
                "<!DOCTYPE a [<!ENTITY b '>]'> <!-- ]> --> ] ><a/>",
                "                                             <a/>",
            ),
            ("<!-- größer\n --><a/>", "             \n    <a/>"),
            ("<a b='\u{1}'/>", "<a b=' '/>"),
            ("<a>&amp;&#65;&#x41;</a>", "<a>&amp;&#65;&#x41;</a>"),
            ("<a><![CDATA[<!-- & -->]]></a>", "<a><![CDATA[<!-- & -->]]></a>"),
            ("<a><!-- no end", "<a><!-- no end"),
        ] {
            assert_eq!(tidy(text), expected);
            assert_eq!(tidy(text).len(), text.len());
        }
    }

    #[test]
    fn bare_ampersands_are_restored() {
        let text = "a & b &amp; c &nbsp; &#0; &";
        let tidied = tidy(text);
        assert_eq!(tidied.matches('&').count(), 1);
        assert_eq!(restore(&tidied), text);
    }
}
