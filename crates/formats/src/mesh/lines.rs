//! Lines of text, however they end, and what is to be said about them.

use rustc_hash::FxHashMap;

/// A file's text without the byte order mark that editors of Windows put before it.
pub(crate) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The lines of a text with their numbers, which count from one. A line ends with a newline, a carriage return, or both.
pub(crate) fn lines(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut rest = Some(text);
    let mut number = 0;
    std::iter::from_fn(move || {
        let text = rest?;
        number += 1;
        let end = text.iter().position(|&b| b == b'\n' || b == b'\r');
        rest = end.map(|end| {
            let width = if text[end..].starts_with(b"\r\n") { 2 } else { 1 };
            &text[end + width..]
        });
        Some((number, &text[..end.unwrap_or(text.len())]))
    })
}

/// How many lines end in a text.
pub(crate) fn line_ends(text: &[u8]) -> usize {
    lines(text).count() - 1
}

/// What readers say about a file that they can use but for some of it: each thing once, with the first line where it is and how
/// often it is met.
#[derive(Clone, Debug, Default)]
pub(crate) struct Notes {
    /// In the order in which they were met.
    messages: Vec<Note>,
    places: FxHashMap<String, usize>,
    /// Kinds of notes beyond the first few.
    further: usize,
}

#[derive(Clone, Debug)]
struct Note {
    message: String,
    line: Option<usize>,
    count: usize,
}

impl Notes {
    /// How many things are said of one file: what is no text has new ones in every line.
    const MOST: usize = 16;

    /// Notes something, in a sentence that makes sense after `line 7: `.
    pub(crate) fn add(&mut self, message: &str, line: Option<usize>) {
        if let Some(&i) = self.places.get(message) {
            self.messages[i].count += 1;
        } else if self.messages.len() < Self::MOST {
            self.places.insert(message.to_owned(), self.messages.len());
            self.messages.push(Note { message: message.to_owned(), line, count: 1 });
        } else {
            self.further += 1;
        }
    }

    /// The sentences.
    pub(crate) fn finish(self) -> Vec<String> {
        let sentence = |Note { message, line, count }: Note| {
            let place = line.map_or_else(String::new, |line| format!("line {line}: "));
            let more = if count > 1 { format!(" (and {} more)", count - 1) } else { String::new() };
            format!("{place}{message}{more}")
        };
        let further =
            (self.further > 0).then(|| format!("{} further lines are not understood", self.further));
        self.messages.into_iter().map(sentence).chain(further).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_end_counts_once() {
        let found: Vec<_> = lines(b"a\nb\r\nc\rd\r\r\n\ne").map(|(n, l)| (n, l.to_vec())).collect();
        let wanted = ["a", "b", "c", "d", "", "", "e"].iter().enumerate();
        assert_eq!(found, wanted.map(|(i, line)| (i + 1, line.as_bytes().to_vec())).collect::<Vec<_>>());
    }

    #[test]
    fn what_is_met_often_is_said_once() {
        let mut notes = Notes::default();
        for line in 1..1000 {
            notes.add("a hole", Some(line));
            notes.add(&format!("word {line}"), Some(line));
        }
        let said = notes.finish();
        assert_eq!(said.len(), Notes::MOST + 1);
        assert_eq!(said[0], "line 1: a hole (and 998 more)");
        assert_eq!(said[Notes::MOST], "984 further lines are not understood");
    }
}
