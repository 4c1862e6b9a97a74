//! Boxes along the axes as bounding volumes.

use glam::Vec3;

use super::volume::Volume;
use crate::structures::bounds::Bounds;
use crate::structures::line::Line;

impl Volume for Bounds {
    const EMPTY: Self = Self::EMPTY;
    const MARGINS: f32 = 1.0;
    type Probe = Line;

    fn around(points: &[Vec3], margin: f32) -> Self {
        Bounds::around(points).dilated(margin)
    }

    fn join(&self, other: &Self) -> Option<Self> {
        Some(Bounds::join(*self, *other))
    }

    fn probe(line: &Line) -> Line {
        *line
    }

    #[inline]
    fn entry(&self, line: &Line, first: f32, last: f32) -> Option<f32> {
        let (entry, exit) = self.clip(line, first, last);
        (entry <= exit).then_some(entry)
    }
}
