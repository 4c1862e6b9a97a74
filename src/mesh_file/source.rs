//! The bytes of a mesh file, unzipped, counted against the limits, and cut into lines.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Chain, Cursor, ErrorKind, Read};
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;

use super::{Limits, MeshError};

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];
const BUFFER_BYTES: usize = 64 << 10;
/// How many first bytes tell text from binary: a binary STL's header and its first triangles.
const HEAD_BYTES: u64 = 1 << 10;

/// Whether the name ends in `.gz`.
pub(super) fn is_named_gzip(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"))
}

/// A file opened for reading under [`Limits`]. Reading through a library that drops errors loses nothing: the cause
/// stays here until [`Source::failure`] takes it.
pub(super) struct Source {
    path: PathBuf,
    limits: Limits,
    head: Vec<u8>,
    bytes: BufReader<Chain<Cursor<Vec<u8>>, Bounded>>,
    line: u64,
}

impl Source {
    /// Opens a file. It is unzipped if its first bytes or its name say that it is gzip.
    pub(super) fn open(path: &Path, limits: &Limits) -> Result<Self, MeshError> {
        let path = path.to_owned();
        let opened = File::open(&path).and_then(|file| {
            let mut file = BufReader::with_capacity(BUFFER_BYTES, file);
            let gzip = file.fill_buf()?.starts_with(&GZIP_MAGIC) || is_named_gzip(&path);
            Ok((file, gzip))
        });
        let (file, gzip) = match opened {
            Ok(opened) => opened,
            Err(source) => return Err(MeshError::Io { path, source }),
        };
        let stream: Box<dyn Read> = if gzip { Box::new(MultiGzDecoder::new(file)) } else { Box::new(file) };
        let mut bytes = Bounded { stream, gzip, limit: limits.max_bytes, left: limits.max_bytes, failure: None };
        let mut head = Vec::new();
        if let Err(source) = bytes.by_ref().take(HEAD_BYTES).read_to_end(&mut head) {
            return Err(bytes.failure(&path).unwrap_or(MeshError::Io { path, source }));
        }
        if gzip && head.starts_with(&GZIP_MAGIC) {
            return Err(MeshError::NestedGzip { path });
        }
        let bytes = BufReader::with_capacity(BUFFER_BYTES, Cursor::new(head.clone()).chain(bytes));
        Ok(Self { path, limits: *limits, head, bytes, line: 0 })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The number of the line read last, from 1.
    pub(super) fn line(&self) -> u64 {
        self.line
    }

    /// The first bytes of the file, without a byte order mark; reading has not moved past them.
    pub(super) fn head(&self) -> &[u8] {
        self.head.strip_prefix(&BYTE_ORDER_MARK).unwrap_or(&self.head)
    }

    /// Why reading failed, if it did.
    pub(super) fn failure(&mut self) -> Option<MeshError> {
        self.bytes.get_mut().get_mut().1.failure(&self.path)
    }

    /// An error in the line read last.
    pub(super) fn syntax(&self, message: impl Into<String>) -> MeshError {
        MeshError::Syntax { path: self.path.clone(), line: self.line, message: message.into() }
    }

    /// The error for a read that did not succeed.
    pub(super) fn read_error(&mut self, source: io::Error) -> MeshError {
        self.failure().unwrap_or_else(|| MeshError::Io { path: self.path.clone(), source })
    }

    /// Reads what is left and makes nothing of it: only its end proves the checksum of a gzip file.
    pub(super) fn finish(&mut self) -> Result<(), MeshError> {
        io::copy(self, &mut io::sink()).map(drop).map_err(|error| self.read_error(error))
    }

    fn line_too_long(&self) -> MeshError {
        MeshError::LineTooLong { path: self.path.clone(), line: self.line, limit: self.limits.max_line }
    }

    /// Replaces `line` by the next one, without its end; false at the end of the file.
    pub(super) fn next_line(&mut self, line: &mut Vec<u8>) -> Result<bool, MeshError> {
        line.clear();
        let longest = self.limits.max_line as u64;
        let read = match (&mut self.bytes).take(longest.saturating_add(1)).read_until(b'\n', line) {
            Ok(read) => read,
            Err(source) => return Err(self.read_error(source)),
        };
        if read == 0 {
            return Ok(false);
        }
        self.line += 1;
        if read as u64 > longest {
            return Err(self.line_too_long());
        }
        line.truncate(line.trim_ascii_end().len());
        if self.line == 1 && line.starts_with(&BYTE_ORDER_MARK) {
            line.drain(..BYTE_ORDER_MARK.len());
        }
        // A zero byte, as a carriage return, would hide what follows it from a reader of lines.
        if line.contains(&0) {
            return Err(self.syntax("a zero byte: this is no text"));
        }
        if line.contains(&b'\r') {
            return Err(self.syntax("a carriage return within the line: end lines by a line feed"));
        }
        Ok(true)
    }

    /// The next line as [`Source::next_line`], joined with the lines that a backslash at its end continues it by.
    pub(super) fn next_joined_line(&mut self, line: &mut Vec<u8>) -> Result<bool, MeshError> {
        if !self.next_line(line)? {
            return Ok(false);
        }
        let comment = line.trim_ascii_start().starts_with(b"#");
        let mut next = Vec::new();
        while !comment && line.last() == Some(&b'\\') {
            line.pop();
            line.push(b' ');
            if !self.next_line(&mut next)? {
                break;
            }
            line.extend_from_slice(&next);
            if line.len() > self.limits.max_line {
                return Err(self.line_too_long());
            }
        }
        Ok(true)
    }
}

impl Read for Source {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.bytes.read(buffer)
    }

    fn read_exact(&mut self, buffer: &mut [u8]) -> io::Result<()> {
        self.bytes.read_exact(buffer)
    }
}

/// A stream that fails after so many bytes, and remembers why it failed.
struct Bounded {
    stream: Box<dyn Read>,
    gzip: bool,
    limit: u64,
    left: u64,
    failure: Option<Failure>,
}

enum Failure {
    Limit,
    Stream(io::Error),
}

impl Bounded {
    fn failure(&mut self, path: &Path) -> Option<MeshError> {
        let path = path.to_owned();
        Some(match self.failure.take()? {
            Failure::Limit => MeshError::TooManyBytes { path, limit: self.limit },
            Failure::Stream(source) if self.gzip => MeshError::Gzip { path, source },
            Failure::Stream(source) => MeshError::Io { path, source },
        })
    }
}

impl Read for Bounded {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // One byte more than is left tells a file that ends at the limit from one that goes on.
        let room = usize::try_from(self.left.saturating_add(1)).unwrap_or(usize::MAX).min(buffer.len());
        let read = match self.stream.read(&mut buffer[..room]) {
            Ok(read) => read,
            Err(error) if error.kind() == ErrorKind::Interrupted => return Err(error),
            Err(error) => {
                let kind = error.kind();
                self.failure = Some(Failure::Stream(error));
                return Err(kind.into());
            }
        };
        match self.left.checked_sub(read as u64) {
            Some(left) => self.left = left,
            None => {
                self.failure = Some(Failure::Limit);
                return Err(ErrorKind::FileTooLarge.into());
            }
        }
        Ok(read)
    }
}
