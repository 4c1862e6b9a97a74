//! The part of a triangle inside a box, as bounds.

use wide::f64x4;

use super::span::Span;

/// A triangle cut by six planes has at most nine corners.
const MOST_CORNERS: usize = 9;

/// Bounds of the part of a triangle inside a box (Sutherland & Hodgman 1974), or `None` where nothing is left; `whole` are
/// those of all of it. The fourth lane means nothing. Corners are in lattice coordinates; all else is seen from the root's
/// corner.
///
/// In f64: rounding moves a bound by under 2^-40 root edges, which the box margin covers many times over.
pub(super) fn clipped_bounds(
    corners: &[[f32; 3]; 3],
    root: [f32; 3],
    whole: &Span,
    to: &Span,
) -> Option<([f64; 4], [f64; 4])> {
    let (low, high) = (whole.lower.to_array(), whole.upper.to_array());
    let (lower, upper) = (to.lower.to_array(), to.upper.to_array());
    let (mut first, mut second) = (Polygon::EMPTY, Polygon::EMPTY);
    let (mut polygon, mut cut) = (&mut first, &mut second);
    for (corner, exact) in polygon.corners.iter_mut().zip(corners) {
        let [x, y, z] = core::array::from_fn(|k| f64::from(exact[k]) - f64::from(root[k]));
        *corner = [x, y, z, 0.0];
    }
    polygon.len = 3;
    for k in 0..3 {
        if low[k] < lower[k] {
            polygon.cut(k, lower[k].into(), 1.0, cut);
            core::mem::swap(&mut polygon, &mut cut);
        }
        if high[k] > upper[k] {
            polygon.cut(k, upper[k].into(), -1.0, cut);
            core::mem::swap(&mut polygon, &mut cut);
        }
    }
    let mut left = polygon.corners[..polygon.len].iter().map(|corner| f64x4::new(*corner));
    let first = left.next()?;
    let (low, high) = left.fold((first, first), |(low, high), p| (low.fast_min(p), high.fast_max(p)));
    Some((low.to_array(), high.to_array()))
}

struct Polygon {
    corners: [[f64; 4]; MOST_CORNERS + 1],
    len: usize,
}

impl Polygon {
    const EMPTY: Self = Self { corners: [[0.0; 4]; MOST_CORNERS + 1], len: 0 };

    fn push(&mut self, corner: [f64; 4]) {
        // Rounding can make a sliver cross a plane more often than twice; a corner too many adds nothing.
        if let Some(place) = self.corners.get_mut(self.len) {
            *place = corner;
            self.len += 1;
        }
    }

    /// Keeps what lies on the side of a plane where `sign * (coordinate k - at)` is not negative.
    fn cut(&self, k: usize, at: f64, sign: f64, kept: &mut Self) {
        kept.len = 0;
        let corners = &self.corners[..self.len];
        let Some(last) = corners.last() else { return };
        let inward = |corner: &[f64; 4]| sign * (corner[k] - at);
        let (mut a, mut da) = (last, inward(last));
        for b in corners {
            let db = inward(b);
            if (da < 0.0) != (db < 0.0) {
                let (from, to) = (f64x4::new(*a), f64x4::new(*b));
                let mut crossing = (from + (to - from) * f64x4::splat(da / (da - db))).to_array();
                crossing[k] = at;
                kept.push(crossing);
            }
            if db >= 0.0 {
                kept.push(*b);
            }
            (a, da) = (b, db);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::span::lanes;
    use super::*;

    fn clipped(corners: [[f32; 3]; 3], lower: [f32; 3], upper: [f32; 3]) -> Option<[[f64; 3]; 2]> {
        // The root's corner is somewhere, and the box is seen from there.
        let root = [3.0, -7.0, 0.0];
        let moved = corners.map(|corner| core::array::from_fn(|k| corner[k] + root[k]));
        let (low, high) = clipped_bounds(&moved, root, &Span::around(&moved, lanes(root)), &Span::new(lower, upper))?;
        Some([low, high].map(|[x, y, z, _]| [x, y, z]))
    }

    #[test]
    fn a_corner_is_cut_off() {
        let triangle = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]];
        let left = clipped(triangle, [0.75, 0.0, 0.0], [1.0, 1.0, 1.0]);
        assert_eq!(left, Some([[0.75, 0.0, 0.5], [1.0, 0.25, 0.5]]));
        assert_eq!(clipped(triangle, [0.75, 0.75, 0.0], [1.0, 1.0, 1.0]), None);
    }

    #[test]
    fn a_triangle_around_the_box_fills_it() {
        let triangle = [[-9.0, -9.0, 0.5], [9.0, -9.0, 0.5], [0.0, 9.0, 0.5]];
        assert_eq!(clipped(triangle, [0.0; 3], [1.0; 3]), Some([[0.0, 0.0, 0.5], [1.0, 1.0, 0.5]]));
    }
}
