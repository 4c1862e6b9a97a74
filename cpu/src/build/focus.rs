//! The focus of a mesh: where most of its vertices lie close together.

use rayon::prelude::*;

/// On each axis the shortest interval that holds half of the points, lower ends first.
///
/// Rounding moves a vertex by a share of its distance from the frame's anchor. So a mesh that has to be rounded has its
/// anchor where its detail is, be that far from 0 or small in wide surroundings.
pub(super) fn focus(points: impl Iterator<Item = [f64; 3]> + Clone) -> [[f64; 3]; 2] {
    let mut sorted = Vec::new();
    let mut focus = [[0.0; 3]; 2];
    for k in 0..3 {
        sorted.clear();
        sorted.extend(points.clone().map(|point| point[k]));
        sorted.par_sort_unstable_by(f64::total_cmp);
        let intervals = sorted.iter().zip(&sorted[sorted.len() / 2..]);
        if let Some((lower, upper)) = intervals.min_by(|(a, b), (c, d)| (*b - *a).total_cmp(&(*d - *c))) {
            [focus[0][k], focus[1][k]] = [*lower, *upper];
        }
    }
    focus
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_points_are_the_focus() {
        let points = [[9.0, -2.0, 5.0], [1.0, 7.0, 5.0], [2.0, 7.5, 5.0], [0.5, 8.0, 5.0], [-40.0, 1e9, 5.0]];
        assert_eq!(focus(points.into_iter()), [[0.5, 7.0, 5.0], [2.0, 8.0, 5.0]]);
        assert_eq!(focus(points.into_iter().take(1)), [points[0]; 2]);
    }
}
