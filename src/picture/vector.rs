//! Two functions of vectors and colours that glam has in another form.
//!
//! Pictures must not change by a bit, so the operations stand here in the order in which they have always been done.

use glam::DVec3;

/// The point that lies `share_of_b` of the way from `a` to `b`. glam's `lerp` weighs both ends, which rounds otherwise.
pub(crate) fn mix(a: DVec3, b: DVec3, share_of_b: f64) -> DVec3 {
    a + (b - a) * share_of_b
}

/// The vector of length 1 in the same direction, or `None` where there is no direction.
pub(crate) fn unit(vector: DVec3) -> Option<DVec3> {
    // The vector is divided by its largest component first, so that squares neither overflow nor vanish, as they would
    // in glam's `try_normalize`.
    let largest = vector.abs().max_element();
    (largest > 0.0 && largest.is_finite()).then(|| (vector / largest).normalize())
}
