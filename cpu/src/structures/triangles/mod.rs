//! Triangle tests, one a file, each after its source.

mod exact;

use leafwalk_core::CanonicalRay;

pub use exact::Exact;

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
