//! Progress and cancellation.

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use super::error::BuildError;

/// How far a build has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Work done, 0 to 1; never decreases.
    pub fraction: f32,
}

/// Passes progress on to the caller, and remembers a request to stop.
pub(crate) struct Monitor<'a> {
    callback: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync),
    /// The part of the build under way, as fractions of the whole.
    from: f32,
    to: f32,
    /// The bits of the fraction reported last; those of numbers that are not negative keep their order.
    reached: AtomicU32,
    cancelled: AtomicBool,
}

impl<'a> Monitor<'a> {
    pub(crate) fn new(callback: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync)) -> Self {
        Self { callback, from: 0.0, to: 1.0, reached: AtomicU32::new(0), cancelled: AtomicBool::new(false) }
    }

    /// The same callback for a part of the build.
    pub(crate) fn part(&self, from: f32, to: f32) -> Self {
        Self { from, to, ..Self::new(self.callback) }
    }

    /// Reports a fraction of this part; an estimate that falls back counts as no progress.
    pub(crate) fn check(&self, fraction: f32) -> Result<(), BuildError> {
        let fraction = self.from + (self.to - self.from) * fraction.clamp(0.0, 1.0);
        let before = f32::from_bits(self.reached.fetch_max(fraction.to_bits(), Ordering::Relaxed));
        if (self.callback)(Progress { fraction: fraction.max(before) }).is_break() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        self.check_cancelled()
    }

    /// Whether an earlier report was answered with a stop.
    pub(crate) fn check_cancelled(&self) -> Result<(), BuildError> {
        if self.cancelled.load(Ordering::Relaxed) { Err(BuildError::Cancelled) } else { Ok(()) }
    }
}
