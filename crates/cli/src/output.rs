//! Where results go: standard output, or a file whose folder is checked before an hour of work.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use aureole::image::{Format, Image, WriteOptions, encode, write_image};

use crate::exit::{Exit, Failure};

/// Writes text or bytes to standard output. A reader that has had enough is no failure.
pub(crate) fn print(bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes.as_ref()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(Exit::Io, format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Where an image goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Output {
    /// A file; its suffix names the format.
    File(PathBuf),
    /// Standard output, in this format.
    Stdout(Format),
}

impl Output {
    /// What `-o` says; `format` overrules nothing but the format of standard output.
    pub(crate) fn new(path: &Path, format: Option<Format>) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Self::Stdout(format.unwrap_or(Format::Png)));
        }
        match format {
            Some(_) => {
                Err(Failure::usage("`--format` is for `-o -`; a file's format follows from its suffix"))
            }
            None => Ok(Self::File(path.to_owned())),
        }
    }

    /// Finds out, before the work begins, whether the result can be written.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        match self {
            Self::Stdout(_) if io::stdout().is_terminal() => {
                Err(Failure::usage("an image is not for the eyes of a terminal")
                    .with_help("redirect it: `-o - > image.png`"))
            }
            Self::Stdout(_) => Ok(()),
            Self::File(path) => check_file(path),
        }
    }

    /// Writes the image.
    pub(crate) fn write(&self, image: &Image, options: &WriteOptions) -> Result<(), Failure> {
        match self {
            Self::Stdout(format) => print(encode(image, *format, options)?),
            Self::File(path) => Ok(write_image(image, path, options)?),
        }
    }
}

impl std::fmt::Display for Output {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Stdout(_) => f.write_str("-"),
        }
    }
}

fn check_file(path: &Path) -> Result<(), Failure> {
    let format = Format::from_path(path)?;
    if !format.writable() {
        let known: Vec<_> = Format::all().filter(|f| f.writable()).map(Format::suffix).collect();
        return Err(Failure::usage(format!("`{}` files can be read, not written", format.suffix()))
            .with_help(format!("formats that can be written: {}", known.join(", "))));
    }
    let fault =
        |message: &str| Failure::new(Exit::Io, format!("cannot write `{}`: {message}", path.display()));
    match std::fs::metadata(path) {
        Ok(meta) if meta.is_dir() => return Err(fault("it is a folder")),
        Ok(meta) if meta.permissions().readonly() => return Err(fault("it is read-only")),
        Ok(meta) if !meta.is_file() => return Ok(()), // a device or a pipe
        _ => {}
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(fault("there is no such folder").with_help(format!("`mkdir -p {}`", folder.display())));
    }
    // The only sure way to know whether a file can be made is to make one; it is gone at once.
    tempfile::tempfile_in(folder).map(drop).map_err(|error| Failure::write(path, &error))
}

/// Whether two names are of one file, be it there or not yet.
pub(crate) fn is_same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        path.canonicalize().ok().or_else(|| {
            let folder =
                path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            Some(folder.canonicalize().ok()?.join(path.file_name()?))
        })
    };
    a == b || place(a).is_some_and(|place_of_a| place(b) == Some(place_of_a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_is_known_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        let exit = |name: &str| check_file(&folder.path().join(name)).err().map(|failure| failure.exit());
        assert_eq!(exit("a.png"), None);
        assert_eq!(exit("missing/a.png"), Some(Exit::Io));
        assert_eq!(exit("a.pgn"), Some(Exit::Usage));
        assert_eq!(exit("a.tga"), Some(Exit::Usage));
        std::fs::create_dir(folder.path().join("b.png")).unwrap();
        assert_eq!(exit("b.png"), Some(Exit::Io));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
    }

    #[test]
    fn files_have_many_names() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.exr", "./../b.exr"].map(|name| folder.path().join(name));
        assert!(is_same_file(&a, &folder.path().join("./a.exr")));
        assert!(!is_same_file(&a, &folder.path().join("b.exr")) && !is_same_file(&a, &b));
        std::fs::write(&a, "").unwrap();
        std::os::unix::fs::symlink(&a, folder.path().join("link.exr")).unwrap();
        assert!(is_same_file(&a, &folder.path().join("link.exr")));
    }

    #[test]
    fn a_dash_is_standard_output() {
        assert_eq!(Output::new("-".as_ref(), None).unwrap(), Output::Stdout(Format::Png));
        assert_eq!(Output::new("-".as_ref(), Some(Format::Exr)).unwrap(), Output::Stdout(Format::Exr));
        assert!(Output::new("a.png".as_ref(), Some(Format::Exr)).is_err());
    }
}
