//! Files that are not what their names say.

/// What a file is instead of a picture, mesh or scene, where its first bytes give it away: a sentence for a message.
///
/// Git leaves a short text in the place of a large file (Git LFS specification, version 1); editors and shells of Windows write
/// UTF-16, which no format here is; servers answer with a page where a file is not there.
///
/// ```
/// let text = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n";
/// assert!(aureole_image::stray(text).is_some_and(|what| what.contains("Git LFS pointer")));
/// ```
pub fn stray(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"version https://git-lfs.github.com/spec/") {
        Some("it is a Git LFS pointer, not the file itself, which `git lfs pull` fetches")
    } else if is_utf16(bytes) {
        Some("it is UTF-16 text: it must be saved as UTF-8")
    } else if is_web_page(bytes) {
        Some("it is a web page, not the file itself")
    } else {
        None
    }
}

/// A byte order mark (The Unicode Standard, section 23.8), or letters with a zero before or behind each.
fn is_utf16(bytes: &[u8]) -> bool {
    let is_text = |b: u8| b.is_ascii_graphic() || b.is_ascii_whitespace();
    let zero_at = |place: usize| {
        bytes.len() >= 8
            && bytes[..8].chunks_exact(2).all(|pair| pair[place] == 0 && is_text(pair[1 - place]))
    };
    bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) || zero_at(0) || zero_at(1)
}

fn is_web_page(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let starts = |with: &[u8]| text.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
    starts(b"<!doctype html") || starts(b"<html")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strays_are_named_and_files_are_not() {
        let utf16 = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        let named = |bytes: &[u8], what: &str| stray(bytes).is_some_and(|sentence| sentence.contains(what));
        assert!(named(b"version https://git-lfs.github.com/spec/v1\noid", "Git LFS"));
        assert!(named(&utf16("\u{feff}v 0 0 0\n"), "UTF-16"));
        assert!(named(&utf16("v 0 0 0\n"), "UTF-16"), "without a mark");
        assert!(named(b"\xfe\xff\0v", "UTF-16") && named(b"\0v\0 \x000\0 ", "UTF-16"));
        assert!(named(b"\n<!DOCTYPE HTML><title>404", "web page"));
        // A table of MERL starts with the number 90, a scene may have a document type.
        for file in
            [&b"v 0 0 0\n"[..], b"", b"Z\0\0\0Z\0\0\0\xb4\0\0\0", b"<!DOCTYPE scene><scene/>", b"\x89PNG"]
        {
            assert_eq!(stray(file), None);
        }
    }
}
