//! Files of rays, which have a row for each ray: ox oy oz dx dy dz, then t_min and t_max where they are given.

mod csv;
mod error;
mod npy;

use std::fs::File;
use std::io::BufReader;

use leafwalk::Ray;

pub(crate) use error::RaysError;

use super::error::CommandError;
use super::table_file::{TableFile, TableFormat};

/// What the columns are called; the last two are optional.
const COLUMNS: [&str; 8] = ["ox", "oy", "oz", "dx", "dy", "dz", "t_min", "t_max"];
/// How many columns a file may have.
const COLUMN_COUNTS: core::ops::RangeInclusive<usize> = 6..=COLUMNS.len();

/// Reads all rays of a file. Numbers are rounded to f32; rays that cannot be traced are rays all the same.
pub(crate) fn read(file: &TableFile) -> Result<Vec<Ray>, CommandError> {
    let read = || {
        let reader = BufReader::with_capacity(BUFFER_BYTES, File::open(&file.path)?);
        match file.format {
            TableFormat::Npy => npy::read(reader),
            TableFormat::Csv => csv::read(reader),
        }
    };
    read().map_err(|source| CommandError::Rays { path: file.path.clone(), source })
}

const BUFFER_BYTES: usize = 1 << 20;

/// The ray of a row of which no column is known yet.
fn blank() -> Ray {
    Ray::new([0.0; 3], [0.0; 3])
}

/// Fills in one column.
fn set(ray: &mut Ray, column: usize, value: f32) {
    match column {
        0..3 => ray.origin[column] = value,
        3..6 => ray.direction[column - 3] = value,
        6 => ray.t_min = value,
        _ => ray.t_max = value,
    }
}
