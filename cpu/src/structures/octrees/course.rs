//! `Course`: when a line crosses the planes of an octree.

use glam::Vec3;

use super::cells::{Cell, Cells};
use crate::structures::Line;

/// A line turns by this, as a part of its direction, where it is parallel to an axis. What it strays from itself by
/// that is nothing beside the roundoff of f32; and it crosses the planes of the axis so long before or after all others
/// that no zero, infinity or NaN needs a thought. A line within a plane is on the lower side of it where t < 0.
const TURNED: f32 = 1.0 / (1u64 << 60) as f32;

/// The inverse of a direction, each component turned away from 0.
pub(super) fn inverse(line: &Line) -> Vec3 {
    let least = TURNED * line.direction.abs().max_element();
    Vec3::from_array(core::array::from_fn(|k| match line.direction[k] {
        d if d < 0.0 => 1.0 / d.min(-least),
        d => 1.0 / d.max(least),
    }))
}

/// The octant that a line comes from: bit k where it runs down along axis k.
pub(super) fn octant(line: &Line) -> u32 {
    (0..3).fold(0, |mirror, k| mirror | u32::from(line.direction[k] < 0.0) << k)
}

/// A line as it crosses the planes of an octree that was mirrored along the axes down which the line runs, so that it
/// comes to larger and larger coordinates only.
///
/// A plane is crossed when the line's equation says so, once, from the origin: nothing adds up on the way. What is
/// rounded is as if the plane lay elsewhere, in roundoffs of the root's edge: 2 for the plane itself, 2 for the root's
/// first one, 6 for when that is crossed (three roundings of up to two edges, between plane and origin), 3 for the way
/// from there and 2 for the sum. That makes 15; the margin has room for 67.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    /// Bit k: axis k is mirrored.
    pub(super) mirror: u32,
    /// When the line crosses the root's first planes.
    first: [f32; 3],
    /// How long it takes through a smallest cell.
    rate: [f32; 3],
}

impl Course {
    pub(super) fn new(cells: &Cells, line: &Line) -> Self {
        let (mirror, inverse) = (octant(line), inverse(line));
        let side = |k: usize| if mirror >> k & 1 == 0 { 0 } else { cells.count };
        Self {
            mirror,
            first: core::array::from_fn(|k| (cells.plane(k, side(k)) - line.origin[k]) * inverse[k]),
            rate: core::array::from_fn(|k| cells.step * inverse[k].abs()),
        }
    }

    /// When the line crosses a plane across an axis.
    #[inline]
    pub(super) fn crossing(&self, axis: usize, plane: u32) -> f32 {
        self.first[axis] + self.rate[axis] * plane as f32
    }

    /// When the line leaves a cell across each axis.
    #[inline]
    pub(super) fn exits(&self, cell: Cell) -> [f32; 3] {
        core::array::from_fn(|k| self.crossing(k, cell.corner[k] + cell.size))
    }

    /// When a search along the line begins in the root, if it meets it.
    pub(super) fn start(&self, line: &Line, root: Cell, margin: f32) -> Option<f32> {
        let earliest = |[a, b, c]: [f32; 3]| a.min(b.min(c));
        let latest = |[a, b, c]: [f32; 3]| a.max(b.max(c));
        let start = latest(self.first).max(line.t_min - margin);
        (start <= earliest(self.exits(root)).min(line.t_max + margin)).then_some(start)
    }

    /// Goes from a cell to the child in which the line is at some t: its octant.
    #[inline]
    pub(super) fn enter(&self, cell: &mut Cell, t: f32) -> u32 {
        cell.size /= 2;
        let mut octant = self.mirror;
        for k in 0..3 {
            let middle = cell.corner[k] + cell.size;
            let is_beyond = self.crossing(k, middle) <= t;
            cell.corner[k] = if is_beyond { middle } else { cell.corner[k] };
            octant ^= u32::from(is_beyond) << k;
        }
        octant
    }
}
