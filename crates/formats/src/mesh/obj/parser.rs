//! The lines of an OBJ file.

use aureole_desc::Limits;

use super::Split;
use super::corner::{self, Farthest};
use super::part::{Corner, MISSING, Part, PartBuilder, Pools, smoothed};
use super::vertex::{self, VertexColors};
use crate::mesh::MeshError;
use crate::mesh::error::check_count;
use crate::mesh::lines::{Notes, lines, without_mark};

/// A parsed OBJ file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjFile {
    /// The parts that have faces.
    pub parts: Vec<Part>,
    /// What follows each `mtllib`: a name, or several.
    pub libraries: Vec<String>,
    /// What is left out, in sentences that name their lines.
    pub notes: Vec<String>,
}

impl ObjFile {
    /// Parses a file's content.
    ///
    /// # Errors
    /// A malformed line, or an index to a vertex that is not there, with the line's number.
    pub fn parse(bytes: &[u8], split: Split, limits: &Limits) -> Result<Self, MeshError> {
        let mut parser = Parser { split, ..Parser::default() };
        let mut triangles = 0;
        // What came before on lines that the next continues.
        let mut begun: Vec<u8> = Vec::new();
        for (number, line) in lines(without_mark(bytes)) {
            if let Some(start) = continued(line) {
                begun.extend_from_slice(start);
                begun.push(b' ');
                continue;
            }
            let in_line = |message: String| MeshError::content(format!("line {number}: {message}"));
            triangles += if begun.is_empty() {
                parser.line(number, line).map_err(in_line)?
            } else {
                begun.extend_from_slice(line);
                parser.line(number, &std::mem::take(&mut begun)).map_err(in_line)?
            };
            check_count("triangles", triangles as u64, limits)?;
        }
        check_count("vertices", parser.pools.positions.len() as u64, limits)?;
        parser.finish()
    }

    /// The error of a file without faces, which says what there is instead.
    pub(crate) fn no_faces(&self) -> MeshError {
        MeshError::nothing_but("no faces", &self.notes)
    }
}

/// A line without the backslash that continues it on the next. At the end of a comment, one belongs to the name of a folder.
fn continued(line: &[u8]) -> Option<&[u8]> {
    line.strip_suffix(b"\\").filter(|line| !line.trim_ascii_start().starts_with(b"#"))
}

#[derive(Debug, Default)]
struct Parser {
    split: Split,
    pools: Pools,
    colors: VertexColors,
    done: Vec<PartBuilder>,
    current: PartBuilder,
    libraries: Vec<String>,
    face: Vec<Corner>,
    /// Of positions, texture coordinates and normals.
    farthest: [Farthest; 3],
    /// What a corner without a normal has in its place.
    smoothing: Option<u32>,
    notes: Notes,
}

impl Parser {
    /// Takes a line in; gives the number of triangles it adds.
    fn line(&mut self, number: usize, line: &[u8]) -> Result<usize, String> {
        let (keyword, rest) = split_word(line);
        match keyword {
            b"v" => self.vertex(rest)?,
            b"vt" => {
                let uv = vertex::texture_coordinates(rest);
                self.pools.uvs.push(or_note(uv, number, &mut self.notes));
            }
            b"vn" => {
                let normal = vertex::numbers(rest);
                self.pools.normals.push(or_note(normal, number, &mut self.notes));
            }
            b"f" | b"fo" => {
                let before = self.current.triangles();
                self.face(number, rest)?;
                return Ok(self.current.triangles() - before);
            }
            b"mtllib" => self.libraries.push(text(rest)),
            b"o" | b"g" | b"usemtl" | b"s" => {
                if self.split == Split::Parts {
                    self.state(keyword, rest);
                }
            }
            b"#MRGB" => self.colors.add_painted(rest),
            _ => self.left_out(number, keyword, rest),
        }
        Ok(0)
    }

    /// A position, and what some programs write behind it.
    fn vertex(&mut self, mut rest: &[u8]) -> Result<(), String> {
        self.pools.positions.push(vertex::take_numbers(&mut rest)?);
        self.colors.add(self.pools.positions.len() - 1, rest);
        Ok(())
    }

    /// The parts of a file and their smoothing.
    fn state(&mut self, keyword: &[u8], rest: &[u8]) {
        match keyword {
            b"s" => self.smoothing = Some(smoothed(corner::smoothing_group(rest))),
            b"usemtl" => {
                let name = self.current.name.clone();
                self.start_part(name, Some(text(rest)).filter(|material| !material.is_empty()));
            }
            _ => {
                let material = self.current.material.clone();
                self.start_part(text(rest), material);
            }
        }
    }

    fn start_part(&mut self, name: String, material: Option<String>) {
        if self.current.is_empty() {
            (self.current.name, self.current.material) = (name, material);
        } else {
            self.done.push(std::mem::replace(&mut self.current, PartBuilder::new(name, material)));
        }
    }

    fn face(&mut self, number: usize, mut rest: &[u8]) -> Result<(), String> {
        let counts = [self.pools.positions.len(), self.pools.uvs.len(), self.pools.normals.len()];
        self.face.clear();
        loop {
            rest = rest.trim_ascii_start();
            if rest.is_empty() || rest[0] == b'#' {
                break;
            }
            let (mut corner, after) = corner::read(rest, counts, number, &mut self.notes)?;
            for (index, farthest) in corner.iter().zip(&mut self.farthest) {
                farthest.see(*index, number);
            }
            if corner[2] == MISSING {
                corner[2] = self.smoothing.unwrap_or(MISSING);
            }
            self.face.push(corner);
            rest = after;
        }
        if self.face.len() < 3 {
            self.notes.add("a face of fewer than three corners is left out", Some(number));
        } else {
            self.current.add_face(&self.face);
        }
        Ok(())
    }

    /// What is no part of a mesh.
    fn left_out(&mut self, number: usize, keyword: &[u8], rest: &[u8]) {
        let is_comment = keyword.is_empty() || keyword[0] == b'#';
        let is_off = matches!(rest.trim_ascii(), b"off" | b"0");
        let word = String::from_utf8_lossy(&keyword[..keyword.len().min(24)]);
        let message = match keyword {
            _ if is_comment => return,
            // What stands around free-form curves and surfaces.
            b"cstype" | b"deg" | b"bmat" | b"step" | b"vp" | b"parm" | b"trim" | b"hole" | b"scrv"
            | b"sp" | b"end" | b"con" | b"res" | b"ctech" | b"stech" => return,
            b"curv" | b"curv2" | b"surf" | b"bzp" | b"bsp" | b"cdc" | b"cdp" => {
                format!("free-form geometry (`{word}`) is left out: only faces are read")
            }
            b"p" => "points (`p`) are left out".to_owned(),
            b"l" => "lines (`l`) are left out".to_owned(),
            b"lod" | b"bevel" | b"c_interp" | b"d_interp" | b"shadow_obj" | b"trace_obj" | b"mg"
            | b"maplib" | b"usemap"
                if is_off =>
            {
                return;
            }
            _ => format!("`{word}` is left out: only faces, their materials and groups are read"),
        };
        self.notes.add(&message, Some(number));
    }

    fn finish(mut self) -> Result<ObjFile, MeshError> {
        let counts = [self.pools.positions.len(), self.pools.uvs.len(), self.pools.normals.len()];
        let [positions, others @ ..] = &self.farthest;
        positions.check("vertices", counts[0]).map_err(MeshError::content)?;
        for ((farthest, what), count) in
            others.iter().zip(["texture coordinates", "normals"]).zip(&counts[1..])
        {
            if let Err(message) = farthest.check(what, *count) {
                self.notes.add(&format!("{message}: corners like this have none"), None);
            }
        }
        self.pools.colors = self.colors.finish(counts[0], &mut self.notes);
        self.done.push(self.current);
        let pools = &self.pools;
        let parts =
            self.done.into_iter().filter(|part| !part.is_empty()).map(|part| part.finish(pools)).collect();
        Ok(ObjFile { parts, libraries: self.libraries, notes: self.notes.finish() })
    }
}

/// Numbers, or zeros with a note.
fn or_note<const N: usize>(numbers: Result<[f32; N], String>, line: usize, notes: &mut Notes) -> [f32; N] {
    numbers.unwrap_or_else(|message| {
        notes.add(&format!("{message}: zeros are taken"), Some(line));
        [0.0; N]
    })
}

/// The first word of a line and what follows it.
fn split_word(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii_start();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    line.split_at(end)
}

fn text(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest.trim_ascii()).into_owned()
}
