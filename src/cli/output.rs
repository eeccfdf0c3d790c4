//! Files that appear whole or not at all.
//!
//! A file is written under a temporary name in the directory of its target
//! and renamed when complete. Several results of one run are renamed together
//! at the end, so that an error in one leaves none of them.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::fail::{reason, Failure};
use super::stop;

/// Where a result goes, found possible before any work is done.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// Standard output.
    Stdout,
    /// A regular file, there or not; links are resolved.
    File(PathBuf),
    /// Something there that cannot be replaced by renaming, only written
    /// into: a device, a pipe.
    Device(PathBuf),
}

impl Target {
    /// Judges a path that results shall be written to.
    pub fn judge(path: &Path) -> Result<Target, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Target::Stdout);
        }
        let path = match fs::metadata(path) {
            Ok(meta) if meta.is_dir() => {
                return Err(
                    Failure::file(path, "cannot write: this is a directory").hint(format!(
                        "name a file in it, such as {}",
                        path.join("crust.ply").display()
                    )),
                );
            }
            Ok(meta) if !meta.is_file() => return Ok(Target::Device(path.to_owned())),
            Ok(meta) if meta.permissions().readonly() => {
                return Err(Failure::file(path, "cannot write: the file is read-only")
                    .hint("make it writable, remove it, or give another name"));
            }
            Ok(_) => fs::canonicalize(path).map_err(|e| Failure::file(path, reason(&e)))?,
            Err(_) => path.to_owned(),
        };
        let directory = directory(&path);
        if !directory.is_dir() {
            return Err(Failure::file(
                &path,
                format!(
                    "cannot write: there is no directory {}",
                    directory.display()
                ),
            )
            .hint(format!("mkdir -p {}", directory.display())));
        }
        // The only reliable question is to create a file there.
        match tempfile::Builder::new()
            .prefix(".powercrust-")
            .tempfile_in(directory)
        {
            Ok(_) => Ok(Target::File(path)),
            Err(error) => Err(Failure::file(
                &path,
                format!(
                    "cannot write into {}: {}",
                    directory.display(),
                    cause(&error)
                ),
            )
            .hint("choose a directory that you may write to")),
        }
    }

    /// Writes the result by `write`; a file stays under its temporary name
    /// until [`Staged::publish`].
    pub fn stage(
        &self,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Staged, Failure> {
        let outcome = match self {
            Target::Stdout => into_stream(io::stdout().lock(), write).map(|()| Staged(None)),
            Target::Device(path) => OpenOptions::new()
                .write(true)
                .open(path)
                .and_then(|file| into_stream(file, write))
                .map(|()| Staged(None)),
            Target::File(path) => into_temporary(path, write),
        };
        outcome.map_err(|error| {
            if stop::requested() {
                return Failure::interrupted();
            }
            let failure = match self {
                Target::Stdout => Failure::new(
                    super::fail::Code::File,
                    format!("standard output: cannot write: {}", cause(&error)),
                ),
                Target::File(path) | Target::Device(path) => {
                    Failure::file(path, format!("cannot write: {}", cause(&error)))
                }
            };
            if error.kind() == io::ErrorKind::StorageFull {
                failure.hint("free some space there; no partial file was left behind")
            } else {
                failure
            }
        })
    }
}

/// The directory a file lies in.
fn directory(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The system's reason, without the temporary name that tempfile adds.
fn cause(error: &io::Error) -> String {
    let text = reason(error);
    match text.split_once(" at path ") {
        Some((plain, _)) => plain.to_owned(),
        None => text,
    }
}

/// A reader that went away has had enough: that is success.
fn into_stream(
    stream: impl Write,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffer = BufWriter::with_capacity(1 << 16, Stoppable(stream));
    match write(&mut buffer).and_then(|()| buffer.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
            // Nothing more may be tried on it when the buffer is dropped.
            let _ = buffer.into_parts();
            Ok(())
        }
        other => other,
    }
}

fn into_temporary(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<Staged> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".powercrust-");
    let old = fs::metadata(path).ok().map(|meta| meta.permissions());
    #[cfg(unix)]
    {
        // As any new file: what the umask leaves of 666.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let temporary = builder.tempfile_in(directory(path))?;
    let partial = stop::Partial::new(temporary.path());
    let mut buffer = BufWriter::with_capacity(1 << 16, Stoppable(temporary.as_file()));
    write(&mut buffer)?;
    buffer.flush()?;
    drop(buffer);
    if let Some(old) = old {
        temporary.as_file().set_permissions(old)?;
    }
    sync(temporary.as_file())?;
    Ok(Staged(Some((temporary, path.to_owned(), partial))))
}

/// Some systems tell only now that the disk is full.
fn sync(file: &File) -> io::Result<()> {
    match file.sync_all() {
        // Not every file system knows this call.
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
        other => other,
    }
}

/// A result written and not yet visible under its name.
pub struct Staged(Option<(NamedTempFile, PathBuf, stop::Partial)>);

impl Staged {
    /// Gives the file its name.
    pub fn publish(self) -> Result<(), Failure> {
        let Some((temporary, path, _partial)) = self.0 else {
            return Ok(());
        };
        match temporary.persist(&path) {
            Ok(_) => Ok(()),
            Err(error) => Err(Failure::file(
                &path,
                format!("cannot write: {}", reason(&error.error)),
            )),
        }
    }
}

/// A writer that fails once Ctrl-C was pressed.
struct Stoppable<W>(W);

impl<W: Write> Write for Stoppable<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if stop::requested() {
            return Err(io::Error::other("interrupted"));
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(directory: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn file_appears_only_when_published() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("crust.ply");
        let target = Target::judge(&path).unwrap();
        assert!(entries(directory.path()).is_empty());
        let staged = target.stage(|w| w.write_all(b"whole")).unwrap();
        assert!(!path.exists());
        staged.publish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(entries(directory.path()), ["crust.ply"]);
    }

    #[test]
    fn error_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("crust.ply");
        fs::write(&path, "old").unwrap();
        let failed = Target::judge(&path).unwrap().stage(|w| {
            w.write_all(&[b'x'; 200_000])?;
            Err(io::ErrorKind::StorageFull.into())
        });
        let failure = failed.err().unwrap();
        assert_eq!(failure.code, super::super::fail::Code::File);
        assert!(failure.hint.unwrap().contains("space"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(entries(directory.path()), ["crust.ply"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_modes_kept() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("crust.ply");
        let link = directory.path().join("link.ply");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        let staged = Target::judge(&link).unwrap().stage(|w| w.write_all(b"new"));
        staged.unwrap().publish().unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"new");
        let mode = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_written_into_not_replaced() {
        let null = Path::new("/dev/null");
        let target = Target::judge(null).unwrap();
        assert_eq!(target, Target::Device(null.to_owned()));
        target
            .stage(|w| w.write_all(b"gone"))
            .unwrap()
            .publish()
            .unwrap();
        assert!(!fs::metadata(null).unwrap().is_file());
    }
}
