//! The test of the numeric contract.

use leafwalk_core::CanonicalRay;
use leafwalk_core::triangle::{Shear, intersect};
use leafwalk_core::unroll;

use super::{Meeting, TriangleTest};

/// The watertight test with an exact finish, as all of leafwalk has it: [`leafwalk_core::triangle`]. It wants numbers of the
/// lattice.
#[derive(Clone, Copy, Debug)]
pub struct Exact;

impl TriangleTest for Exact {
    type Triangle = [[f32; 3]; 3];
    type Ray = (Shear<f32>, [usize; 3]);

    fn triangle(corners: &[[f32; 3]; 3]) -> Self::Triangle {
        *corners
    }

    fn ray(ray: &CanonicalRay) -> Self::Ray {
        Shear::new(ray)
    }

    #[inline]
    fn meet((shear, axes): &Self::Ray, corners: &Self::Triangle) -> Option<Meeting> {
        let found = intersect(shear, &unroll!(c in 0..3 => unroll!(k in 0..3 => corners[c][axes[k]])))?;
        Some(Meeting { t: found.t, u: found.u, v: found.v })
    }
}
