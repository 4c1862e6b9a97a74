//! Rays from npy files: f4 or f8 of either byte order, C or Fortran order.

use std::io::{self, ErrorKind, Read};

use npyz::{DType, NpyFile, NpyHeader, Order, TypeChar};

use super::{COLUMN_COUNTS, Rays, RaysError, Row};

/// Bytes of the header: numpy's own limit.
const HEADER_BYTES: usize = 10_000;
/// Brackets in the header, of which a table of numbers needs two: the parser takes twice as long for each that nests.
const HEADER_BRACKETS: usize = 8;
/// Decimal digits in the header: the sizes' product is below 10^19, so that no product of them overflows 64 bits.
const HEADER_DIGITS: usize = 19;

pub(super) fn read(mut reader: impl Read) -> Result<Rays, RaysError> {
    let header = read_header(&mut reader)?;
    let &[rows, columns] = header.shape() else { return Err(RaysError::Shape { found: header.shape().to_vec() }) };
    if !usize::try_from(columns).is_ok_and(|columns| COLUMN_COUNTS.contains(&columns)) {
        return Err(RaysError::Shape { found: vec![rows, columns] });
    }
    let table = Table { rows, columns, order: header.order() };
    let item = match header.dtype() {
        DType::Plain(item) => (item.type_char(), item.size_field()),
        _ => (TypeChar::RawData, 0),
    };
    let found = header.dtype().descr();
    let file = NpyFile::with_header(header, &mut reader);
    let wrong_type = |_| RaysError::ItemType { found: found.clone() };
    let rays = match item {
        (TypeChar::Float, 4) => table.fill(file.data::<f32>().map_err(wrong_type)?).map(Rays::F32),
        (TypeChar::Float, 8) => table.fill(file.data::<f64>().map_err(wrong_type)?).map(Rays::F64),
        _ => Err(RaysError::ItemType { found }),
    }?;
    match reader.read(&mut [0])? {
        0 => Ok(rays),
        _ => Err(RaysError::Appended { promised: rows * columns }),
    }
}

struct Table {
    rows: u64,
    columns: u64,
    order: Order,
}

impl Table {
    /// Takes the items in the order of the file. Memory grows with items that are there, not with promised ones.
    fn fill<R: Row>(&self, mut items: impl Iterator<Item = io::Result<R::Number>>) -> Result<Vec<R>, RaysError> {
        let (outer, inner) = match self.order {
            Order::C => (self.rows, self.columns),
            Order::Fortran => (self.columns, self.rows),
        };
        let promised = self.rows * self.columns;
        let mut rays = Vec::new();
        for i in 0..outer {
            for j in 0..inner {
                let item = match items.next() {
                    Some(Err(error)) if error.kind() != ErrorKind::UnexpectedEof => return Err(error.into()),
                    Some(Ok(item)) => item,
                    _ => return Err(RaysError::Truncated { read: i * inner + j, promised }),
                };
                let (row, column) = match self.order {
                    Order::C => (i as usize, j as usize),
                    Order::Fortran => (j as usize, i as usize),
                };
                if row == rays.len() {
                    rays.push(R::BLANK);
                }
                rays[row].set(column, item);
            }
        }
        Ok(rays)
    }
}

/// Reads as far as the first item.
fn read_header(reader: &mut impl Read) -> Result<NpyHeader, RaysError> {
    let wrong = |message: &str| RaysError::NpyHeader { message: message.to_owned() };
    let mut bytes = vec![0; 10];
    let mut append = |bytes: &mut Vec<u8>, from: usize| {
        reader.read_exact(&mut bytes[from..]).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => wrong("the header is cut"),
            _ => error.into(),
        })
    };
    append(&mut bytes, 0)?;
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err(wrong("it does not start as one"));
    }
    let mut length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    if bytes[6] > 1 {
        bytes.resize(12, 0);
        append(&mut bytes, 10)?;
        length += usize::from(u16::from_le_bytes([bytes[10], bytes[11]])) << 16;
    }
    if length > HEADER_BYTES {
        return Err(wrong("the header is too long"));
    }
    let start = bytes.len();
    bytes.resize(start + length, 0);
    append(&mut bytes, start)?;
    let text = &bytes[start..];
    let brackets = text.iter().filter(|byte| b"([{".contains(byte)).count();
    let digits = text.iter().filter(|byte| byte.is_ascii_digit()).count();
    // Digits that are letters.
    let is_hexadecimal = text.windows(2).any(|pair| pair.eq_ignore_ascii_case(b"0x"));
    if brackets > HEADER_BRACKETS || digits > HEADER_DIGITS || is_hexadecimal {
        return Err(wrong("the header describes something else than a table of numbers"));
    }
    NpyHeader::from_reader(bytes.as_slice()).map_err(|error| {
        let message: String = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        RaysError::NpyHeader { message: message.chars().take(MESSAGE_CHARACTERS).collect() }
    })
}

/// How much of the parser's message is passed on: it quotes the header.
const MESSAGE_CHARACTERS: usize = 200;
