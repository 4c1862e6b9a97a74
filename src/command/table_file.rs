//! Names of files that hold a table, one row a ray.

use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};

/// A path whose extension says how the table is written.
#[derive(Clone, Debug)]
pub(crate) struct TableFile {
    pub(crate) path: PathBuf,
    pub(crate) format: TableFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TableFormat {
    Npy,
    Csv,
}

impl TableFile {
    /// Reads an argument; another extension is a usage error.
    pub(crate) fn parser() -> impl TypedValueParser<Value = Self> {
        PathBufValueParser::new().try_map(|path| match path.extension() {
            Some(extension) if extension.eq_ignore_ascii_case("npy") => Ok(Self { path, format: TableFormat::Npy }),
            Some(extension) if extension.eq_ignore_ascii_case("csv") => Ok(Self { path, format: TableFormat::Csv }),
            _ => Err("the name must end in .npy or .csv"),
        })
    }
}
