//! What pictures need of vectors and colours beyond glam.

use glam::DVec3;

/// The point between two, `share_of_b` of the way from `a` to `b`.
pub(crate) fn mix(a: DVec3, b: DVec3, share_of_b: f64) -> DVec3 {
    a + (b - a) * share_of_b
}

/// The vector of length 1 in the same direction, `None` where there is no direction.
pub(crate) fn unit(vector: DVec3) -> Option<DVec3> {
    // Divided by the largest component first, so that squares neither overflow nor vanish.
    let largest = vector.abs().max_element();
    (largest > 0.0 && largest.is_finite()).then(|| (vector / largest).normalize())
}
