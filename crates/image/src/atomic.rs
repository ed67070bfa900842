//! Files that are either whole or not there.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::ImageError;

/// Writes a file beside its place, flushes it to the disk, and only then gives it its name.
///
/// An older file of that name keeps its permissions, and one that may not be written is not replaced. Symbolic links are
/// followed. Devices and pipes, which have no beside, are written directly.
///
/// # Errors
/// [`ImageError::Write`]; the old file, if there was one, is then untouched and nothing is left beside it.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), ImageError> {
    write_whole(path, bytes).map_err(|source| ImageError::Write { path: path.to_owned(), source })
}

fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let old = std::fs::metadata(path).ok();
    if old.as_ref().is_some_and(|meta| !meta.is_file()) {
        // A device or a pipe; a folder gives the right error here.
        return std::fs::write(path, bytes);
    }
    if old.as_ref().is_some_and(|meta| meta.permissions().readonly()) {
        return Err(std::io::Error::new(std::io::ErrorKind::PermissionDenied, "the file is read-only"));
    }
    // Renaming onto a link would replace the link, not what it points to.
    let target = if old.is_some() { path.canonicalize()? } else { path.to_owned() };
    let folder = folder_of(&target);

    let mut builder = tempfile::Builder::new();
    builder.prefix(".aureole-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // A new file's mode is subject to the process's mask, as for any file that a program creates.
        let mode = old.as_ref().map_or(0o666, |meta| meta.permissions().mode() & 0o777);
        builder.permissions(std::fs::Permissions::from_mode(mode));
    }
    let mut file = builder.tempfile_in(&folder)?;
    // Into the file itself: errors of its wrapper name a file that nobody has asked for.
    file.as_file_mut().write_all(bytes)?;
    if let Some(meta) = &old {
        file.as_file().set_permissions(meta.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|error| error.error)?;
    sync_folder(&folder);
    Ok(())
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
}

/// Makes the new name survive a power cut. Some file systems cannot; the file itself is safe already.
fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Ok(handle) = std::fs::File::open(folder) {
        let _ = handle.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_old_file_is_replaced_and_nothing_stays_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomically(&path, b"old").unwrap();
        write_atomically(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_and_a_folder_are_io_errors() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().join("no/such/a.png"), folder.path().to_owned()] {
            let error = write_atomically(&path, b"x").unwrap_err();
            assert!(error.is_io(), "{error}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_and_links_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, b"old").unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);

        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o440)).unwrap();
        assert!(write_atomically(&file, b"no").unwrap_err().is_io());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        write_atomically(Path::new("/dev/null"), b"x").unwrap();
    }
}
