//! STL, text or binary. Corners at the same position, bit for bit, become one vertex.

use std::collections::HashMap;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};

use super::error::brief;
use super::lines::Lines;
use super::source::Source;
use super::{AnyMesh, MeshError, MeshFile};
use crate::Mesh;

/// A binary file's free text and count of triangles.
const HEADER_BYTES: usize = 84;
const COUNT_AT: usize = 80;
const TRIANGLE_BYTES: u64 = 50;

pub(super) fn read(mut source: Source) -> Result<MeshFile, MeshError> {
    // Binary files may begin with `solid` too, but have a zero byte in the count or the first triangles.
    let head = source.head();
    let text = head.trim_ascii_start().starts_with(b"solid") && !head.contains(&0);
    let soup = if text { read_text(&mut source) } else { read_binary(&mut source) }?;
    let count = soup.positions.len() as u64;
    if count > u64::from(u32::MAX) {
        return Err(MeshError::TooLarge { path: source.path().to_owned(), what: "vertices", count });
    }
    Ok(MeshFile { mesh: AnyMesh::F32(Mesh::new(soup.positions, soup.triangles)), ..MeshFile::default() })
}

fn read_text(source: &mut Source) -> Result<Soup, MeshError> {
    let path = source.path().to_owned();
    let (mut solid_open, mut facet_open) = (false, false);
    // stl_io wants a space after the first `solid` and stops at the first `endsolid`, even if solids follow. It also
    // refuses normals that are not finite; triangles without area have them, and nothing here reads normals.
    let mut lines = Lines::new(source, Source::next_line, |_, line, out| {
        match line.split_whitespace().next() {
            Some("solid") if !facet_open => solid_open = true,
            Some("endsolid") if !facet_open => solid_open = false,
            Some("facet") => {
                (solid_open, facet_open) = (true, true);
                out.push_str("facet normal 0 0 0\n");
            }
            first => {
                facet_open &= first != Some("endfacet");
                out.push_str(line);
                out.push('\n');
            }
        }
        Ok(())
    });
    let mut soup = Soup::default();
    let first_line = b"solid \n";
    match soup.read(first_line, first_line.chain(&mut lines)) {
        // No `endsolid` gets through, so the end of the file is the only end.
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => {}
        Err(error) => return Err(lines.into_error(brief(error))),
        Ok(()) => return Err(lines.into_error("the solid ends early")),
    }
    if solid_open {
        let read = soup.triangles.len() as u64;
        return Err(MeshError::Truncated { path, element: "facet".to_owned(), read, promised: None });
    }
    Ok(soup)
}

fn read_binary(source: &mut Source) -> Result<Soup, MeshError> {
    let path = source.path().to_owned();
    let mut header = [0; HEADER_BYTES];
    let mut soup = Soup::default();
    let truncated = |element: &str, read: usize, promised: u32| {
        let (path, element) = (path.clone(), element.to_owned());
        MeshError::Truncated { path, element, read: read as u64, promised: Some(promised.into()) }
    };
    if let Err(error) = source.read_exact(&mut header) {
        return Err(match error.kind() {
            ErrorKind::UnexpectedEof => source.failure().unwrap_or_else(|| truncated("header", 0, 1)),
            _ => source.read_error(error),
        });
    }
    let count = header[COUNT_AT..].iter().rev().fold(0, |count, &byte| count << 8 | u32::from(byte));
    let triangles = source.take(u64::from(count) * TRIANGLE_BYTES);
    if let Err(error) = soup.read(b"\n", header.chain(triangles)) {
        return Err(match error.kind() {
            ErrorKind::UnexpectedEof => {
                source.failure().unwrap_or_else(|| truncated("triangle", soup.triangles.len(), count))
            }
            _ => source.read_error(error),
        });
    }
    match source.read(&mut [0]) {
        Ok(0) => Ok(soup),
        Ok(_) => Err(MeshError::FalseCount { path, count: count.into() }),
        Err(error) => Err(source.read_error(error)),
    }
}

/// Triangles as an STL file lists them, each with its corners' positions, made to share vertices.
#[derive(Default)]
struct Soup {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    indices: HashMap<[u32; 3], u32>,
}

impl Soup {
    /// Adds the triangles of a stream that stl_io takes for text if `first_line` begins with `solid`.
    fn read(&mut self, first_line: &'static [u8], stream: impl Read) -> io::Result<()> {
        let mut stream = Probed { first_line, stream, probed: false };
        for triangle in stl_io::create_stl_reader(&mut stream)? {
            let triangle = triangle?.vertices.map(|vertex| self.index(vertex.0));
            self.triangles.push(triangle);
        }
        Ok(())
    }

    fn index(&mut self, position: [f32; 3]) -> u32 {
        *self.indices.entry(position.map(f32::to_bits)).or_insert_with(|| {
            self.positions.push(position);
            (self.positions.len() - 1) as u32
        })
    }
}

/// stl_io reads one line, as far as that may be, to tell text from binary, and seeks back to the start. Here it reads
/// the answer instead, so the stream need not seek.
struct Probed<R> {
    first_line: &'static [u8],
    stream: R,
    probed: bool,
}

impl<R: Read> Read for Probed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.probed { self.stream.read(buffer) } else { self.first_line.read(buffer) }
    }
}

impl<R> Seek for Probed<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Start(0) if !self.probed => {
                self.probed = true;
                Ok(0)
            }
            _ => Err(ErrorKind::Unsupported.into()),
        }
    }
}
