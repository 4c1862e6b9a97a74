//! Files of hits, which have a row for each ray: t, u, v, primitive.

use std::io::{self, Write};

use leafwalk::Hit;
use npyz::{DType, Field, WriterBuilder};

use super::context::Context;
use super::error::CommandError;
use super::table_file::{TableFile, TableFormat};

/// The names of the columns, and their types in an npy file.
const COLUMNS: [(&str, &str); 4] = [("t", "<f4"), ("u", "<f4"), ("v", "<f4"), ("primitive", "<u4")];

/// Writes the hits of all rays, in their order.
pub(crate) fn write(file: &TableFile, hits: &[Hit], context: &Context) -> Result<(), CommandError> {
    context.write(&file.path, |writer| match file.format {
        TableFormat::Npy => write_npy(writer, hits),
        TableFormat::Csv => write_csv(writer, hits),
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

fn write_npy(writer: &mut dyn Write, hits: &[Hit]) -> io::Result<()> {
    let field = |(name, item): (&str, &str)| {
        let item = item.parse().map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        Ok(Field { name: name.to_owned(), dtype: DType::new_scalar(item) })
    };
    let fields: io::Result<_> = COLUMNS.into_iter().map(field).collect();
    let options = npyz::WriteOptions::new().dtype(DType::Record(fields?)).shape(&[hits.len() as u64]);
    let mut file = options.writer(writer).begin_nd()?;
    file.extend(hits.iter().map(|hit| Row { t: hit.t, u: hit.u, v: hit.v, primitive: hit.primitive }))?;
    file.finish()
}

/// Each number in the fewest digits that give it back bit for bit; `inf` for no limit.
fn write_csv(writer: &mut dyn Write, hits: &[Hit]) -> io::Result<()> {
    writeln!(writer, "{}", COLUMNS.map(|(name, _)| name).join(","))?;
    hits.iter().try_for_each(|hit| writeln!(writer, "{:?},{:?},{:?},{}", hit.t, hit.u, hit.v, hit.primitive))
}
