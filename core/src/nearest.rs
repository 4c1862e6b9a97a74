//! The hit that counts among all that a tracer finds, in whatever order.

use crate::clock::Clock;
use crate::contract::ROUNDOFF;
use crate::lanes::{Bits, Lanes};
use crate::ray::{CanonicalRay, Hit};
use crate::ray_f64::HitF64;

/// The nearest hit so far: smallest t', then smallest primitive; or the ray's own limit. One ray a lane.
#[derive(Clone, Copy, Debug)]
pub struct Nearest<L: Lanes = f32> {
    /// Hits count for t' strictly above it.
    pub t_min: L,
    /// t' of the hit, or of the ray's end.
    pub t: L,
    /// Weight of vertex 1.
    pub u: L,
    /// Weight of vertex 2.
    pub v: L,
    /// The triangle, or `u32::MAX`.
    pub primitive: L::Bits,
}

impl<L: Lanes> Nearest<L> {
    /// Rays with these limits that have hit nothing yet.
    #[inline(always)]
    pub fn between(t_min: L, t_max: L) -> Self {
        let zero = L::splat(0.0);
        Self { t_min, t: t_max, u: zero, v: zero, primitive: L::Bits::splat(u32::MAX) }
    }

    /// Whether anything was hit.
    #[inline(always)]
    pub fn is_hit(&self) -> L::Mask {
        L::below(self.primitive, L::Bits::splat(u32::MAX))
    }

    /// Takes the hits that are accepted and nearer than those so far, or as near and of a smaller primitive. A hit at the
    /// ray's own limit does not count.
    #[inline(always)]
    pub fn offer(&mut self, accepted: L::Mask, t: L, u: L, v: L, primitive: L::Bits) {
        let is_tie_won = t.equal(self.t) & L::below(primitive, self.primitive) & self.is_hit();
        let is_nearer = accepted & self.t_min.less(t) & (t.less(self.t) | is_tie_won);
        self.t = t.or_else(is_nearer, self.t);
        self.u = u.or_else(is_nearer, self.u);
        self.v = v.or_else(is_nearer, self.v);
        self.primitive = L::from_bits(primitive).or_else(is_nearer, L::from_bits(self.primitive)).bits();
    }

    /// Ends the search of the rays that have a hit: from now on nothing counts as nearer.
    #[inline(always)]
    pub fn finish(&mut self) {
        self.t = L::splat(f32::NEG_INFINITY).or_else(self.is_hit(), self.t);
    }
}

impl Nearest {
    /// A ray that has hit nothing yet.
    #[inline(always)]
    pub fn new(ray: &CanonicalRay) -> Self {
        Self::between(ray.t_min, ray.t_max)
    }

    /// The hit in the caller's units, or [`Hit::MISS`].
    #[inline]
    pub fn hit(&self, clock: &Clock) -> Hit {
        if self.is_hit() {
            Hit {
                t: clock.reported(self.t),
                u: self.u,
                v: weight_of_vertex_2(self.u, self.v),
                primitive: self.primitive,
            }
        } else {
            Hit::MISS
        }
    }

    /// The hit with its distance in f64, or [`HitF64::MISS`].
    pub fn hit_f64(&self, clock: &Clock) -> HitF64 {
        let Hit { t, u, v, primitive } = self.hit(clock);
        let t = if self.is_hit() { clock.reported_f64(self.t) } else { f64::from(t) };
        HitF64 { t, u, v, primitive }
    }
}

/// The weight of vertex 2 as it is reported: where rounding has brought the sum of two weights above 1, it is lowered, so
/// that `u + v <= 1` holds without any rounding.
#[inline(always)]
pub fn weight_of_vertex_2<L: Lanes>(u: L, v: L) -> L {
    let one = L::splat(1.0);
    // Rounded to a multiple of a roundoff, or exact. What is left of 1 is exact, and shows whether it was rounded up.
    let rest = one - u;
    let rest = rest.or_else(u.at_most(one - rest), rest - L::splat(ROUNDOFF));
    v.min(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_never_add_up_to_more_than_1() {
        for bits in (0..0x3f80_0000).step_by(997).chain([0, 1, 0x3f00_0000, 0x3eff_ffff, 0x3f80_0000]) {
            let u = f32::from_bits(bits);
            let v = weight_of_vertex_2(u, 1.0);
            assert!(f64::from(u) + f64::from(v) <= 1.0, "{u} + {v}");
            assert!(f64::from(u) + f64::from(v) > 1.0 - 2.0 * f64::from(ROUNDOFF), "{u} + {v}");
            assert_eq!(weight_of_vertex_2(u, 0.25 * (1.0 - u)), 0.25 * (1.0 - u));
        }
    }
}
