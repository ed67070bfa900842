//! Claims on files: of two processes that would write the same checkpoint, the second one is told so.

use std::ffi::OsString;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use crate::exit::{Exit, Failure};

/// A claim on a file, by a locked one beside it. The system lets go of the lock when the process ends, however it ends.
#[derive(Debug)]
pub(crate) struct Claim {
    path: PathBuf,
    /// Nothing where the file system knows no locks.
    file: Option<File>,
}

impl Claim {
    /// Claims a file that need not be there yet.
    ///
    /// # Errors
    /// Another process has claimed it, or nothing can be written beside it.
    pub(crate) fn new(claimed: &Path) -> Result<Self, Failure> {
        let path = beside(claimed);
        loop {
            let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
            let file = file.map_err(|error| Failure::write(claimed, &error))?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    let message = format!("`{}` is in use by another process", claimed.display());
                    return Err(Failure::new(Exit::Io, message).with_help("name another checkpoint"));
                }
                Err(TryLockError::Error(_)) => {
                    let _ = std::fs::remove_file(&path);
                    return Ok(Self { path, file: None });
                }
                // Whoever had it before may have removed it after it was opened here.
                Ok(()) if !is_still_there(&file, &path) => {}
                Ok(()) => return Ok(Self { path, file: Some(file) }),
            }
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            // One that stays behind is of no consequence.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// `.aureole-NAME.lock` in the file's folder.
fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".aureole-");
    name.push(path.file_name().unwrap_or_default());
    name.push(".lock");
    path.with_file_name(name)
}

#[cfg(unix)]
fn is_still_there(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |meta: std::io::Result<std::fs::Metadata>| meta.map(|meta| (meta.dev(), meta.ino())).ok();
    id(file.metadata()) == id(std::fs::metadata(path))
}

#[cfg(not(unix))]
fn is_still_there(_: &File, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.exr");
        let claim = Claim::new(&path).unwrap();
        assert_eq!(Claim::new(&path).unwrap_err().exit(), Exit::Io);
        drop(claim);
        let again = Claim::new(&path).unwrap();
        assert!(Claim::new(&folder.path().join("other.exr")).is_ok());
        drop(again);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
        assert!(Claim::new(&folder.path().join("missing/film.exr")).is_err());
    }
}
