//! Rays on their way to be traced one by one.

use leafwalk_core::layout::LatticeBox;
use leafwalk_core::{Frame, Ray};

use crate::hierarchy::{Hierarchy, Source};
use crate::lanes::Eight;
use crate::prepare::Prepared;
use crate::ready::Ready;

/// Rays that are not traced yet.
pub(crate) struct Waiting<'a> {
    frame: &'a Frame,
    hull: LatticeBox,
    rays: &'a [Ray],
    /// The first ray that is not prepared.
    next: usize,
    prepared: Prepared,
}

impl<'a> Waiting<'a> {
    #[inline(always)]
    pub(crate) fn new<B: Source>(hierarchy: &'a Hierarchy<'_, B>, rays: &'a [Ray]) -> Self {
        Self { frame: &hierarchy.frame, hull: hierarchy.hull(), rays, next: 0, prepared: Prepared::none() }
    }

    /// The next ray that can hit anything, with its place among all.
    #[inline(always)]
    pub(crate) fn take<L: Eight>(&mut self) -> Option<(usize, Ready<L>)> {
        loop {
            if let Some((lane, ready)) = self.prepared.take() {
                return Some((self.next - 8 + lane, ready));
            }
            if self.next >= self.rays.len() {
                return None;
            }
            let end = self.rays.len().min(self.next + 8);
            self.prepared = Prepared::of::<L>(self.frame, &self.rays[self.next..end]);
            self.prepared.drop_beyond::<L>(&self.hull);
            self.next += 8;
        }
    }
}
