//! Files that models name, on the machine where they are now.

use std::path::{Path, PathBuf};

/// The longest name, in bytes, that is looked for; the most folders of a path of another machine, or words of a name; the most
/// libraries in a line. Files name far less, but for hostile ones.
const LONGEST: usize = 4096;
const DEEPEST: usize = 16;
const MOST: usize = 256;

/// The file that a library or picture is meant to be, in or below the folder of the file that names it.
///
/// Names come in quotes and in capitals that other systems do not tell apart, and are often whole paths of the machine where the
/// model was made. So first the name is taken as it stands, then as much of the end of its path as there is.
pub(super) fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let bare = unquoted(name);
    let parts = parts(bare);
    let last = parts.len().saturating_sub(DEEPEST).max(1);
    let ends_of_path = || (last..parts.len()).find_map(|start| descend(folder, &parts[start..]));
    let without_comment = || find(folder, bare.split_once(" #")?.0);
    find_whole(folder, name).or_else(ends_of_path).or_else(without_comment)
}

/// The file of a whole name, in quotes or not, in whatever capitals.
fn find_whole(folder: &Path, name: &str) -> Option<PathBuf> {
    if name.len() > LONGEST {
        return None;
    }
    let bare = unquoted(name);
    let mut literal = [name, bare].map(|name| folder.join(name)).into_iter();
    literal.find(|path| path.is_file()).or_else(|| descend(folder, &parts(bare)))
}

fn unquoted(name: &str) -> &str {
    name.trim().trim_matches(['"', '\'']).trim()
}

fn parts(path: &str) -> Vec<&str> {
    path.split(['/', '\\']).filter(|part| !matches!(*part, "" | ".")).collect()
}

/// Walks down a path whose names may be in other capitals.
fn descend(folder: &Path, parts: &[&str]) -> Option<PathBuf> {
    let (file, folders) = parts.split_last()?;
    let step = |at: PathBuf, name: &str, is_wanted: fn(&Path) -> bool| {
        let literal = at.join(name);
        if is_wanted(&literal) {
            Some(literal)
        } else {
            in_other_capitals(&at, name).filter(|path| is_wanted(path))
        }
    };
    let inner = folders.iter().try_fold(folder.to_owned(), |at, name| step(at, name, Path::is_dir))?;
    step(inner, file, Path::is_file)
}

/// The first in order of the names in a folder that differ from this one by their capitals alone.
fn in_other_capitals(folder: &Path, name: &str) -> Option<PathBuf> {
    // The working directory is spelled as nothing.
    let folder_or_here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let wanted = name.to_lowercase();
    let entries = std::fs::read_dir(folder_or_here).ok()?.flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|found| found.to_lowercase() == wanted).min().map(|found| folder.join(found))
}

/// The libraries that a line `mtllib` names: one with spaces in its name, if there is such a file, or several.
///
/// Where no file is found, a name goes on to its suffix.
pub(super) fn libraries(folder: &Path, line: &str) -> Vec<(String, Option<PathBuf>)> {
    let mut found = Vec::new();
    let mut rest = line.trim();
    while !rest.is_empty() && found.len() < MOST {
        let spaces = rest.char_indices().filter(|(_, c)| c.is_whitespace()).map(|(i, _)| i);
        let ends: Vec<usize> = spaces.chain([rest.len()]).take(DEEPEST).collect();
        let is_whole = |end: &usize| find_whole(folder, &rest[..*end]).is_some();
        let has_suffix = |end: &usize| unquoted(&rest[..*end]).to_ascii_lowercase().ends_with(".mtl");
        let end = ends.iter().rev().copied().find(is_whole).or_else(|| ends.iter().copied().find(has_suffix));
        let (name, after) = rest.split_at(end.unwrap_or(rest.len()));
        found.push((name.trim_end().to_owned(), find(folder, name)));
        rest = after.trim_start();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        folder
    }

    #[test]
    fn files_of_other_machines_are_found_by_the_end_of_their_path() {
        let folder = folder_with(&["wood.png", "Textures/Oak Bark.jpg", "maps/wood.png", "half\"inch.png"]);
        let at =
            |name: &str| find(folder.path(), name).map(|p| p.strip_prefix(folder.path()).unwrap().to_owned());
        for (name, file) in [
            ("wood.png", "wood.png"),
            ("\"wood.png\"", "wood.png"),
            ("WOOD.Png", "wood.png"),
            ("C:\\Models\\Chair\\wood.png", "wood.png"),
            ("/home/anna/chair/maps/wood.png", "maps/wood.png"),
            ("D:\\x\\TEXTURES\\oak bark.JPG", "Textures/Oak Bark.jpg"),
            (".\\textures\\oak bark.jpg", "Textures/Oak Bark.jpg"),
            ("half\"inch.png", "half\"inch.png"),
            ("wood.png # the seat", "wood.png"),
        ] {
            assert_eq!(at(name).as_deref(), Some(Path::new(file)), "{name}");
        }
        assert_eq!(at("maps"), None, "a folder is no file");
        assert_eq!(at("stone.png"), None);
        assert_eq!(at(""), None);
    }

    #[test]
    fn a_line_names_one_library_with_spaces_or_several() {
        let folder = folder_with(&["a.mtl", "b.mtl", "my colours.mtl", "no suffix"]);
        let names = |line: &str| {
            let found = libraries(folder.path(), line).into_iter();
            found.map(|(name, path)| (name, path.is_some())).collect::<Vec<_>>()
        };
        let all = |names: &[(&str, bool)]| {
            names.iter().map(|&(n, found)| (n.to_owned(), found)).collect::<Vec<_>>()
        };
        assert_eq!(names("a.mtl b.mtl"), all(&[("a.mtl", true), ("b.mtl", true)]));
        assert_eq!(names("my colours.mtl  a.mtl"), all(&[("my colours.mtl", true), ("a.mtl", true)]));
        assert_eq!(names("\"my colours.mtl\" B.MTL"), all(&[("\"my colours.mtl\"", true), ("B.MTL", true)]));
        assert_eq!(names("./a.mtl ./b.mtl"), all(&[("./a.mtl", true), ("./b.mtl", true)]));
        let of_windows = names("C:\\my models\\a.mtl D:\\b.mtl");
        assert_eq!(of_windows, all(&[("C:\\my models\\a.mtl", true), ("D:\\b.mtl", true)]));
        assert_eq!(names("no suffix"), all(&[("no suffix", true)]));
        assert_eq!(names("not there.mtl a.mtl"), all(&[("not there.mtl", false), ("a.mtl", true)]));
        assert_eq!(names(""), []);
    }
}
