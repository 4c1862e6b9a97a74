//! The part of a triangle inside a box, as bounds.

use glam::DVec3;

/// A triangle cut by six planes has at most nine corners.
const MOST_CORNERS: usize = 9;

/// Bounds of the part of a triangle inside a box (Sutherland & Hodgman 1974), or `None` where nothing is left.
///
/// In f64: rounding moves a bound by under 2^-40, which the box margin covers many times over.
pub(crate) fn clipped_bounds(corners: &[[f32; 3]; 3], lower: [f32; 3], upper: [f32; 3]) -> Option<(DVec3, DVec3)> {
    let corners = corners.map(|c| DVec3::from_array(c.map(f64::from)));
    let (lower, upper) = (DVec3::from_array(lower.map(f64::from)), DVec3::from_array(upper.map(f64::from)));
    let bounds = |points: &[DVec3]| points.iter().fold((points[0], points[0]), |(a, b), p| (a.min(*p), b.max(*p)));
    let (low, high) = bounds(&corners);
    if low.cmpge(lower).all() && high.cmple(upper).all() {
        return Some((low, high));
    }
    let mut polygon = Polygon { corners: [DVec3::ZERO; MOST_CORNERS + 1], len: 3 };
    polygon.corners[..3].copy_from_slice(&corners);
    for k in 0..3 {
        if low[k] < lower[k] {
            polygon = polygon.cut(k, lower[k], 1.0);
        }
        if high[k] > upper[k] {
            polygon = polygon.cut(k, upper[k], -1.0);
        }
    }
    let left = &polygon.corners[..polygon.len];
    (!left.is_empty()).then(|| bounds(left))
}

#[derive(Clone, Copy)]
struct Polygon {
    corners: [DVec3; MOST_CORNERS + 1],
    len: usize,
}

impl Polygon {
    /// Keeps what lies on the side of a plane where `sign * (coordinate k - at)` is not negative.
    fn cut(&self, k: usize, at: f64, sign: f64) -> Self {
        let mut kept = Self { corners: [DVec3::ZERO; MOST_CORNERS + 1], len: 0 };
        let mut push = |corner| {
            // Rounding can make a sliver cross a plane more often than twice; a corner too many adds nothing.
            if kept.len < kept.corners.len() {
                kept.corners[kept.len] = corner;
                kept.len += 1;
            }
        };
        for i in 0..self.len {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.len]);
            let (da, db) = (sign * (a[k] - at), sign * (b[k] - at));
            if da >= 0.0 {
                push(a);
            }
            if (da < 0.0) != (db < 0.0) {
                let mut crossing = a + (b - a) * (da / (da - db));
                crossing[k] = at;
                push(crossing);
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_is_cut_off() {
        let triangle = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]];
        let (low, high) = clipped_bounds(&triangle, [0.75, 0.0, 0.0], [1.0, 1.0, 1.0]).unwrap();
        assert_eq!((low, high), (DVec3::new(0.75, 0.0, 0.5), DVec3::new(1.0, 0.25, 0.5)));
        assert_eq!(clipped_bounds(&triangle, [0.75, 0.75, 0.0], [1.0, 1.0, 1.0]), None);
    }

    #[test]
    fn a_triangle_around_the_box_fills_it() {
        let triangle = [[-9.0, -9.0, 0.5], [9.0, -9.0, 0.5], [0.0, 9.0, 0.5]];
        let (low, high) = clipped_bounds(&triangle, [0.0; 3], [1.0; 3]).unwrap();
        assert_eq!((low, high), (DVec3::new(0.0, 0.0, 0.5), DVec3::new(1.0, 1.0, 0.5)));
    }
}
