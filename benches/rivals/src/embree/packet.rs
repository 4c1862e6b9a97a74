//! As many rays as one call takes.

use core::ffi::c_int;

use leafwalk::Ray;

use super::super::Answer;
use super::binding::*;

impl<A, const N: usize> Rays<A, N> {
    /// Up to N rays; the mask of the call switches the lanes off that are left over.
    pub(super) fn new(rays: &[Ray]) -> Self {
        let lane = |i: usize| rays[i.min(rays.len() - 1)];
        let lanes = |value: &dyn Fn(Ray) -> f32| core::array::from_fn(|i| value(lane(i)));
        Self {
            align: [],
            origin: core::array::from_fn(|k| lanes(&|ray| ray.origin[k])),
            t_near: lanes(&|ray| ray.t_min),
            direction: core::array::from_fn(|k| lanes(&|ray| ray.direction[k])),
            time: [0.0; N],
            t_far: lanes(&|ray| ray.t_max),
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
        }
    }

    pub(super) fn answer(&self, lane: usize) -> bool {
        self.t_far[lane] == f32::NEG_INFINITY
    }
}

impl<A, const N: usize> RayHits<A, N> {
    pub(super) fn new(rays: &[Ray]) -> Self {
        Self {
            rays: Rays::new(rays),
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [INVALID; N],
        }
    }

    pub(super) fn answer(&self, lane: usize) -> Answer {
        match self.geometry[lane] {
            INVALID => Answer::MISS,
            _ => Answer { t: self.rays.t_far[lane], primitive: self.primitive[lane] },
        }
    }
}

/// Which lanes of a packet are on: -1, else 0.
#[repr(C, align(64))]
pub(super) struct Valid<const N: usize>([c_int; N]);

/// As many rays as one call takes.
pub(super) trait Packet {
    type Valid;
    type Answer;
    const WIDTH: usize;

    fn new(rays: &[Ray]) -> Self;
    fn valid(rays: usize) -> Self::Valid;
    /// # Safety
    /// The scene is one that was committed.
    unsafe fn trace(&mut self, valid: &Self::Valid, scene: Handle, context: &mut Context);
    fn answer(&self, lane: usize) -> Self::Answer;
}

/// Implements [`Packet`] by one of Embree's functions.
macro_rules! packet {
    ($form:ident, $align:ty, $width:literal, $answer:ty, $call:ident $(, $valid:ident)?) => {
        impl Packet for $form<$align, $width> {
            type Valid = Valid<$width>;
            type Answer = $answer;
            const WIDTH: usize = $width;

            fn new(rays: &[Ray]) -> Self {
                Self::new(rays)
            }
            fn valid(rays: usize) -> Valid<$width> {
                Valid(core::array::from_fn(|lane| if lane < rays { -1 } else { 0 }))
            }
            #[inline(always)]
            unsafe fn trace(&mut self, _valid: &Valid<$width>, scene: Handle, context: &mut Context) {
                // SAFETY: The caller answers for the scene; everything else is borrowed, of the type that is declared,
                // and has its alignment.
                unsafe { $call($(_valid.0.$valid(),)? scene, context, self) }
            }
            fn answer(&self, lane: usize) -> $answer {
                self.answer(lane)
            }
        }
    };
}

packet!(RayHits, Align16, 1, Answer, rtcIntersect1);
packet!(RayHits, Align32, 8, Answer, rtcIntersect8, as_ptr);
packet!(RayHits, Align64, 16, Answer, rtcIntersect16, as_ptr);
packet!(Rays, Align16, 1, bool, rtcOccluded1);
packet!(Rays, Align32, 8, bool, rtcOccluded8, as_ptr);
packet!(Rays, Align64, 16, bool, rtcOccluded16, as_ptr);
