//! Reading files within limits, packed or not, and finding them.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use aureole_desc::{Limits, SceneError, SourceId, Sources, Span};
use aureole_image::stray;
use flate2::read::MultiGzDecoder;

/// The two bytes that every gzip file starts with (RFC 1952, section 2.3.1).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Reads a whole file, unpacking gzip whatever its name is.
///
/// What a scene asks for must be a regular file: a pipe into which nobody writes would hold the render up for ever. What a
/// person names (`at` is nowhere) may be anything that can be read.
///
/// # Errors
/// [`SceneError::Read`], [`SceneError::Limit`] when it is, or unpacks to, more than the limits allow, or [`SceneError::Asset`]
/// when it is a [`stray`].
pub fn read_bytes(path: &Path, limits: &Limits, at: Span) -> Result<Vec<u8>, SceneError> {
    let failed = |source| SceneError::Read { path: path.to_owned(), source, at };
    let kind = std::fs::metadata(path).map_err(failed)?;
    if kind.is_dir() || (!at.is_none() && !kind.is_file()) {
        return Err(failed(io::Error::other("it is not a file")));
    }
    let mut file = File::open(path).map_err(failed)?;
    check_size(path, kind.len(), limits.max_file_bytes, "max-file-bytes", at)?;

    // A pipe or device has no size, so what it yields is counted as it comes.
    let mut bytes = Vec::with_capacity(kind.len() as usize);
    read_capped(&mut file, &mut bytes, limits.max_file_bytes).map_err(failed)?;
    check_size(path, bytes.len() as u64, limits.max_file_bytes, "max-file-bytes", at)?;
    tracing::debug!(path = %path.display(), bytes = bytes.len(), "file read");
    let bytes = unpack(path, bytes, limits, at)?;
    match stray(&bytes) {
        Some(what) => Err(SceneError::Asset { path: path.to_owned(), message: what.to_owned(), at }),
        None => Ok(bytes),
    }
}

/// Unpacks gzip; anything else stays as it is.
///
/// # Errors
/// [`SceneError::Read`] or [`SceneError::Limit`].
pub fn unpack(path: &Path, bytes: Vec<u8>, limits: &Limits, at: Span) -> Result<Vec<u8>, SceneError> {
    if !bytes.starts_with(&GZIP_MAGIC) {
        return Ok(bytes);
    }
    let most = limits.max_unpacked(bytes.len());
    let mut unpacked = Vec::new();
    read_capped(&mut MultiGzDecoder::new(&*bytes), &mut unpacked, most)
        .map_err(|source| SceneError::Read { path: path.to_owned(), source, at })?;
    let name = if most == limits.max_file_bytes { "max-file-bytes" } else { "max-unpack-ratio" };
    check_size(path, unpacked.len() as u64, most, name, at)?;
    Ok(unpacked)
}

/// Reads a text file and notes it in `sources`, so that spans can point into it. A file that is read again is not read twice.
///
/// Bytes that are not UTF-8 become replacement characters: old scenes have Latin-1 in their comments.
///
/// # Errors
/// As [`read_bytes`].
pub fn read_text(
    path: &Path,
    limits: &Limits,
    sources: &mut Sources,
    at: Span,
) -> Result<(SourceId, Arc<str>), SceneError> {
    if let Some(known) = sources.again(path) {
        sources.check(limits, at)?;
        return Ok(known);
    }
    let bytes = read_bytes(path, limits, at)?;
    let text: Arc<str> = match String::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into(),
    };
    let source = sources.add_text(path, text.clone());
    sources.check(limits, at)?;
    Ok((source, text))
}

/// The first bytes of a file (unpacked), enough to tell its format.
pub(crate) fn read_start(path: &Path, limits: &Limits, at: Span) -> Result<Vec<u8>, SceneError> {
    const ENOUGH: u64 = 4096;
    let failed = |source| SceneError::Read { path: path.to_owned(), source, at };
    let few = ENOUGH.min(limits.max_file_bytes);
    let mut start = Vec::new();
    read_capped(&mut File::open(path).map_err(failed)?, &mut start, few).map_err(failed)?;
    if start.starts_with(&GZIP_MAGIC) {
        let packed = std::mem::take(&mut start);
        // The packed bytes end early here: what came out before is enough.
        let _ = read_capped(&mut MultiGzDecoder::new(&*packed), &mut start, few);
    }
    Ok(start)
}

/// Reads to the end, or to one byte past the limit.
fn read_capped(from: &mut impl Read, to: &mut Vec<u8>, most: u64) -> io::Result<usize> {
    from.take(most.saturating_add(1)).read_to_end(to)
}

fn check_size(path: &Path, found: u64, limit: u64, name: &'static str, at: Span) -> Result<(), SceneError> {
    if found <= limit {
        return Ok(());
    }
    let what = format!("size in bytes of `{}`", path.display());
    Err(SceneError::Limit { what, found, limit, name: Some(name), at })
}

/// The folders in which a scene's relative file names are looked up, in order; after them comes the working directory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SearchPath {
    folders: Vec<PathBuf>,
}

impl SearchPath {
    /// Looks in the folder of `file` only.
    pub fn beside(file: &Path) -> Self {
        Self { folders: vec![file.parent().unwrap_or(Path::new("")).to_owned()] }
    }

    /// How many folders there are.
    pub fn len(&self) -> usize {
        self.folders.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.folders.is_empty()
    }

    /// Adds a folder before all others.
    pub fn push_front(&mut self, folder: PathBuf) {
        self.folders.retain(|known| *known != folder);
        self.folders.insert(0, folder);
    }

    /// Adds a folder after all others.
    pub fn push_back(&mut self, folder: PathBuf) {
        if !self.folders.contains(&folder) {
            self.folders.push(folder);
        }
    }

    /// The first existing file of that name; when there is none, where it was expected first.
    ///
    /// Backslashes, which scenes written on Windows have, count as slashes where no file of the literal name exists.
    pub fn resolve(&self, name: &str) -> PathBuf {
        let slashed = name.replace('\\', "/");
        let in_folders = |n| self.folders.iter().map(move |folder| folder.join(n)).chain([PathBuf::from(n)]);
        let candidates = || [name, &slashed].into_iter().flat_map(in_folders);
        candidates().find(|path| path.exists()).or_else(|| candidates().next()).unwrap_or_else(|| name.into())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn packed_files_unpack_and_bombs_do_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("zeros.gz");
        std::fs::write(&path, gzip(&vec![0; 1 << 20])).unwrap();
        assert_eq!(read_bytes(&path, &Limits::default(), Span::NONE).unwrap().len(), 1 << 20);

        let limits = Limits { max_file_bytes: 1 << 16, ..Limits::default() };
        let error = read_bytes(&path, &limits, Span::NONE).unwrap_err();
        assert!(matches!(error, SceneError::Limit { limit: 65536, .. }), "{error}");
    }

    #[test]
    fn the_first_folder_that_has_the_file_wins() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("meshes")).unwrap();
        std::fs::write(folder.path().join("meshes/a.ply"), "").unwrap();
        let mut search = SearchPath::beside(&folder.path().join("scene.xml"));
        search.push_front("/nowhere".into());
        assert_eq!(search.resolve("meshes/a.ply"), folder.path().join("meshes/a.ply"));
        assert_eq!(search.resolve("meshes\\a.ply"), folder.path().join("meshes/a.ply"));
        assert_eq!(search.resolve("b.ply"), Path::new("/nowhere/b.ply"));
        // Tests run in the folder of the crate; what is beside the scene comes before what is there.
        assert_eq!(search.resolve("src\\file.rs"), Path::new("src/file.rs"));
        std::fs::write(folder.path().join("Cargo.toml"), "").unwrap();
        assert_eq!(search.resolve("Cargo.toml"), folder.path().join("Cargo.toml"));
    }

    #[test]
    fn strays_are_refused_by_the_door_of_all_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bunny.ply");
        std::fs::write(&path, "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n").unwrap();
        let error = read_bytes(&path, &Limits::default(), Span::NONE).unwrap_err().to_string();
        assert!(error.contains("bunny.ply") && error.contains("Git LFS pointer"), "{error}");
    }

    #[test]
    fn a_missing_file_is_a_read_error() {
        let error = read_bytes("/nowhere/at/all".as_ref(), &Limits::default(), Span::NONE).unwrap_err();
        assert!(matches!(error, SceneError::Read { .. }));
    }
}
