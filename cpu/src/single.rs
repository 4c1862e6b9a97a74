//! One ray at a time, with eight lanes a ray.

use leafwalk_core::{CanonicalRay, Hit, Nearest, Parts, Ray};

use crate::descent::descend;
use crate::lanes::{Eight, Kernel, Registers};

/// Answers single rays over one octree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Single<'a> {
    parts: &'a Parts<'a>,
    registers: Registers,
}

impl<'a> Single<'a> {
    pub(crate) fn new(parts: &'a Parts<'a>, registers: Registers) -> Self {
        Self { parts, registers }
    }

    /// The closest hit, or [`Hit::MISS`].
    pub(crate) fn closest_hit(&self, ray: &Ray) -> Hit {
        self.search::<false>(ray).map_or(Hit::MISS, |(ray, nearest)| nearest.hit(&ray))
    }

    /// Whether anything is hit.
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        self.search::<true>(ray).is_some_and(|(_, nearest)| nearest.is_hit())
    }

    #[inline(always)]
    fn search<const ANY: bool>(&self, ray: &Ray) -> Option<(CanonicalRay, Nearest)> {
        let ray = self.parts.frame.canonical(ray)?;
        Some((ray, self.registers.run(Search::<ANY> { parts: self.parts, ray: &ray })))
    }
}

struct Search<'a, const ANY: bool> {
    parts: &'a Parts<'a>,
    ray: &'a CanonicalRay,
}

impl<const ANY: bool> Kernel for Search<'_, ANY> {
    type Output = Nearest;

    #[inline(always)]
    fn run<L: Eight>(self) -> Nearest {
        descend::<L, ANY>(self.parts, self.ray)
    }
}
