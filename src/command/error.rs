//! Why a command failed.

use core::fmt;
use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use leafwalk::mesh_file::MeshError;
use leafwalk::{BuildError, FileError, LengthMismatch, VerifyError};

use super::backend::BackendError;
use super::rays::RaysError;
use crate::camera::{CameraError, Size};
use crate::picture::PictureError;

/// Why a command failed; the text is what follows `error: ` on stderr.
#[derive(Debug)]
pub(crate) enum CommandError {
    Mesh(MeshError),
    Build(BuildError),
    File(FileError),
    Verify {
        path: PathBuf,
        source: VerifyError,
    },
    Rays {
        path: PathBuf,
        source: RaysError,
    },
    Trace(BackendError),
    /// Arguments that do not go together, or that this build cannot follow.
    Usage(&'static str),
    Camera(CameraError),
    /// A picture too large for this machine.
    Picture {
        size: Size,
    },
    /// An output cannot be written.
    Write {
        path: PathBuf,
        source: io::Error,
    },
    /// An output would replace an input.
    Overwrite {
        path: PathBuf,
    },
    Stdout(io::Error),
    Threads(rayon::ThreadPoolBuildError),
    Signals(ctrlc::Error),
    /// Ctrl-C was pressed.
    Cancelled,
}

impl CommandError {
    /// The exit code that the shell sees: 130 after Ctrl-C, 2 for wrong usage, of which clap finds the most, and
    /// otherwise
    /// 1.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Cancelled => ExitCode::from(CANCELLED),
            Self::Usage(_) => ExitCode::from(USAGE),
            _ => ExitCode::FAILURE,
        }
    }
}

/// The exit code of wrong usage, which clap gives, too.
const USAGE: u8 = 2;
/// The exit code after Ctrl-C: 128 and the number of SIGINT.
pub(crate) const CANCELLED: u8 = 130;

impl fmt::Display for CommandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(source) => source.fmt(f),
            Self::Build(source) => source.fmt(f),
            Self::File(source) => source.fmt(f),
            Self::Verify { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Rays { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Trace(source) => source.fmt(f),
            Self::Usage(text) => f.write_str(text),
            Self::Camera(source) => source.fmt(f),
            Self::Picture { size: Size { width, height } } => {
                write!(f, "no memory for {width} x {height} pixels: choose a smaller size")
            }
            Self::Write { path, source } => write!(f, "{}: cannot be written: {source}", path.display()),
            Self::Overwrite { path } => {
                write!(f, "{}: is an input and would be replaced: give the output another name", path.display())
            }
            Self::Stdout(source) => write!(f, "the report cannot be printed: {source}"),
            Self::Threads(source) => write!(f, "the threads cannot be started: {source}"),
            Self::Signals(source) => write!(f, "Ctrl-C cannot be caught: {source}"),
            Self::Cancelled => write!(f, "cancelled"),
        }
    }
}

impl core::error::Error for CommandError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            // Their text is that of the error they hold, so what caused that one is next.
            Self::Mesh(error) => error.source(),
            Self::Build(error) => error.source(),
            Self::File(error) => error.source(),
            Self::Trace(error) => error.source(),
            Self::Camera(error) => error.source(),
            Self::Verify { source, .. } => Some(source),
            Self::Rays { source, .. } => Some(source),
            Self::Write { source, .. } | Self::Stdout(source) => Some(source),
            Self::Threads(source) => Some(source),
            Self::Signals(source) => Some(source),
            Self::Usage(_) | Self::Picture { .. } | Self::Overwrite { .. } | Self::Cancelled => None,
        }
    }
}

impl From<MeshError> for CommandError {
    fn from(source: MeshError) -> Self {
        Self::Mesh(source)
    }
}

impl From<BuildError> for CommandError {
    fn from(source: BuildError) -> Self {
        match source {
            BuildError::Cancelled => Self::Cancelled,
            source => Self::Build(source),
        }
    }
}

impl From<FileError> for CommandError {
    fn from(source: FileError) -> Self {
        Self::File(source)
    }
}

impl From<BackendError> for CommandError {
    fn from(source: BackendError) -> Self {
        Self::Trace(source)
    }
}

impl From<LengthMismatch> for CommandError {
    fn from(source: LengthMismatch) -> Self {
        Self::Trace(BackendError::Lengths(source))
    }
}

impl From<CameraError> for CommandError {
    fn from(source: CameraError) -> Self {
        Self::Camera(source)
    }
}

impl<E> From<PictureError<E>> for CommandError
where
    Self: From<E>,
{
    fn from(source: PictureError<E>) -> Self {
        match source {
            PictureError::Tracer(source) => source.into(),
            PictureError::OutOfMemory { size } => Self::Picture { size },
            PictureError::Cancelled => Self::Cancelled,
        }
    }
}

#[cfg(test)]
mod tests {
    use core::error::Error;

    use super::*;

    #[test]
    fn errors_lead_to_what_the_system_said() {
        let denied = || io::Error::from(io::ErrorKind::PermissionDenied);
        let path = || PathBuf::from("a.lwk");
        let errors: [CommandError; 4] = [
            FileError::Io { path: path(), source: denied() }.into(),
            MeshError::Io { path: path(), source: denied() }.into(),
            CommandError::Rays { path: path(), source: denied().into() },
            CommandError::Write { path: path(), source: denied() },
        ];
        for error in errors {
            let chain = core::iter::successors(error.source(), |error| (*error).source());
            let last = chain.last().and_then(|last| last.downcast_ref::<io::Error>());
            assert_eq!(last.map(io::Error::kind), Some(io::ErrorKind::PermissionDenied), "{error}");
        }
        assert!(CommandError::Usage("wrong").source().is_none());
    }
}
