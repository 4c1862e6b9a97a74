//! Why rays were not read.

use core::fmt;
use std::io;

use super::COLUMNS;

/// Why a file of rays was not read. Lines, columns and rows count from 1.
#[derive(Debug)]
pub(crate) enum RaysError {
    /// The file cannot be opened or read.
    Io(io::Error),
    /// The first line of an npy file is damaged, or it is none.
    NpyHeader { message: String },
    /// An npy file of other items than f4 or f8.
    ItemType { found: String },
    /// An npy file whose shape is not rows times six to eight columns.
    Shape { found: Vec<u64> },
    /// An npy file that ends before its last item.
    Truncated { read: u64, promised: u64 },
    /// An npy file that goes on after its last item.
    Appended { promised: u64 },
    /// A line of CSV with a number of columns that no ray has, or another one than the lines before.
    Columns { line: u64, found: usize, expected: Option<usize> },
    /// A field of CSV that is no number.
    Number { line: u64, column: usize, found: String },
    /// A header of CSV that names another column.
    Name { line: u64, column: usize, found: String },
    /// A line of CSV that is not UTF-8.
    Encoding { line: u64, column: usize },
}

impl fmt::Display for RaysError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(source) => write!(f, "cannot be read: {source}"),
            Self::NpyHeader { message } => write!(f, "this is no npy file that holds rays: {message}"),
            Self::ItemType { found } => write!(f, "items of type {found}: convert them to f4 or f8"),
            Self::Shape { found } => {
                write!(f, "shape {found:?}: rays are rows of 6, 7 or 8 columns ({})", COLUMNS.join(", "))
            }
            Self::Truncated { read, promised } => {
                write!(f, "ends after {read} of {promised} items: it is cut, get it again")
            }
            Self::Appended { promised } => write!(f, "goes on after its {promised} items: write it anew"),
            Self::Columns { line, found, expected: Some(expected) } => {
                write!(f, "line {line}: {found} columns, but {expected} in the lines before")
            }
            Self::Columns { line, found, expected: None } => {
                write!(f, "line {line}: {found} columns; rays have 6, 7 or 8 ({})", COLUMNS.join(", "))
            }
            Self::Number { line, column, found } => {
                write!(f, "line {line}, column {column}: '{found}' is no number")
            }
            Self::Name { line, column, found } => {
                let expected = COLUMNS[column - 1];
                write!(f, "line {line}, column {column}: '{found}' is no number, and a header names '{expected}' here")
            }
            Self::Encoding { line, column } => write!(f, "line {line}, column {column}: this is no text (UTF-8)"),
        }
    }
}

impl core::error::Error for RaysError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Io(source) => Some(source),
            _ => None,
        }
    }
}

impl From<io::Error> for RaysError {
    fn from(source: io::Error) -> Self {
        Self::Io(source)
    }
}
