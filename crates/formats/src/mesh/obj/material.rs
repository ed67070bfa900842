//! Material libraries (`.mtl`).

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
}

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
    /// `d`, or one minus `Tr`: opacity.
    pub opacity: Option<f32>,
    /// `illum`: illumination model, 0 to 10.
    pub model: Option<u32>,
    /// `Pr`: roughness, of the extension for physically based materials.
    pub roughness: Option<f32>,
    /// `Pm`: metalness, of the same.
    pub metallic: Option<f32>,
    /// `map_Kd`.
    pub diffuse_map: Option<TextureMap>,
    /// `map_Ke`.
    pub emission_map: Option<TextureMap>,
    /// `map_d`.
    pub opacity_map: Option<TextureMap>,
    /// `map_bump` or `bump`.
    pub bump_map: Option<TextureMap>,
    /// `norm` or `map_Kn`.
    pub normal_map: Option<TextureMap>,
}

/// Parses a library. Lines that make no sense are skipped: exporters write many kinds of them.
pub fn parse_materials(text: &str) -> Vec<ObjMaterial> {
    let mut materials: Vec<ObjMaterial> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if keyword == "newmtl" {
            materials.push(ObjMaterial { name: rest.trim().to_owned(), ..ObjMaterial::default() });
        } else if let Some(material) = materials.last_mut() {
            material.set(&keyword.to_ascii_lowercase(), rest.trim());
        }
    }
    materials
}

impl ObjMaterial {
    fn set(&mut self, keyword: &str, rest: &str) {
        match keyword {
            "kd" => self.diffuse = color(rest),
            "ks" => self.specular = color(rest),
            "ke" => self.emission = color(rest),
            "tf" => self.transmission = color(rest),
            "ns" => self.exponent = number(rest),
            "ni" => self.ior = number(rest),
            "d" => self.opacity = number(rest.strip_prefix("-halo").unwrap_or(rest)),
            "tr" => self.opacity = number(rest).map(|tr| 1.0 - tr),
            "illum" => self.model = rest.parse().ok(),
            "pr" => self.roughness = number(rest),
            "pm" => self.metallic = number(rest),
            "map_kd" => self.diffuse_map = map(rest),
            "map_ke" => self.emission_map = map(rest),
            "map_d" => self.opacity_map = map(rest),
            "map_bump" | "bump" => self.bump_map = map(rest),
            "norm" | "map_kn" => self.normal_map = map(rest),
            _ => {}
        }
    }
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

/// Options first, then the file name, which may have spaces in it.
fn map(rest: &str) -> Option<TextureMap> {
    let mut map =
        TextureMap { file: String::new(), scale: [1.0; 2], offset: [0.0; 2], bump_scale: 1.0, clamp: false };
    let mut rest = rest;
    while let Some((option, after)) = rest.strip_prefix('-').and_then(|r| r.split_once(char::is_whitespace)) {
        rest = after.trim_start();
        let wanted = match option {
            "s" | "o" | "t" => 3,
            "mm" => 2,
            "bm" | "boost" | "texres" => 1,
            _ => 0,
        };
        let mut values = Vec::new();
        while values.len() < wanted {
            let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            let Ok(value) = word.parse::<f32>() else { break };
            values.push(value);
            rest = after.trim_start();
        }
        let pair = |default: f32| [values.first(), values.get(1)].map(|x| x.copied().unwrap_or(default));
        match option {
            "s" => map.scale = pair(1.0),
            "o" => map.offset = pair(0.0),
            "bm" => map.bump_scale = pair(1.0)[0],
            _ if wanted == 0 => {
                // A switch such as `-clamp on` or a channel such as `-imfchan r`.
                let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                map.clamp |= option == "clamp" && word == "on";
                rest = after.trim_start();
            }
            _ => {}
        }
    }
    map.file = rest.trim().to_owned();
    (!map.file.is_empty()).then_some(map)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_read() {
        let text = "# a library\nKd 9 9 9\nnewmtl red paint\nKd 0.8 0.1 0.1\n  Ns 250.5\r\nNi 1.45\nTr 0.25\nillum 2\n\
                    map_Kd -s 2 3 1 -o 0.5 -clamp on my textures/red.png\nmap_Bump -bm 0.3 bump.png\n\
                    newmtl lamp\nKe 5\nKd nonsense\nmap_d\n";
        let [paint, lamp] = &parse_materials(text)[..] else { panic!() };
        assert_eq!(paint.name, "red paint");
        assert_eq!(paint.diffuse, Some([0.8, 0.1, 0.1]));
        assert_eq!((paint.exponent, paint.ior, paint.opacity), (Some(250.5), Some(1.45), Some(0.75)));
        let map = paint.diffuse_map.as_ref().unwrap();
        assert_eq!(map.file, "my textures/red.png");
        assert_eq!((map.scale, map.offset, map.clamp), ([2.0, 3.0], [0.5, 0.0], true));
        assert_eq!(paint.bump_map.as_ref().unwrap().bump_scale, 0.3);
        assert_eq!((lamp.emission, lamp.diffuse, &lamp.opacity_map), (Some([5.0; 3]), None, &None));
    }
}
