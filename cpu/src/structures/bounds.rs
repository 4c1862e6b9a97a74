//! `Bounds`: boxes along the axes.

use glam::Vec3;

use super::line::Line;

/// A box, its sides included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner of the least coordinates.
    pub lower: Vec3,
    /// The corner of the largest coordinates.
    pub upper: Vec3,
}

impl Bounds {
    /// What holds nothing; joined with another box it is that box.
    pub const EMPTY: Self = Self { lower: Vec3::INFINITY, upper: Vec3::NEG_INFINITY };

    /// The smallest box around some points.
    pub fn around(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |bounds, point| Self {
            lower: bounds.lower.min(*point),
            upper: bounds.upper.max(*point),
        })
    }

    /// The smallest box around two boxes.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    /// What two boxes share.
    #[must_use]
    pub fn meet(self, other: Self) -> Self {
        Self { lower: self.lower.max(other.lower), upper: self.upper.min(other.upper) }
    }

    /// The box with all sides moved outwards.
    #[must_use]
    pub fn dilated(self, margin: f32) -> Self {
        Self { lower: self.lower - margin, upper: self.upper + margin }
    }

    /// Whether there is no point in it.
    pub fn is_empty(&self) -> bool {
        self.lower.cmpgt(self.upper).any()
    }

    /// Its middle.
    pub fn centre(&self) -> Vec3 {
        0.5 * self.lower + 0.5 * self.upper
    }

    /// The lengths of its sides.
    pub fn extent(&self) -> Vec3 {
        self.upper - self.lower
    }

    /// Half of its surface; 0 if it is empty.
    pub fn area(&self) -> f32 {
        let e = self.extent().max(Vec3::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The part of a line between two distances that lies inside: its start, and its end; nothing of it does where the
    /// start lies beyond the end.
    ///
    /// Where a line runs in the plane of a side, 0 times infinity makes a NaN, which `min` and `max` pass over: the line
    /// counts as inside (A. Williams and others, "An Efficient and Robust Ray-Box Intersection Algorithm", 2005).
    #[inline]
    pub fn clip(&self, line: &Line, first: f32, last: f32) -> (f32, f32) {
        let a = (self.lower - line.origin) * line.inverse;
        let b = (self.upper - line.origin) * line.inverse;
        let mut part = (first, last);
        for k in 0..3 {
            // f32's own min and max leave a NaN out, whichever side it is on.
            part.0 = part.0.max(a[k].min(b[k]));
            part.1 = part.1.min(a[k].max(b[k]));
        }
        part
    }
}
