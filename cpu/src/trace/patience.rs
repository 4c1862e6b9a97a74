//! `Patience`: how often to try a way that failed.

/// After n failures in a row, every 4^n-th chance is taken.
pub(crate) struct Patience {
    /// Failures in a row.
    failures: u32,
    /// Chances since the last try.
    skipped: u32,
}

impl Patience {
    pub(crate) const fn new() -> Self {
        Self { failures: 0, skipped: 0 }
    }

    /// Whether this chance is worth a try: fewer and fewer are.
    #[inline(always)]
    pub(crate) fn tries(&mut self) -> bool {
        self.skipped += 1;
        self.skipped >> (2 * self.failures).min(16) > 0
    }

    #[inline(always)]
    pub(crate) fn learns(&mut self, is_success: bool) {
        self.failures = if is_success { 0 } else { self.failures + 1 };
        self.skipped = 0;
    }
}
