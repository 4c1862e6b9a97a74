//! `MeshError`: why a mesh file was not read.

use core::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a mesh file was not read. Faces, corners and lines count from 1, vertices as their format counts them.
#[derive(Debug)]
#[non_exhaustive]
pub enum MeshError {
    /// The extension is not that of a format that is read.
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be opened or read.
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The compressed data is damaged, cut off, or no gzip at all.
    Gzip {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        source: io::Error,
    },
    /// What was unzipped is a gzip file again.
    NestedGzip {
        /// The file.
        path: PathBuf,
    },
    /// More than [`Limits::max_bytes`](super::Limits::max_bytes), after decompression.
    TooManyBytes {
        /// The file.
        path: PathBuf,
        /// The limit, in bytes.
        limit: u64,
    },
    /// A line longer than [`Limits::max_line`](super::Limits::max_line).
    LineTooLong {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// The limit, in bytes.
        limit: usize,
    },
    /// A line of text that does not follow the format.
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// What is wrong with it.
        message: String,
    },
    /// A binary element that does not follow the format.
    Malformed {
        /// The file.
        path: PathBuf,
        /// What kind of element.
        element: String,
        /// Its number among its kind, from 1.
        number: u64,
        /// What is wrong with it.
        message: String,
    },
    /// The file ends too early.
    Truncated {
        /// The file.
        path: PathBuf,
        /// What kind of element is missing.
        element: String,
        /// How many were complete.
        read: u64,
        /// How many the header promised, where it did.
        promised: Option<u64>,
    },
    /// More bytes follow the triangles that a binary STL's header counts.
    FalseCount {
        /// The file.
        path: PathBuf,
        /// The triangles counted.
        count: u64,
    },
    /// More vertices or triangles than 32 bits can number.
    TooLarge {
        /// The file.
        path: PathBuf,
        /// What there is too much of.
        what: &'static str,
        /// How many the file holds or promises, at least.
        count: u64,
    },
    /// A PLY file without an element that a mesh needs.
    MissingElement {
        /// The file.
        path: PathBuf,
        /// The element.
        element: &'static str,
    },
    /// A PLY element without a property that a mesh needs, or one of another type.
    MissingProperty {
        /// The file.
        path: PathBuf,
        /// The element.
        element: &'static str,
        /// The property.
        property: &'static str,
        /// Its type.
        expected: &'static str,
    },
    /// A corner of a face names vertex 0 in a format that counts from 1.
    ZeroIndex {
        /// The file.
        path: PathBuf,
        /// The face.
        face: u64,
        /// Its line.
        line: u64,
    },
    /// A corner of a face names a vertex that does not exist.
    IndexOutOfRange {
        /// The file.
        path: PathBuf,
        /// The face.
        face: u64,
        /// The index as written.
        index: i64,
        /// How many vertices it can name.
        vertices: u64,
    },
    /// A polygon that has a dent, winds more than once or crosses itself, and so is no fan of triangles.
    ConcaveFace {
        /// The file.
        path: PathBuf,
        /// The face.
        face: u64,
        /// How many corners it has.
        corners: usize,
        /// The corner where it shows.
        corner: usize,
    },
    /// A polygon whose corners lie too far from one plane to say which surface is meant.
    NonPlanarFace {
        /// The file.
        path: PathBuf,
        /// The face.
        face: u64,
        /// How many corners it has.
        corners: usize,
        /// The largest distance of a corner from the mean plane.
        distance: f64,
        /// The distance that would pass.
        allowed: f64,
    },
}

/// How much of another library's message is passed on: such messages quote whole lines of the file.
const MESSAGE_CHARACTERS: usize = 200;

/// Another library's message on one line of bounded length.
pub(super) fn brief(message: impl fmt::Display) -> String {
    let message = message.to_string();
    let words: Vec<&str> = message.split_whitespace().take(MESSAGE_CHARACTERS).collect();
    words.join(" ").chars().take(MESSAGE_CHARACTERS).collect()
}

impl MeshError {
    /// The file that was not read: the mesh file or an MTL file that it names.
    pub fn path(&self) -> &Path {
        match self {
            Self::UnknownFormat { path }
            | Self::Io { path, .. }
            | Self::Gzip { path, .. }
            | Self::NestedGzip { path }
            | Self::TooManyBytes { path, .. }
            | Self::LineTooLong { path, .. }
            | Self::Syntax { path, .. }
            | Self::Malformed { path, .. }
            | Self::Truncated { path, .. }
            | Self::FalseCount { path, .. }
            | Self::TooLarge { path, .. }
            | Self::MissingElement { path, .. }
            | Self::MissingProperty { path, .. }
            | Self::ZeroIndex { path, .. }
            | Self::IndexOutOfRange { path, .. }
            | Self::ConcaveFace { path, .. }
            | Self::NonPlanarFace { path, .. } => path,
        }
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path().display())?;
        match self {
            Self::UnknownFormat { .. } => {
                write!(f, "unknown format: read are .obj, .ply and .stl, each also with .gz; convert or rename it")
            }
            Self::Io { source, .. } => write!(f, "cannot be read: {source}"),
            Self::Gzip { source, .. } => {
                write!(f, "the gzip data is damaged, cut off or no gzip ({source}); get the file again")
            }
            Self::NestedGzip { .. } => write!(f, "compressed twice; unzip it once"),
            Self::TooManyBytes { limit, .. } => {
                write!(f, "more than {limit} bytes after decompression; raise the limit if the file is to be trusted")
            }
            Self::LineTooLong { line, limit, .. } => {
                write!(f, "line {line} is longer than {limit} bytes; raise the limit if the file is to be trusted")
            }
            Self::Syntax { line, message, .. } => write!(f, "line {line}: {message}; correct it or export again"),
            Self::Malformed { element, number, message, .. } => {
                write!(f, "{element} {number}: {message}; the header may be false: export the mesh again")
            }
            Self::Truncated { element, read, promised, .. } => {
                write!(f, "the file ends after {read}")?;
                if let Some(promised) = promised {
                    write!(f, " of {promised}")?;
                }
                write!(f, " complete `{element}` elements; it is cut off or its header is false: get the file again")
            }
            Self::FalseCount { count, .. } => {
                write!(f, "more bytes follow the {count} triangles that the header counts; export the mesh again")
            }
            Self::TooLarge { what, count, .. } => {
                write!(f, "{count} {what}, more than the {} that 32 bits can number; split the mesh", u32::MAX)
            }
            Self::MissingElement { element, .. } => write!(
                f,
                "no element `{element}` (point clouds and triangle strips are not read); export it as a polygon mesh"
            ),
            Self::MissingProperty { element, property, expected, .. } => {
                write!(f, "element `{element}` has no property `{property}` of type {expected}; export the mesh again")
            }
            Self::ZeroIndex { face, line, .. } => {
                write!(f, "face {face} (line {line}) names vertex 0, but vertices count from 1; export the mesh again")
            }
            Self::IndexOutOfRange { face, index, vertices, .. } => {
                write!(f, "face {face} names vertex {index}, but there are {vertices}; export the mesh again")
            }
            Self::ConcaveFace { face, corners, corner, .. } => write!(
                f,
                "face {face} ({corners} corners) is not convex at its corner {corner}; export the mesh as triangles"
            ),
            Self::NonPlanarFace { face, corners, distance, allowed, .. } => write!(
                f,
                "face {face} ({corners} corners) is not flat: a corner lies {distance:.3e} from its plane, allowed \
                 are {allowed:.3e}; export the mesh as triangles"
            ),
        }
    }
}

impl core::error::Error for MeshError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } | Self::Gzip { source, .. } => Some(source),
            _ => None,
        }
    }
}
