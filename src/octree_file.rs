//! Files of octrees, which hold the octree's words in little-endian order.

use core::fmt;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use crate::output_file::OutputFile;
use crate::wire::PREAMBLE_WORDS;
use crate::{DecodeError, Octree};

/// How many words are read or written at a time: 1 MiB of them.
const CHUNK_WORDS: usize = 1 << 18;

/// Why an octree was not read from a file, or not written to one.
#[derive(Debug)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be opened, read or written.
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// What the file holds is no octree.
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: DecodeError,
    },
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Decode { path, source } => write!(f, "{}: {source}", path.display()),
        }
    }
}

impl core::error::Error for FileError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Decode { source, .. } => Some(source),
        }
    }
}

/// Reads an octree from a file and validates it, on a machine of either byte order.
///
/// # Errors
/// [`FileError`]. Not more is read than the file's first words announce, so a file that is something else, however
/// large, costs neither time nor memory.
pub fn load_octree(path: impl AsRef<Path>) -> Result<Octree<Vec<u32>>, FileError> {
    let path = path.as_ref();
    let io_error = |source| FileError::Io { path: path.to_owned(), source };
    let decode_error = |source| FileError::Decode { path: path.to_owned(), source };
    let mut file = File::open(path).map_err(io_error)?;
    let mut words = Vec::new();
    let mut bytes = read_words(&mut file, &mut words, PREAMBLE_WORDS).map_err(io_error)?;
    if words.len() == PREAMBLE_WORDS {
        // The preamble alone is an octree cut short: decoding it tells what the rest should be.
        if let Err(error) = Octree::from_words(words.as_slice()) {
            let DecodeError::Truncated { needed, .. } = error else { return Err(decode_error(error)) };
            // A word more than that shows that something was appended.
            bytes += read_words(&mut file, &mut words, needed.saturating_add(1)).map_err(io_error)?;
        }
    }
    if !bytes.is_multiple_of(size_of::<u32>()) {
        return Err(decode_error(DecodeError::Ragged { bytes }));
    }
    Octree::from_words(words).map_err(decode_error)
}

/// Appends little-endian words until there are `most` or the file ends, and returns the bytes read, of which up to
/// three at the file's end make no word.
fn read_words(file: &mut File, words: &mut Vec<u32>, most: usize) -> io::Result<usize> {
    let mut bytes = 0;
    while words.len() < most {
        let start = words.len();
        let chunk = CHUNK_WORDS.min(most - start);
        words.try_reserve(chunk).map_err(|_| ErrorKind::OutOfMemory)?;
        words.resize(start + chunk, 0);
        let read = read_full(file, bytemuck::cast_slice_mut(&mut words[start..]))?;
        words.truncate(start + read / size_of::<u32>());
        words[start..].iter_mut().for_each(|word| *word = u32::from_le(*word));
        bytes += read;
        if read < chunk * size_of::<u32>() {
            break;
        }
    }
    Ok(bytes)
}

/// Reads until the buffer is full or the file ends.
fn read_full(file: &mut File, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match file.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(read) => filled += read,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

/// Writes an octree to a file, which appears whole or not at all: a failure leaves what was there before.
///
/// # Errors
/// [`FileError::Io`].
pub fn save_octree<W: AsRef<[u32]>>(octree: &Octree<W>, path: impl AsRef<Path>) -> Result<(), FileError> {
    let path = path.as_ref();
    let written = OutputFile::create(path).and_then(|mut file| {
        file.write(|writer| write_octree(octree, writer))?;
        file.commit()
    });
    written.map_err(|source| FileError::Io { path: path.to_owned(), source })
}

/// Writes the bytes of an octree's file, for those who keep them elsewhere than in a file.
///
/// # Errors
/// The errors of the writer.
pub fn write_octree<W: AsRef<[u32]>>(octree: &Octree<W>, mut writer: impl Write) -> io::Result<()> {
    let mut chunk = Vec::new();
    octree.as_words().chunks(CHUNK_WORDS).try_for_each(|words| {
        chunk.clear();
        chunk.extend(words.iter().map(|word| word.to_le()));
        writer.write_all(bytemuck::cast_slice(&chunk))
    })
}
