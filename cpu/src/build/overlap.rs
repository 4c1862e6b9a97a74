//! Conservative triangle/cell tests: which children of a cell a triangle is listed in.

use glam::DVec3;
use leafwalk_core::layout::{Key, LATTICE_STEP};

/// Relative slack of a separating-axis test. The projected half extent of a dilated cell is at least 2^-19 times the
/// axis, and the rounding of the projected corners at most 2^-50 times it: 2^-31, doubled.
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
    pub(crate) fn new(corners: &[[f32; 3]; 3]) -> Self {
        let corners = corners.map(|c| DVec3::from_array(c.map(f64::from)));
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let normal = edges[0].cross(edges[1]);
        let normal_error = NORMAL_ROUNDING * edges[0].abs().max_element() * edges[1].abs().max_element();
        Self { corners, edges, normal, normal_error }
    }

    /// Whether no edge cross axis and not the plane separates the triangle from a box. The box's own axes are the
    /// caller's to test; a triangle that touches passes.
    fn meets(&self, centre: DVec3, half: DVec3) -> bool {
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
    lower: [f32; 3],
    middle: [f32; 3],
    upper: [f32; 3],
    /// Half a cell's edge, which is a child's: exact.
    half: f32,
    padding: f32,
}

impl Split {
    pub(crate) fn new(cell: Key, padding: f32) -> Self {
        let (lower, upper) = cell.bounds();
        // All sums here are exact: multiples of 2^-19 below 2.
        let half = 0.5 * cell.size() as f32 * LATTICE_STEP;
        let outward = |upper: f32| upper + padding;
        Self {
            lower: lower.map(|c| c - padding),
            middle: lower.map(|c| c + half),
            upper: upper.map(outward),
            half,
            padding,
        }
    }

    /// Bit i: the triangle meets child i, dilated. The triangle must meet the dilated cell.
    #[inline]
    pub(crate) fn children_met(&self, corners: &[[f32; 3]; 3]) -> u8 {
        let (mut candidates, mut straddled, mut is_inside) = (0xff_u8, 0, true);
        for (k, in_upper) in UPPER.into_iter().enumerate() {
            let (low, high) = range(corners, k);
            let (is_low, is_high) = (low <= self.middle[k] + self.padding, high >= self.middle[k] - self.padding);
            candidates &= if is_low { 0xff } else { in_upper } & if is_high { 0xff } else { !in_upper };
            straddled += u32::from(is_low && is_high);
            is_inside &= low >= self.lower[k] && high <= self.upper[k];
        }
        // Inside the cell and across one plane only: a corner on either side proves both children.
        if straddled == 0 || (straddled == 1 && is_inside) {
            return candidates;
        }
        let triangle = Overlap::new(corners);
        let half = f64::from(self.half);
        let reach = DVec3::splat(0.5 * half + f64::from(self.padding));
        let centre = |child: u8| {
            let side = |k: usize| if UPPER[k] >> child & 1 == 1 { 0.5 * half } else { -0.5 * half };
            DVec3::from_array(self.middle.map(f64::from)) + DVec3::from_array([0, 1, 2].map(side))
        };
        let candidates = (0..8).filter(|child| candidates >> child & 1 == 1);
        candidates.fold(0, |met, child| met | u8::from(triangle.meets(centre(child), reach)) << child)
    }
}

/// Bit i of mask k: child i is in the upper half of axis k.
const UPPER: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

fn range(corners: &[[f32; 3]; 3], k: usize) -> (f32, f32) {
    let [a, b, c] = corners.map(|corner| corner[k]);
    (a.min(b).min(c), a.max(b).max(c))
}
