//! Files of rays, which have a row for each ray: ox oy oz dx dy dz, then t_min and t_max where they are given.

mod csv;
mod error;
mod npy;

use std::fs::File;
use std::io::BufReader;

use leafwalk::{Ray, RayF64};

pub(crate) use error::RaysError;

use super::error::CommandError;
use super::table_file::{TableFile, TableFormat};

/// What the columns are called; the last two are optional.
const COLUMNS: [&str; 8] = ["ox", "oy", "oz", "dx", "dy", "dz", "t_min", "t_max"];
/// How many columns a file may have.
const COLUMN_COUNTS: core::ops::RangeInclusive<usize> = 6..=COLUMNS.len();

/// The rays of a file, in its precision.
pub(crate) enum Rays {
    /// From an npy file whose items are f4.
    F32(Vec<Ray>),
    /// From an npy file whose items are f8, or from a CSV file.
    F64(Vec<RayF64>),
}

impl Rays {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::F32(rays) => rays.len(),
            Self::F64(rays) => rays.len(),
        }
    }

    pub(crate) fn into_f32(self) -> Vec<Ray> {
        match self {
            Self::F32(rays) => rays,
            Self::F64(rays) => rays.into_iter().map(Ray::from).collect(),
        }
    }

    pub(crate) fn into_f64(self) -> Vec<RayF64> {
        match self {
            Self::F32(rays) => rays.into_iter().map(RayF64::from).collect(),
            Self::F64(rays) => rays,
        }
    }

    /// How many cannot be traced.
    pub(crate) fn invalid(&self) -> usize {
        match self {
            Self::F32(rays) => rays.iter().filter(|ray| !ray.is_valid()).count(),
            Self::F64(rays) => rays.iter().filter(|ray| !ray.is_valid()).count(),
        }
    }
}

/// Reads all rays of a file. Rays that cannot be traced are rays all the same.
pub(crate) fn read(file: &TableFile) -> Result<Rays, CommandError> {
    let read = || {
        let reader = BufReader::with_capacity(BUFFER_BYTES, File::open(&file.path)?);
        match file.format {
            TableFormat::Npy => npy::read(reader),
            TableFormat::Csv => csv::read(reader).map(Rays::F64),
        }
    };
    read().map_err(|source| CommandError::Rays { path: file.path.clone(), source })
}

const BUFFER_BYTES: usize = 1 << 20;

/// A ray as the rows of a file give it.
trait Row {
    type Number;
    /// No column is known yet.
    const BLANK: Self;
    /// Fills in one column.
    fn set(&mut self, column: usize, value: Self::Number);
}

macro_rules! row {
    ($ray:ident of $number:ident) => {
        impl Row for $ray {
            type Number = $number;
            const BLANK: Self = Self { origin: [0.0; 3], t_min: 0.0, direction: [0.0; 3], t_max: $number::INFINITY };

            fn set(&mut self, column: usize, value: $number) {
                match column {
                    0..3 => self.origin[column] = value,
                    3..6 => self.direction[column - 3] = value,
                    6 => self.t_min = value,
                    _ => self.t_max = value,
                }
            }
        }
    };
}
row!(Ray of f32);
row!(RayF64 of f64);
