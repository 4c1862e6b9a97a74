//! One ray with what box and triangle tests want to know of it.

use leafwalk_core::boxes::Slabs;
use leafwalk_core::layout::LATTICE;
use leafwalk_core::step::inverse;
use leafwalk_core::triangle::{Shear, permutation};
use leafwalk_core::{CanonicalRay, Clock, Nearest, per_axis};

use crate::lanes::Eight;

/// A ray, ready to trace.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ready<L: Eight> {
    /// The same in every lane.
    pub(crate) slabs: Slabs<L>,
    pub(crate) order: L::Order,
    pub(crate) shear: Shear<f32>,
    pub(crate) axes: [usize; 3],
    /// Bit k: direction component k is negative.
    pub(crate) neg: u32,
    pub(crate) nearest: Nearest,
    pub(crate) clock: Clock,
}

impl<L: Eight> Ready<L> {
    /// A ray on its own.
    #[inline(always)]
    pub(crate) fn new(ray: &CanonicalRay) -> Self {
        let CanonicalRay { origin: o, direction: d, .. } = ray;
        let axes = permutation(*d);
        let [x, y, z] = axes;
        let steps = L::splat(LATTICE as f32);
        let slabs = Slabs::new(per_axis!(k => L::splat(o[k]) * steps), inverse(per_axis!(k => L::splat(d[k]) * steps)));
        // All of the shear's divisions in one.
        let numerators = L::load(&[d[x], d[y], 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let slope = (numerators / L::splat(d[z])).to_array();
        let neg = u32::from(d[0] < 0.0) | u32::from(d[1] < 0.0) << 1 | u32::from(d[2] < 0.0) << 2;
        Self {
            slabs,
            order: L::order(neg),
            shear: Shear { origin: [o[x], o[y], o[z]], slope: [slope[0], slope[1], slope[2]] },
            axes,
            neg,
            nearest: Nearest::new(ray),
            clock: ray.clock,
        }
    }
}
