//! The maps of a material library.

/// A texture of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureMap {
    /// The file, as named in the library.
    pub file: String,
    /// Factors of u and v (`-s`).
    pub scale: [f32; 2],
    /// Added to u and v (`-o`).
    pub offset: [f32; 2],
    /// Factor of a bump map (`-bm`).
    pub bump_scale: f32,
    /// Whether the texture ends at its border (`-clamp on`).
    pub clamp: bool,
    /// Whether it is the picture's alpha that counts (`-imfchan m`).
    pub alpha: bool,
    /// Whether 1 stands for 0.
    pub invert: bool,
}

/// What is read from the line of a map.
#[derive(Debug)]
pub(super) struct Read {
    pub(super) map: Option<TextureMap>,
    /// Options that ask for something and do not get it.
    pub(super) unheeded: Vec<String>,
}

impl TextureMap {
    /// The whole of a file.
    pub(crate) fn of(file: String) -> Self {
        Self {
            file,
            scale: [1.0; 2],
            offset: [0.0; 2],
            bump_scale: 1.0,
            clamp: false,
            alpha: false,
            invert: false,
        }
    }

    /// Options first, then the file name, which may have spaces in it.
    pub(super) fn parse(line: &str) -> Read {
        let mut map = Self::of(String::new());
        let mut unheeded = Vec::new();
        let mut rest = line;
        while let Some((option, after)) =
            rest.strip_prefix('-').and_then(|option| option.split_once(char::is_whitespace))
        {
            let (values, after) = arguments(option, after.trim_start());
            if !map.set(option, values) {
                unheeded.push(format!("-{option}"));
            }
            rest = after;
        }
        map.file = rest.trim().to_owned();
        Read { map: (!map.file.is_empty()).then_some(map), unheeded }
    }

    /// Takes an option in; false where it asks for what is not done.
    fn set(&mut self, option: &str, values: &str) -> bool {
        let number = |i: usize| values.split_whitespace().nth(i).and_then(|word| word.parse::<f32>().ok());
        let pair = |default: f32| [0, 1].map(|i| number(i).unwrap_or(default));
        match option.to_ascii_lowercase().as_str() {
            "s" => self.scale = pair(1.0),
            "o" => self.offset = pair(0.0),
            "bm" => self.bump_scale = number(0).unwrap_or(1.0),
            "clamp" => self.clamp = values == "on",
            "imfchan" => {
                self.alpha = values == "m";
                return matches!(values, "m" | "l");
            }
            // What is done anyway.
            "t" => return (0..3).all(|i| number(i).unwrap_or(0.0) == 0.0),
            "mm" => return pair(0.0) == [0.0, 1.0],
            "blendu" | "blendv" => return values == "on",
            "cc" => return values == "off",
            "texres" => {}
            _ => return false,
        }
        true
    }
}

/// Parts the arguments of an option from what follows them.
fn arguments<'a>(option: &str, text: &'a str) -> (&'a str, &'a str) {
    let (most, are_numbers) = match option.to_ascii_lowercase().as_str() {
        "s" | "o" | "t" => (3, true),
        "mm" => (2, true),
        "bm" | "boost" | "texres" => (1, true),
        // A switch such as `-clamp on`, a channel such as `-imfchan r`, a form such as `-type sphere`.
        _ => (1, false),
    };
    let mut end = 0;
    for _ in 0..most {
        let word = text[end..].split_whitespace().next().unwrap_or_default();
        if word.is_empty() || (are_numbers && word.parse::<f32>().is_err()) {
            break;
        }
        end = word.as_ptr() as usize - text.as_ptr() as usize + word.len();
    }
    (&text[..end], text[end..].trim_start())
}
