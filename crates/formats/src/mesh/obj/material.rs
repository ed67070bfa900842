//! Material libraries (`.mtl`).

use std::ops::Range;

use rustc_hash::FxHashSet;

use super::texture_map::{Read, TextureMap};
use crate::mesh::lines::{lines, without_mark};

/// A material as the library gives it; `None` where it says nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjMaterial {
    /// `newmtl`.
    pub name: String,
    /// `Kd`: diffuse colour.
    pub diffuse: Option<[f32; 3]>,
    /// `Ks`: specular colour.
    pub specular: Option<[f32; 3]>,
    /// `Ke`: emitted radiance.
    pub emission: Option<[f32; 3]>,
    /// `Tf`: transmission filter.
    pub transmission: Option<[f32; 3]>,
    /// `Ns`: Phong exponent.
    pub exponent: Option<f32>,
    /// `Ni`: index of refraction.
    pub ior: Option<f32>,
    /// `d`, else one minus `Tr`: opacity.
    pub opacity: Option<f32>,
    /// `illum`: illumination model, 0 to 10.
    pub model: Option<u32>,
    /// `Pr`: roughness, of the extension for physically based materials.
    pub roughness: Option<f32>,
    /// `Pm`: metalness, of the same.
    pub metallic: Option<f32>,
    /// `map_Kd`.
    pub diffuse_map: Option<TextureMap>,
    /// `map_Ks`.
    pub specular_map: Option<TextureMap>,
    /// `map_Ke`.
    pub emission_map: Option<TextureMap>,
    /// `map_d`, or `map_Tr`, which is turned round.
    pub opacity_map: Option<TextureMap>,
    /// `map_bump` or `bump`.
    pub bump_map: Option<TextureMap>,
    /// `norm` or `map_Kn`.
    pub normal_map: Option<TextureMap>,
}

/// What a library holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Materials {
    /// In the order of the file.
    pub list: Vec<ObjMaterial>,
    /// What is left out, or not taken by the letter.
    pub notes: Vec<MaterialNote>,
}

/// Something to say about a library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaterialNote {
    /// What it is.
    pub message: String,
    /// The bytes of the line.
    pub place: Range<usize>,
}

/// Parses a library. What makes no sense is left out with a note: exporters write many kinds of lines.
pub fn parse_materials(text: &str) -> Materials {
    let mut parser = Parser::default();
    for (_, line) in lines(without_mark(text.as_bytes())) {
        let line = line.trim_ascii();
        let start = line.as_ptr() as usize - text.as_ptr() as usize;
        // Lines end at ASCII letters, so that each is whole text.
        parser.line(&text[start..start + line.len()], start..start + line.len());
    }
    parser.finish_material();
    parser.found
}

/// A number, and where it is written.
type Placed = Option<(f32, Range<usize>)>;

#[derive(Debug, Default)]
struct Parser {
    found: Materials,
    said: FxHashSet<String>,
    /// The material at work; what comes before the first `newmtl` belongs to none.
    material: Option<ObjMaterial>,
    opacity: Placed,
    transparency: Placed,
}

impl Parser {
    /// How many things are said of one library.
    const MOST_NOTES: usize = 64;

    fn note(&mut self, message: String, place: Range<usize>) {
        if self.said.len() < Self::MOST_NOTES && self.said.insert(message.clone()) {
            self.found.notes.push(MaterialNote { message, place });
        }
    }

    fn line(&mut self, line: &str, place: Range<usize>) {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if keyword.eq_ignore_ascii_case("newmtl") {
            self.finish_material();
            self.material = Some(ObjMaterial { name: rest.to_owned(), ..ObjMaterial::default() });
        } else if !keyword.is_empty() && !keyword.starts_with('#') {
            self.set(keyword, rest, place);
        }
    }

    fn set(&mut self, keyword: &str, rest: &str, place: Range<usize>) {
        let Some(material) = &mut self.material else { return };
        let placed = |number: Option<f32>| number.map(|number| (number, place.clone()));
        let is_read = match keyword.to_ascii_lowercase().as_str() {
            "kd" => put(&mut material.diffuse, color(rest)),
            "ks" => put(&mut material.specular, color(rest)),
            "ke" => put(&mut material.emission, color(rest)),
            "tf" => put(&mut material.transmission, color(rest)),
            "ns" => put(&mut material.exponent, number(rest)),
            "ni" => put(&mut material.ior, number(rest)),
            "pr" => put(&mut material.roughness, number(rest)),
            "pm" => put(&mut material.metallic, number(rest)),
            "illum" => put(&mut material.model, number(rest).map(|model| model as u32)),
            "d" => put(&mut self.opacity, placed(number(rest.strip_prefix("-halo").unwrap_or(rest)))),
            "tr" => put(&mut self.transparency, placed(number(rest))),
            // Ambient light, and hints for other programs, say nothing about how light is reflected.
            "ka" | "map_ka" | "sharpness" | "map_aat" => true,
            // Properties that are not there.
            "ps" | "pc" | "pcr" | "aniso" | "anisor" if number(rest) == Some(0.0) => true,
            word => return self.set_map(keyword, word, rest, place),
        };
        if !is_read {
            self.note(format!("`{keyword} {rest}` is left out: it is not understood"), place);
        }
    }

    fn set_map(&mut self, keyword: &str, word: &str, rest: &str, place: Range<usize>) {
        let Some(material) = &mut self.material else { return };
        let map = match word {
            "map_kd" => &mut material.diffuse_map,
            "map_ks" => &mut material.specular_map,
            "map_ke" => &mut material.emission_map,
            "map_d" | "map_tr" => &mut material.opacity_map,
            "map_bump" | "bump" => &mut material.bump_map,
            "norm" | "map_kn" => &mut material.normal_map,
            _ => return self.note(format!("`{keyword}` is not heeded"), place),
        };
        let Read { map: found, unheeded } = TextureMap::parse(rest);
        let is_read = found.is_some();
        *map = found.map(|found| TextureMap { invert: word == "map_tr", ..found });
        if !is_read {
            self.note(format!("`{keyword}` names no picture"), place.clone());
        }
        for option in unheeded {
            self.note(format!("`{option}` of `{keyword}` is not heeded"), place.clone());
        }
    }

    /// Decides on the opacity of the material at work and puts it to the others.
    fn finish_material(&mut self) {
        let (opacity, transparency) = (self.opacity.take(), self.transparency.take());
        let Some(mut material) = self.material.take() else { return };
        let lets_through = matches!(material.model, Some(4 | 6 | 7 | 9));
        material.opacity = match (opacity, transparency) {
            (Some((d, place)), _) => {
                if d <= 0.0 && !lets_through && material.opacity_map.is_none() {
                    self.note(format!("nothing is seen of `{}`: its opacity is {d}", material.name), place);
                }
                Some(d)
            }
            // Many programs write `Tr 1` for what is opaque, and nobody means what cannot be seen.
            (None, Some((tr, place))) if tr >= 1.0 && !lets_through => {
                let name = &material.name;
                self.note(
                    format!("`{name}` is taken as opaque: with `Tr {tr}` nothing of it would be seen"),
                    place,
                );
                None
            }
            (None, transparency) => transparency.map(|(tr, _)| 1.0 - tr),
        };
        self.found.list.push(material);
    }
}

/// Sets what was read, and says whether there was anything.
fn put<T>(place: &mut Option<T>, found: Option<T>) -> bool {
    let is_some = found.is_some();
    if is_some {
        *place = found;
    }
    is_some
}

fn number(rest: &str) -> Option<f32> {
    rest.split_whitespace().next()?.parse().ok().filter(|x: &f32| x.is_finite())
}

/// Three numbers, or one that stands for three. Other colour spaces (`xyz`, `spectral`) are rare and not read.
fn color(rest: &str) -> Option<[f32; 3]> {
    let mut numbers =
        rest.split_whitespace().map_while(|word| word.parse().ok().filter(|x: &f32| x.is_finite()));
    let r = numbers.next()?;
    Some([r, numbers.next().unwrap_or(r), numbers.next().unwrap_or(r)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_read() {
        let text = "\u{feff}# a library\r\nKd 9 9 9\rnewmtl red paint\nKd 0.8 0.1 0.1\n  Ns 250.5\r\nNi 1.45\nTr 0.25\n\
                    illum 2 # glossy\nmap_Kd -s 2 3 1 -o 0.5 -clamp on my textures/red.png\nmap_Bump -bm 0.3 bump.png\n\
                    newmtl lamp\nKe 5\nKd nonsense\nmap_d\nPs 0\nPc 0.5\nmap_Tr -mm 0 2 glow.png\n";
        let Materials { list, notes } = parse_materials(text);
        let [paint, lamp] = &list[..] else { panic!() };
        assert_eq!(paint.name, "red paint");
        assert_eq!(paint.diffuse, Some([0.8, 0.1, 0.1]));
        assert_eq!((paint.exponent, paint.ior, paint.opacity), (Some(250.5), Some(1.45), Some(0.75)));
        assert_eq!(paint.model, Some(2));
        let map = paint.diffuse_map.as_ref().unwrap();
        assert_eq!(map.file, "my textures/red.png");
        assert_eq!((map.scale, map.offset, map.clamp), ([2.0, 3.0], [0.5, 0.0], true));
        assert_eq!(paint.bump_map.as_ref().unwrap().bump_scale, 0.3);
        assert_eq!((lamp.emission, lamp.diffuse), (Some([5.0; 3]), None));
        assert!(lamp.opacity_map.as_ref().unwrap().invert);

        let said: Vec<_> =
            notes.iter().map(|note| (note.message.as_str(), &text[note.place.clone()])).collect();
        let wanted = [
            ("`Kd nonsense` is left out: it is not understood", "Kd nonsense"),
            ("`map_d` names no picture", "map_d"),
            ("`Pc` is not heeded", "Pc 0.5"),
            ("`-mm` of `map_Tr` is not heeded", "map_Tr -mm 0 2 glow.png"),
        ];
        assert_eq!(said, wanted);
    }

    #[test]
    fn what_would_not_be_seen_is_opaque_unless_it_is_glass() {
        let opacity = |lines: &str| {
            let Materials { list, notes } = parse_materials(&format!("newmtl a\n{lines}\nKd 1 1 1"));
            (list[0].opacity, notes.len())
        };
        assert_eq!(opacity("Tr 1.0\nillum 2"), (None, 1));
        assert_eq!(opacity("Tr 1\nd 1"), (Some(1.0), 0), "`d` says what is meant");
        assert_eq!(opacity("d 0.5\nTr 0.5"), (Some(0.5), 0));
        assert_eq!(opacity("Tr 0.9"), (Some(1.0 - 0.9), 0));
        assert_eq!(opacity("Tr 1\nillum 7\nNi 1.5"), (Some(0.0), 0));
        assert_eq!(opacity("d 0"), (Some(0.0), 1), "meant, perhaps, and said");
    }
}
