//! `Tracer`: a batch of rays in, a batch of answers out. Every backend is one.

use core::fmt;

use crate::octree::Octree;
use crate::ray::{Hit, Ray};
use crate::trace::Walk;

/// Answers batches of rays. All tracers over the same octree give the same bits.
///
/// References to a tracer are tracers, too; so are `Box` and `Arc` with the feature `alloc`.
///
/// ```
/// # use leafwalk_core::{Hit, Ray, Tracer};
/// /// How many rays hit something.
/// fn count<T: Tracer>(tracer: T, rays: &[Ray]) -> Result<usize, T::Error> {
///     let mut hits = vec![Hit::MISS; rays.len()];
///     tracer.closest_hits(rays, &mut hits)?;
///     Ok(hits.iter().filter(|hit| !hit.is_miss()).count())
/// }
///
/// fn count_twice<T: Tracer>(tracer: &T, rays: &[Ray]) -> Result<usize, T::Error> {
///     Ok(count(tracer, rays)? + count(tracer, rays)?)
/// }
/// ```
pub trait Tracer {
    /// What can go wrong.
    type Error: core::error::Error;

    /// The closest hit of each ray, [`Hit::MISS`] where there is none.
    ///
    /// # Errors
    /// At least when the slices differ in length.
    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), Self::Error>;

    /// Whether anything is hit by each ray.
    ///
    /// # Errors
    /// At least when the slices differ in length.
    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), Self::Error>;
}

/// What points to a tracer is one.
macro_rules! through_pointers {
    ($($(#[$attribute:meta])* $pointer:ty),+ $(,)?) => {$(
        $(#[$attribute])*
        impl<T: Tracer + ?Sized> Tracer for $pointer {
            type Error = T::Error;

            fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), Self::Error> {
                (**self).closest_hits(rays, hits)
            }

            fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), Self::Error> {
                (**self).occlusions(rays, occluded)
            }
        }
    )+};
}
through_pointers!(
    &T,
    #[cfg(feature = "alloc")]
    alloc::boxed::Box<T>,
    #[cfg(feature = "alloc")]
    alloc::sync::Arc<T>,
);

/// As many answers as rays are needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LengthMismatch {
    /// Length of the slice of rays.
    pub rays: usize,
    /// Length of the slice for the answers.
    pub answers: usize,
}

impl LengthMismatch {
    /// An error unless the lengths are equal.
    ///
    /// # Errors
    /// The two lengths.
    pub fn check(rays: usize, answers: usize) -> Result<(), Self> {
        if rays == answers { Ok(()) } else { Err(Self { rays, answers }) }
    }
}

impl fmt::Display for LengthMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} rays but room for {} answers: make the slices equally long", self.rays, self.answers)
    }
}

impl core::error::Error for LengthMismatch {}

/// Answers each ray by itself.
///
/// # Errors
/// When the slices differ in length.
pub fn one_by_one<A>(rays: &[Ray], answers: &mut [A], mut answer: impl FnMut(&Ray) -> A) -> Result<(), LengthMismatch> {
    LengthMismatch::check(rays.len(), answers.len())?;
    for (ray, slot) in rays.iter().zip(answers) {
        *slot = answer(ray);
    }
    Ok(())
}

/// The scalar tracer, on the calling thread.
impl<W: AsRef<[u32]>> Tracer for Octree<W> {
    type Error = LengthMismatch;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), LengthMismatch> {
        let parts = self.parts();
        let walk = Walk::new(&parts);
        one_by_one(rays, hits, |ray| Hit::from(walk.closest_hit(ray)))
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), LengthMismatch> {
        let parts = self.parts();
        let walk = Walk::new(&parts);
        one_by_one(rays, occluded, |ray| walk.occluded(ray))
    }
}
