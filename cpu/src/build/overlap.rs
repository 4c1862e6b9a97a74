//! Conservative triangle/cell tests: which children of a cell a triangle is listed in.

use glam::DVec3;
use leafwalk_core::Frame;
use leafwalk_core::layout::Key;
use wide::f32x4;

use super::span::{Span, axes, lanes};

/// Relative slack of a separating-axis test. The projected half extent of a dilated cell is at least 2^-19 root edges times
/// the axis, and the rounding of the projected corners at most 2^-50 root edges times it: 2^-31, doubled.
const SLACK: f64 = 1.0 + 1.0 / (1u64 << 30) as f64;
/// Rounding of the normal of a needle, which the relative slack does not cover: 2^-50 of its edges' product, doubled
/// twice for the projections.
const NORMAL_ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// A triangle with what all its tests share.
pub(crate) struct Overlap {
    corners: [DVec3; 3],
    edges: [DVec3; 3],
    normal: DVec3,
    normal_error: f64,
}

impl Overlap {
    /// Prepares the tests of a triangle, given its corners in lattice coordinates and where the root's corner is.
    pub(crate) fn new(corners: &[[f32; 3]; 3], root: DVec3) -> Self {
        let corners = corners.map(|c| DVec3::from_array(c.map(f64::from)) - root);
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let normal = edges[0].cross(edges[1]);
        let normal_error = NORMAL_ROUNDING * edges[0].abs().max_element() * edges[1].abs().max_element();
        Self { corners, edges, normal, normal_error }
    }

    /// Whether no edge cross axis and not the plane separates the triangle from a box. The box's own axes are the
    /// caller's to test; a triangle that touches passes.
    pub(crate) fn meets(&self, centre: DVec3, half: DVec3) -> bool {
        let [a, b, c] = self.corners.map(|corner| corner - centre);
        let reach = half.dot(self.normal.abs()) * SLACK + self.normal_error;
        if self.normal.dot(a).abs() > reach {
            return false;
        }
        // An edge crossed with an axis: both its ends project to the same place, so two corners decide.
        let ends = [(a, c), (b, a), (c, b)];
        self.edges.iter().zip(ends).all(|(e, (p, q))| {
            let size = e.abs();
            let separates = |p: f64, q: f64, reach: f64| p.min(q) > reach * SLACK || p.max(q) < -reach * SLACK;
            !separates(e.z * p.y - e.y * p.z, e.z * q.y - e.y * q.z, half.y * size.z + half.z * size.y)
                && !separates(e.x * p.z - e.z * p.x, e.x * q.z - e.z * q.x, half.z * size.x + half.x * size.z)
                && !separates(e.y * p.x - e.x * p.y, e.y * q.x - e.x * q.y, half.x * size.y + half.y * size.x)
        })
    }
}

/// A cell about to be split: its planes, dilated by the padding.
pub(crate) struct Split {
    /// The root's corner.
    root: [f32; 3],
    dilated: Span,
    /// Where the lower children end.
    below: f32x4,
    /// Where the upper children begin.
    above: f32x4,
    middle: DVec3,
    /// A quarter of the cell's edge: from its middle to those of its children.
    quarter: f64,
    /// From the middle of a child to its sides, dilated.
    reach: DVec3,
}

impl Split {
    pub(crate) fn new(frame: &Frame, cell: Key, padding: f32) -> Self {
        let (lower, upper) = cell.bounds();
        // All sums here are exact: multiples of an eighth of a root edge's roundoff below two root edges.
        let half = 0.5 * cell.size() as f32;
        let middle = lower.map(|c| c + half);
        let quarter = 0.5 * f64::from(half);
        Self {
            root: frame.corner,
            dilated: Span::new(lower.map(|c| c - padding), upper.map(|c| c + padding)),
            below: lanes(middle.map(|c| c + padding)),
            above: lanes(middle.map(|c| c - padding)),
            middle: DVec3::from_array(middle.map(f64::from)),
            quarter,
            reach: DVec3::splat(quarter + f64::from(padding)),
        }
    }

    /// Bit i: the triangle meets child i, dilated. The triangle must meet the dilated cell.
    #[inline]
    pub(crate) fn children_met(&self, corners: &[[f32; 3]; 3]) -> u8 {
        let whole = Span::around(corners, lanes(self.root));
        let (is_low, is_high) = self.halves(whole);
        let candidates = BELOW[is_low] & ABOVE[is_high];
        let straddled = (is_low & is_high).count_ones();
        // Inside the cell and across one plane only: a corner on either side proves both children.
        if straddled == 0 || (straddled == 1 && self.dilated.holds(&whole)) {
            return candidates;
        }
        self.children_among(candidates, corners)
    }

    /// The axes along which something reaches into the lower half, and into the upper one.
    #[inline]
    fn halves(&self, span: Span) -> (usize, usize) {
        (axes(span.lower.simd_le(self.below)), axes(span.upper.simd_ge(self.above)))
    }

    /// The children among some candidates that the triangle meets.
    #[inline(never)]
    fn children_among(&self, candidates: u8, corners: &[[f32; 3]; 3]) -> u8 {
        // Children that hold a corner need no proof.
        let root = lanes(self.root);
        let points = corners.map(|corner| lanes(corner) - root).map(|corner| Span { lower: corner, upper: corner });
        let met = points.into_iter().filter(|point| self.dilated.holds(point)).fold(0, |met, point| {
            let (is_low, is_high) = self.halves(point);
            met | BELOW[is_low] & ABOVE[is_high]
        });
        if met == candidates {
            return met;
        }
        let triangle = Overlap::new(corners, DVec3::from_array(self.root.map(f64::from)));
        let centre = |child: u8| {
            let side = |k: usize| if UPPER[k] >> child & 1 == 1 { self.quarter } else { -self.quarter };
            self.middle + DVec3::new(side(0), side(1), side(2))
        };
        let left = (0..8).filter(|child| (candidates & !met) >> child & 1 == 1);
        left.fold(met, |met, child| met | u8::from(triangle.meets(centre(child), self.reach)) << child)
    }
}

/// Bit i of mask k: child i is in the upper half of axis k.
const UPPER: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];
/// By the axes along which something reaches into the lower half: the children that it may meet.
const BELOW: [u8; 8] = but_for(UPPER);
/// By the axes along which something reaches into the upper half: the children that it may meet.
const ABOVE: [u8; 8] = but_for([!UPPER[0], !UPPER[1], !UPPER[2]]);

/// Entry i: the children that are, along every axis whose bit in i is clear, in the other half.
const fn but_for(other: [u8; 3]) -> [u8; 8] {
    let mut children = [0xff; 8];
    let mut at = 0;
    while at < 3 * 8 {
        let (reaches, k) = (at / 3, at % 3);
        if reaches >> k & 1 == 0 {
            children[reaches] &= other[k];
        }
        at += 1;
    }
    children
}
