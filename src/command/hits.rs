//! Files of hits, which have a row for each ray: t, u, v, primitive.

use core::fmt::Debug;
use std::io::{self, Write};

use leafwalk::{Hit, HitF64};
use npyz::{DType, Field, WriterBuilder};

use super::context::Context;
use super::error::CommandError;
use super::table_file::{TableFile, TableFormat};

/// The hits of rays, by the precision of their t.
pub(crate) enum Hits {
    F32(Vec<Hit>),
    F64(Vec<HitF64>),
}

impl Hits {
    /// The hits with t in f32.
    pub(crate) fn rounded(&self) -> Vec<Hit> {
        match self {
            Self::F32(hits) => hits.clone(),
            Self::F64(hits) => hits.iter().map(|hit| Hit::from(*hit)).collect(),
        }
    }
}

/// The name of the first column, and those of the others with their types in an npy file.
const DISTANCE: &str = "t";
const COLUMNS: [(&str, &str); 3] = [("u", "<f4"), ("v", "<f4"), ("primitive", "<u4")];

/// Writes the hits of all rays, in their order.
pub(crate) fn write(file: &TableFile, hits: &Hits, context: &Context) -> Result<(), CommandError> {
    context.write(&file.path, |writer| match (file.format, hits) {
        (TableFormat::Npy, Hits::F32(hits)) => write_npy(writer, "<f4", hits.iter().map(Row::from)),
        (TableFormat::Npy, Hits::F64(hits)) => write_npy(writer, "<f8", hits.iter().map(RowF64::from)),
        (TableFormat::Csv, Hits::F32(hits)) => write_csv(writer, hits.iter().map(|hit| (hit.t, *hit))),
        (TableFormat::Csv, Hits::F64(hits)) => write_csv(writer, hits.iter().map(|hit| (hit.t, Hit::from(*hit)))),
    })
}

/// [`Hit`] as npyz wants to see it.
#[derive(npyz::Serialize)]
struct Row {
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
}

impl From<&Hit> for Row {
    fn from(hit: &Hit) -> Self {
        Self { t: hit.t, u: hit.u, v: hit.v, primitive: hit.primitive }
    }
}

/// [`HitF64`] as npyz wants to see it.
#[derive(npyz::Serialize)]
struct RowF64 {
    t: f64,
    u: f32,
    v: f32,
    primitive: u32,
}

impl From<&HitF64> for RowF64 {
    fn from(hit: &HitF64) -> Self {
        Self { t: hit.t, u: hit.u, v: hit.v, primitive: hit.primitive }
    }
}

/// `t` is the type of the first column.
fn write_npy<R: npyz::Serialize>(
    writer: &mut dyn Write,
    t: &str,
    rows: impl ExactSizeIterator<Item = R>,
) -> io::Result<()> {
    let field = |(name, item): (&str, &str)| {
        let item = item.parse().map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        Ok(Field { name: name.to_owned(), dtype: DType::new_scalar(item) })
    };
    let fields: io::Result<_> = [(DISTANCE, t)].into_iter().chain(COLUMNS).map(field).collect();
    let options = npyz::WriteOptions::new().dtype(DType::Record(fields?)).shape(&[rows.len() as u64]);
    let mut file = options.writer(writer).begin_nd()?;
    file.extend(rows)?;
    file.finish()
}

/// Each number in the fewest digits that give it back bit for bit; `inf` for no limit.
fn write_csv<T: Debug>(writer: &mut dyn Write, mut rows: impl Iterator<Item = (T, Hit)>) -> io::Result<()> {
    let [u, v, primitive] = COLUMNS.map(|(name, _)| name);
    writeln!(writer, "{DISTANCE},{u},{v},{primitive}")?;
    rows.try_for_each(|(t, hit)| writeln!(writer, "{t:?},{:?},{:?},{}", hit.u, hit.v, hit.primitive))
}
