//! `Probe`: one ray with all that box and triangle tests want to know of it.

use leafwalk_core::slabs::Slabs;
use leafwalk_core::step::inverse;
use leafwalk_core::triangle::{Shear, permutation};
use leafwalk_core::{CanonicalRay, Clock, Nearest, unroll};

use crate::lanes::Eight;

/// A ray that goes on its own way, and its nearest hit so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe<L: Eight> {
    /// What boxes are tested with: the same in every lane, for eight boxes at a time.
    pub(crate) slabs: Slabs<L>,
    /// In which order the ray looks at the slots of BVH nodes.
    pub(crate) order: L::Order,
    /// Where t' is 0, in lattice coordinates.
    pub(crate) origin: [f32; 3],
    /// What triangles are tested with.
    pub(crate) shear: Shear<f32>,
    /// The axes in the order of the shear, the main one last.
    pub(crate) axes: [usize; 3],
    /// The octant of the direction: bit k is set where component k is negative.
    pub(crate) neg: u32,
    pub(crate) nearest: Nearest,
    pub(crate) clock: Clock,
}

impl<L: Eight> Probe<L> {
    /// The probe of a ray that comes alone; those of packets come from [`super::packet::Packet::take`].
    #[inline(always)]
    pub(crate) fn new(ray: &CanonicalRay) -> Self {
        let CanonicalRay { origin: o, within, direction: d, .. } = ray;
        let axes = permutation(*d);
        let [x, y, z] = axes;
        let slabs =
            Slabs::new(unroll!(k in 0..3 => L::splat(within[k])), inverse(unroll!(k in 0..3 => L::splat(d[k]))));
        // The shear's divisions as one division of lanes.
        let numerators = L::load(&[d[x], d[y], 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let slope = (numerators / L::splat(d[z])).to_array();
        let neg = u32::from(d[0] < 0.0) | u32::from(d[1] < 0.0) << 1 | u32::from(d[2] < 0.0) << 2;
        Self {
            slabs,
            order: L::order(neg),
            origin: *o,
            shear: Shear { origin: [o[x], o[y], o[z]], slope: [slope[0], slope[1], slope[2]] },
            axes,
            neg,
            nearest: Nearest::new(ray),
            clock: ray.clock,
        }
    }
}
