//! What a film was rendered from, in a form that fits into a file's header.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::fs::File;
use std::io::Read;
use std::path::Path;

use aureole_desc::{Family, Mesh, Node, SceneDesc, Value};
use aureole_scene::Film;
use sha2::{Digest, Sha256};

use crate::RenderOptions;

/// Everything that decides about samples, named part by part, so that a difference can be named too.
///
/// Two renders of equal fingerprints draw the same samples. Small parts stand there as they are (`seed`, `size`), large ones
/// as hashes: each family of elements, and each file by its name and content, wherever it lies. Places in scene files, names
/// and unused settings of threads or tiles are no part of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fingerprint {
    parts: BTreeMap<String, String>,
}

impl Fingerprint {
    /// The fingerprint of a description as it is compiled with one of its cameras.
    pub fn new(desc: &SceneDesc, film: &Film, camera: usize, options: &RenderOptions) -> Self {
        let mut print = Self::default();
        let Film { full, crop, .. } = film;
        print.set("version", env!("CARGO_PKG_VERSION"));
        print.set("seed", options.seed);
        let corner = format!("{} x {} at {},{}", crop.width, crop.height, crop.x, crop.y);
        print.set("size", format!("{} x {}, of which {corner}", full.width, full.height));
        if let Some(name) = &options.integrator {
            print.set("integrator option", name);
        }

        let mut hashes: BTreeMap<&str, Hash> = BTreeMap::new();
        let mut files: BTreeMap<String, Vec<&Path>> = BTreeMap::new();
        let used_camera = desc.cameras.get(camera).copied();
        for (id, node) in desc.nodes() {
            let is_other_camera = node.family == Family::Camera && Some(id) != used_camera;
            if node.family == Family::Film || is_other_camera {
                continue;
            }
            let hash = hashes.entry(node.family.name()).or_default();
            hash.node(id.index(), node);
            for param in node.params.iter() {
                if let Value::Path(path) = &param.value {
                    let name = path.file_name().unwrap_or_default().to_string_lossy();
                    let same_name = files.entry(format!("file {name}")).or_default();
                    if !same_name.contains(&path.as_path()) {
                        same_name.push(path);
                    }
                }
            }
        }
        let roots = format!("{:?} {:?}", desc.shapes, desc.lights);
        let shapes = hashes.entry(Family::Shape.name()).or_default();
        shapes.text(&roots);
        for instance in &desc.instances {
            shapes.text(&format!("{:?} {:?}", instance.group, instance.world_from_object));
        }
        for (family, hash) in hashes {
            print.set(family, hash.finish());
        }
        for (name, paths) in files {
            let value = match paths[..] {
                [path] => file_hash(path),
                // Files of one name in several folders.
                _ => {
                    let mut hash = Hash::default();
                    paths.iter().for_each(|path| hash.text(&file_hash(path)));
                    hash.finish()
                }
            };
            print.set(&name, value);
        }
        print
    }

    fn set(&mut self, name: &str, value: impl fmt::Display) {
        self.parts.insert(name.to_owned(), value.to_string());
    }

    /// A part's value.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.parts.get(name).map(String::as_str)
    }

    /// In words, what differs; empty when nothing does.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let names =
            self.parts.keys().chain(other.parts.keys().filter(|name| !self.parts.contains_key(*name)));
        let differing = names.filter(|name| self.parts.get(*name) != other.parts.get(*name));
        let word = |value: Option<&String>| match value {
            None => "none".to_owned(),
            Some(value) if is_hash(value) => format!("#{}", &value[..8]),
            Some(value) => value.clone(),
        };
        differing
            .map(|name| {
                let [a, b] = [self, other].map(|print| word(print.parts.get(name)));
                format!("{name}: {a}, here {b}")
            })
            .collect()
    }

    /// As lines of text.
    pub fn to_text(&self) -> String {
        self.parts.iter().map(|(name, value)| format!("{}\t{}\n", escape(name), escape(value))).collect()
    }

    /// From lines of text; what is none is left out.
    pub fn from_text(text: &str) -> Self {
        let pairs = text.split('\n').filter_map(|line| line.split_once('\t'));
        Self { parts: pairs.map(|(name, value)| (unescape(name), unescape(value))).collect() }
    }
}

/// Names of files may hold anything, even what parts lines.
fn escape(text: &str) -> String {
    text.replace('\\', r"\\").replace('\n', r"\n").replace('\t', r"\t")
}

fn unescape(text: &str) -> String {
    let mut chars = text.chars();
    let next = || {
        Some(match chars.next()? {
            '\\' => match chars.next()? {
                'n' => '\n',
                't' => '\t',
                other => other,
            },
            plain => plain,
        })
    };
    std::iter::from_fn(next).collect()
}

/// Digits of a hash: 128 bits, so that no two scenes meet by chance.
const HASH_DIGITS: usize = 32;

/// Whether a part's value stands for something larger. A seed has fewer digits.
fn is_hash(value: &str) -> bool {
    value.len() == HASH_DIGITS && value.bytes().all(|digit| digit.is_ascii_hexdigit())
}

/// The first digits of SHA-256.
#[derive(Default)]
pub(crate) struct Hash(Sha256);

impl Hash {
    /// Takes in some bytes.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Takes in a text and its end.
    pub(crate) fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u64).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    /// Takes in numbers and how many they are.
    pub(crate) fn words<const N: usize>(&mut self, words: impl ExactSizeIterator<Item = [u8; N]>) {
        self.bytes(&(words.len() as u64).to_le_bytes());
        // One call for many numbers: the hash likes long pieces.
        let mut buffer = Vec::with_capacity(1 << 16);
        for word in words {
            buffer.extend_from_slice(&word);
            if buffer.len() + N > 1 << 16 {
                self.bytes(&buffer);
                buffer.clear();
            }
        }
        self.bytes(&buffer);
    }

    /// The digits.
    pub(crate) fn finish(self) -> String {
        let mut digits = String::with_capacity(2 * HASH_DIGITS);
        for byte in self.0.finalize().iter().take(HASH_DIGITS / 2) {
            // Writing into a string cannot fail.
            let _ = write!(digits, "{byte:02x}");
        }
        digits
    }

    fn node(&mut self, index: usize, node: &Node) {
        self.bytes(&(index as u64).to_le_bytes());
        self.text(&node.kind);
        self.bytes(&(node.params.len() as u64).to_le_bytes());
        for param in node.params.iter() {
            self.text(&param.name);
            match &param.value {
                // What is in the file matters, not where it lies.
                Value::Path(path) => self.text(&path.file_name().unwrap_or_default().to_string_lossy()),
                Value::Mesh(mesh) => self.mesh(mesh),
                Value::Floats(list) => self.words(list.iter().map(|x| x.to_le_bytes())),
                Value::Ints(list) => self.words(list.iter().map(|x| x.to_le_bytes())),
                // Numbers are written with all the digits that tell them from their neighbours.
                small => self.text(&format!("{small:?}")),
            }
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        // All fields by name: a new one must not be forgotten.
        let Mesh { positions, indices, normals, uvs, attributes, polygons } = mesh;
        for list in [positions, normals] {
            self.words(list.as_flattened().iter().map(|x| x.to_le_bytes()));
        }
        self.words(uvs.as_flattened().iter().map(|x| x.to_le_bytes()));
        self.words(indices.as_flattened().iter().map(|x| x.to_le_bytes()));
        self.words(polygons.iter().map(|x| x.to_le_bytes()));
        for attribute in attributes {
            self.text(&format!("{} {:?} {}", attribute.name, attribute.domain, attribute.channels));
            self.words(attribute.data.iter().map(|x| x.to_le_bytes()));
        }
    }
}

/// The hash of a file's content, or why there is none: a scene may do without the file.
fn file_hash(path: &Path) -> String {
    let hash = || -> std::io::Result<String> {
        if !std::fs::metadata(path)?.is_file() {
            return Ok("not a file".to_owned());
        }
        let (mut file, mut hash, mut buffer) = (File::open(path)?, Hash::default(), vec![0; 1 << 16]);
        loop {
            match file.read(&mut buffer)? {
                0 => return Ok(hash.finish()),
                n => hash.bytes(&buffer[..n]),
            }
        }
    };
    hash().unwrap_or_else(|error| error.kind().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print(changes: &[(&str, &str)], options: &RenderOptions) -> Fingerprint {
        let mut desc = SceneDesc::default();
        for (path, value) in [("integrator.max_depth", "4")].iter().chain(changes) {
            desc.set(path, value).unwrap();
        }
        Fingerprint::new(&desc, &Film::new(8, 8), 0, options)
    }

    #[test]
    fn differences_have_names() {
        let options = RenderOptions::default();
        let plain = print(&[], &options);
        assert_eq!(plain.differences(&print(&[], &RenderOptions { threads: 3, ..options.clone() })), [""; 0]);
        assert_eq!(plain.differences(&Fingerprint::from_text(&plain.to_text())), [""; 0]);
        let seed = print(&[], &RenderOptions { seed: 5, ..options.clone() });
        assert_eq!(plain.differences(&seed), ["seed: 0, here 5"]);
        let depth = plain.differences(&print(&[("integrator.max_depth", "5")], &options));
        assert!(depth.len() == 1 && depth[0].starts_with("integrator: #"), "{depth:?}");
        assert_eq!(plain.differences(&print(&[("filter.kind", "tent")], &options)).len(), 1);
    }

    #[test]
    fn parts_may_have_any_names() {
        let mut print = Fingerprint::default();
        for name in ["file a\tb.png", "file a\nb.png", "file a\r.png", "file \\n", "\\", ""] {
            print.set(name, name);
        }
        assert_eq!(Fingerprint::from_text(&print.to_text()), print);
    }

    #[test]
    fn files_of_one_name_are_all_looked_at() {
        let folder = tempfile::tempdir().unwrap();
        let mut desc = SceneDesc::default();
        for name in ["a", "b", "a"] {
            let path = folder.path().join(name).join("wood.png");
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, name).unwrap();
            let params = aureole_desc::Params::new().with("filename", Value::Path(path));
            desc.add(Node::new(Family::Texture, "bitmap", params, aureole_desc::Span::NONE));
        }
        let print = || Fingerprint::new(&desc, &Film::new(8, 8), 0, &RenderOptions::default());
        let before = print();
        assert_eq!(before.differences(&print()), [""; 0]);
        std::fs::write(folder.path().join("b/wood.png"), "other").unwrap();
        let differences = before.differences(&print());
        assert!(differences.len() == 1 && differences[0].starts_with("file wood.png: #"), "{differences:?}");
    }

    #[test]
    fn files_are_known_by_their_content() {
        let path = std::env::temp_dir().join(format!("aureole-fingerprint-{}", std::process::id()));
        std::fs::write(&path, b"abc").unwrap();
        // FIPS 180-2, appendix B.1.
        assert_eq!(file_hash(&path), "ba7816bf8f01cfea414140de5dae2223");
        std::fs::remove_file(&path).unwrap();
        assert_eq!(file_hash(&path), "entity not found");
    }
}
