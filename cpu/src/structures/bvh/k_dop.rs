//! Discrete oriented polytopes as bounding volumes.

use glam::Vec3;

use super::volume::Volume;
use crate::structures::line::Line;

/// How many pairs of planes there are.
const PAIRS: usize = 7;

/// A polytope between pairs of planes of fixed directions, the axes and the diagonals of space: J. T. Klosowski and others,
/// "Efficient Collision Detection Using Bounding Volume Hierarchies of k-DOPs", 1998, with k = 14; the volumes of Kay and
/// Kajiya (1986) are the same thing.
#[derive(Clone, Copy, Debug)]
pub struct KDop {
    lower: [f32; PAIRS],
    upper: [f32; PAIRS],
}

/// A line as the directions see it.
#[derive(Clone, Copy)]
pub struct Probe {
    origin: [f32; PAIRS],
    inverse: [f32; PAIRS],
}

/// The coordinates of a point along all directions. Those of the diagonals are longer by the root of 3.
fn along([x, y, z]: [f32; 3]) -> [f32; PAIRS] {
    [x, y, z, x + y + z, x + y - z, x - y + z, x - y - z]
}

impl Volume for KDop {
    const EMPTY: Self = Self { lower: [f32::INFINITY; PAIRS], upper: [f32::NEG_INFINITY; PAIRS] };
    /// Along a diagonal, a margin counts times the root of 3, for which 2 stands. Two sums of three coordinates below two
    /// root edges, of the origin and of a corner, are off by 12 roundoffs of the edge each; that of the direction moves a
    /// point 3.5 edges away by 21; the slab test adds 12. One margin more is 120.
    const MARGINS: f32 = 3.0;
    type Probe = Probe;

    fn around(points: &[Vec3], margin: f32) -> Self {
        let mut hull = Self::EMPTY;
        for coordinates in points.iter().map(|point| along(point.to_array())) {
            for (k, c) in coordinates.into_iter().enumerate() {
                hull.lower[k] = hull.lower[k].min(c - margin);
                hull.upper[k] = hull.upper[k].max(c + margin);
            }
        }
        hull
    }

    fn join(&self, other: &Self) -> Option<Self> {
        Some(Self {
            lower: core::array::from_fn(|k| self.lower[k].min(other.lower[k])),
            upper: core::array::from_fn(|k| self.upper[k].max(other.upper[k])),
        })
    }

    fn probe(line: &Line) -> Probe {
        Probe { origin: along(line.origin.to_array()), inverse: along(line.direction.to_array()).map(f32::recip) }
    }

    #[inline]
    fn entry(&self, probe: &Probe, first: f32, last: f32) -> Option<f32> {
        let (mut entry, mut exit) = (first, last);
        for k in 0..PAIRS {
            let a = (self.lower[k] - probe.origin[k]) * probe.inverse[k];
            let b = (self.upper[k] - probe.origin[k]) * probe.inverse[k];
            // f32's own min and max leave out the NaN of a line in a plane.
            entry = entry.max(a.min(b));
            exit = exit.min(a.max(b));
        }
        (entry <= exit).then_some(entry)
    }
}
