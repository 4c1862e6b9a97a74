//! A text that another library parses, rewritten line by line on its way there.

use std::io::{self, BufRead, Read};

use super::MeshError;
use super::source::Source;

/// How the next line is taken from a source.
type Next = fn(&mut Source, &mut Vec<u8>) -> Result<bool, MeshError>;

/// The lines of a source, each replaced by what `rewrite` writes for it. Not more than one line is read ahead of the
/// parser, so the source's line number is that of the line being parsed.
pub(super) struct Lines<'a, F> {
    source: &'a mut Source,
    next: Next,
    rewrite: F,
    line: Vec<u8>,
    text: String,
    parsed: usize,
    failure: Option<MeshError>,
}

impl<'a, F> Lines<'a, F>
where
    F: FnMut(&Source, &str, &mut String) -> Result<(), MeshError>,
{
    pub(super) fn new(source: &'a mut Source, next: Next, rewrite: F) -> Self {
        Self { source, next, rewrite, line: Vec::new(), text: String::new(), parsed: 0, failure: None }
    }

    /// Why the text ended early; if it did not, what the parser made of the line it stopped at.
    pub(super) fn into_error(self, message: impl Into<String>) -> MeshError {
        self.failure.unwrap_or_else(|| self.source.syntax(message))
    }

    /// Fills `text` anew; leaves it empty at the end of the source.
    fn refill(&mut self) -> Result<(), MeshError> {
        self.text.clear();
        self.parsed = 0;
        while self.text.is_empty() && (self.next)(self.source, &mut self.line)? {
            (self.rewrite)(self.source, &String::from_utf8_lossy(&self.line), &mut self.text)?;
        }
        Ok(())
    }
}

impl<F> BufRead for Lines<'_, F>
where
    F: FnMut(&Source, &str, &mut String) -> Result<(), MeshError>,
{
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.parsed == self.text.len()
            && let Err(failure) = self.refill()
        {
            self.failure = Some(failure);
            return Err(io::ErrorKind::InvalidData.into());
        }
        Ok(&self.text.as_bytes()[self.parsed..])
    }

    fn consume(&mut self, bytes: usize) {
        self.parsed += bytes;
    }
}

impl<F> Read for Lines<'_, F>
where
    F: FnMut(&Source, &str, &mut String) -> Result<(), MeshError>,
{
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(buffer)?;
        self.consume(read);
        Ok(read)
    }
}
