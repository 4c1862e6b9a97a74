//! `Scene`: what structures are built over.

use glam::{DVec3, Vec3};

use super::bounds::Bounds;
use crate::build::Overlap;

/// Triangles, and how far from where it should be a ray may pass them by rounding.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Corners. Structures name triangles by their place in this list.
    pub corners: Vec<[Vec3; 3]>,
    /// A structure that keeps a margin leads a ray past each triangle that lies within this of it, in any direction, and
    /// does not stop for a hit until it is this far behind, in t. 0 where a method is taken as it was published.
    pub margin: f32,
}

impl Scene {
    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The box around a triangle, without the margin.
    pub fn bounds_of(&self, triangle: u32) -> Bounds {
        Bounds::around(&self.corners[triangle as usize])
    }

    /// The box around all triangles, without the margin.
    pub fn bounds(&self) -> Bounds {
        Bounds::around(self.corners.as_flattened())
    }

    /// Whether a triangle meets a box: no point of both is missed, rounding or not. The margin is the caller's to add to
    /// the box.
    pub fn meets(&self, triangle: u32, bounds: &Bounds) -> bool {
        let shared = self.bounds_of(triangle).meet(*bounds);
        if shared.is_empty() {
            return false;
        }
        let [lower, upper]: [DVec3; 2] = [bounds.lower.as_dvec3(), bounds.upper.as_dvec3()];
        let corners = self.corners[triangle as usize].map(|corner| corner.to_array());
        Overlap::new(&corners, DVec3::ZERO).meets(0.5 * (lower + upper), 0.5 * (upper - lower))
    }
}
