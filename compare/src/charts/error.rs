//! Why a chart was not drawn.

use core::error::Error;
use core::fmt;

/// What the drawing library says.
#[derive(Debug)]
pub struct ChartError(String);

impl ChartError {
    pub(super) fn new(error: impl fmt::Display) -> Self {
        Self(error.to_string())
    }
}

impl fmt::Display for ChartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the chart can't be drawn: {}", self.0)
    }
}

impl Error for ChartError {}
