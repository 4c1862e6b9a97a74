//! Rays from CSV files. A header is optional; spaces and quotes around numbers, and empty lines, are passed over.

use std::io::BufRead;

use leafwalk::RayF64;

use super::{COLUMN_COUNTS, COLUMNS, RaysError, Row};

/// How much of a field is quoted in an error.
const QUOTED_CHARACTERS: usize = 40;
const BYTE_ORDER_MARK: char = '\u{feff}';

pub(super) fn read(mut reader: impl BufRead) -> Result<Vec<RayF64>, RaysError> {
    let mut rays = Vec::new();
    let mut columns = None;
    let mut bytes = Vec::new();
    for line in 1.. {
        bytes.clear();
        if reader.read_until(b'\n', &mut bytes)? == 0 {
            break;
        }
        let text = core::str::from_utf8(&bytes).map_err(|error| {
            let before = bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b',').count();
            RaysError::Encoding { line, column: before + 1 }
        })?;
        let text = text.trim_start_matches(BYTE_ORDER_MARK).trim();
        if text.is_empty() {
            continue;
        }
        let found = text.split(',').count();
        if !COLUMN_COUNTS.contains(&found) || columns.is_some_and(|columns| columns != found) {
            return Err(RaysError::Columns { line, found, expected: columns });
        }
        let fields = text.split(',').map(unquoted);
        let is_header = columns.is_none() && fields.clone().next().is_some_and(|field| number(field).is_none());
        if is_header {
            check_header(fields, line)?;
        } else {
            rays.push(ray(fields, line)?);
        }
        columns = Some(found);
    }
    Ok(rays)
}

fn unquoted(field: &str) -> &str {
    let field = field.trim();
    field.strip_prefix('"').and_then(|field| field.strip_suffix('"')).unwrap_or(field)
}

fn ray<'a>(fields: impl Iterator<Item = &'a str>, line: u64) -> Result<RayF64, RaysError> {
    let mut ray = RayF64::BLANK;
    for (column, field) in fields.enumerate() {
        let value = number(field);
        let value = value.ok_or_else(|| RaysError::Number { line, column: column + 1, found: quoted(field) })?;
        ray.set(column, value);
    }
    Ok(ray)
}

/// NaN is a number here: it makes an invalid ray.
fn number(field: &str) -> Option<f64> {
    field.parse().ok()
}

fn check_header<'a>(fields: impl Iterator<Item = &'a str>, line: u64) -> Result<(), RaysError> {
    let mut named = fields.zip(COLUMNS).zip(1..);
    match named.find(|((field, name), _)| !field.eq_ignore_ascii_case(name)) {
        None => Ok(()),
        Some(((field, _), column)) => Err(RaysError::Name { line, column, found: quoted(field) }),
    }
}

fn quoted(field: &str) -> String {
    field.chars().take(QUOTED_CHARACTERS).flat_map(char::escape_debug).collect()
}
