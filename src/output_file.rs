//! Output files, which appear whole or not at all.

use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file that is written under a temporary name, in the folder where it will stand, until it is complete. If it is
/// dropped before, what was there stays and the temporary file goes. A path that leads to something other than a
/// regular file (a device, a pipe) is written in place.
#[derive(Debug)]
pub struct OutputFile {
    target: Target,
}

#[derive(Debug)]
enum Target {
    /// No regular file, written as it is.
    InPlace(PathBuf),
    /// The temporary file, and the path that it gets: where the path given is a link, that of the file it leads to.
    Replaced(NamedTempFile, PathBuf),
}

impl OutputFile {
    /// Finds out whether there can be a file `path`, without changing what is there.
    ///
    /// # Errors
    /// The errors of the file system; [`ErrorKind::PermissionDenied`] where the file is there and read-only.
    pub fn create(path: &Path) -> io::Result<Self> {
        if path.file_name().is_none() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "this names no file"));
        }
        let target = match fs::metadata(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Target::Replaced(temporary(path, None)?, path.to_owned())
            }
            Err(error) => return Err(error),
            Ok(metadata) if metadata.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(metadata) if !metadata.is_file() => Target::InPlace(path.to_owned()),
            // Renaming over a read-only file would succeed.
            Ok(metadata) if metadata.permissions().readonly() => return Err(ErrorKind::PermissionDenied.into()),
            Ok(metadata) => {
                let path = fs::canonicalize(path)?;
                Target::Replaced(temporary(&path, Some(metadata.permissions()))?, path)
            }
        };
        Ok(Self { target })
    }

    /// The temporary name, for those who end the process and must remove the file before.
    pub fn temporary_path(&self) -> Option<&Path> {
        match &self.target {
            Target::InPlace(_) => None,
            Target::Replaced(file, _) => Some(file.path()),
        }
    }

    /// Writes the content.
    ///
    /// # Errors
    /// The errors of `write`, and those of the file system.
    pub fn write(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let mut opened;
        let file = match &mut self.target {
            Target::InPlace(path) => {
                opened = File::options().write(true).open(path)?;
                &mut opened
            }
            Target::Replaced(file, _) => file.as_file_mut(),
        };
        let mut writer = BufWriter::with_capacity(BUFFER_BYTES, file);
        write(&mut writer)?;
        writer.flush()
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// The errors of the file system.
    pub fn commit(self) -> io::Result<()> {
        match self.target {
            Target::InPlace(_) => Ok(()),
            Target::Replaced(file, path) => Ok(file.persist(path).map(drop)?),
        }
    }
}

const BUFFER_BYTES: usize = 64 << 10;

/// A temporary file beside `path`, with the permissions given or those that a new file gets.
fn temporary(path: &Path, permissions: Option<Permissions>) -> io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".leafwalk-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(folder)?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    Ok(file)
}
