//! Triangle tests, one a file, each after its source.
//!
//! | test | rays at shared edges and corners |
//! | --- | --- |
//! | [`Exact`], [`Watertight`] | hit |
//! | [`Plucker`] | hit edges; some pass at corners |
//! | [`MollerTrumbore`], [`BaldwinWeber`], [`Projected`] | pass between triangles, as each rounds by itself |

mod baldwin_weber;
mod exact;
mod moller_trumbore;
mod plucker;
mod projected;
mod watertight;

use glam::Vec3;
use leafwalk_core::CanonicalRay;

pub use baldwin_weber::BaldwinWeber;
pub use exact::Exact;
pub use moller_trumbore::MollerTrumbore;
pub use plucker::Plucker;
pub use projected::Projected;
pub use watertight::Watertight;

/// Whether a ray hits a triangle, and where.
pub trait TriangleTest: 'static {
    /// What is kept of a triangle.
    type Triangle: Copy + Send + Sync;
    /// What is kept of a ray while it is traced.
    type Ray: Copy;

    /// Prepares a triangle, given its corners.
    fn triangle(corners: &[[f32; 3]; 3]) -> Self::Triangle;

    /// Prepares a ray. Its numbers need not be canonical, unless the test says so.
    fn ray(ray: &CanonicalRay) -> Self::Ray;

    /// Where the whole line meets the triangle, if it does.
    fn meet(ray: &Self::Ray, triangle: &Self::Triangle) -> Option<Meeting>;
}

/// Where a line meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// In multiples of the direction.
    pub t: f32,
    /// Weight of corner 1.
    pub u: f32,
    /// Weight of corner 2.
    pub v: f32,
}

/// A test that can do with the caller's numbers, of whatever size; the others want canonical ones.
pub trait InCallersUnits: TriangleTest {}

/// A ray as it is, for tests that have nothing to prepare.
#[derive(Clone, Copy, Debug)]
pub struct Unprepared {
    origin: Vec3,
    direction: Vec3,
}

impl From<&CanonicalRay> for Unprepared {
    fn from(ray: &CanonicalRay) -> Self {
        Self { origin: ray.origin.into(), direction: ray.direction.into() }
    }
}

/// The edges from corner 0 to corners 1 and 2.
fn edges([a, b, c]: [Vec3; 3]) -> [Vec3; 2] {
    [b - a, c - a]
}

/// The axis along which a vector is longest, the first of equals.
fn longest_axis(vector: Vec3) -> usize {
    let [x, y, z] = vector.abs().to_array();
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

/// Where a line meets a triangle, given the weights of corners 1 and 2, if these lie on the triangle. No NaN does.
#[inline]
fn inside(t: f32, u: f32, v: f32) -> Option<Meeting> {
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then_some(Meeting { t, u, v })
}
