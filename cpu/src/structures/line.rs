//! `Line`: a ray as structures see it.

use glam::Vec3;

/// A ray in the coordinates of a [`super::Scene`].
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Where t is 0.
    pub origin: Vec3,
    /// Not zero, but any of its components may be.
    pub direction: Vec3,
    /// 1 / direction, infinite where that is zero.
    pub inverse: Vec3,
    /// Hits count beyond it; it may be negative.
    pub t_min: f32,
    /// Hits count before it; it may be infinite.
    pub t_max: f32,
}

impl Line {
    /// The points `origin + t * direction` with `t_min < t < t_max`.
    pub fn new(origin: [f32; 3], direction: [f32; 3], t_min: f32, t_max: f32) -> Self {
        let direction = Vec3::from_array(direction);
        Self { origin: Vec3::from_array(origin), direction, inverse: direction.recip(), t_min, t_max }
    }

    /// A point of the line.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }
}
