//! What it takes to draw an octree.

use core::ops::ControlFlow;

use super::meter::Meter;
use super::surface::Surfaces;
use crate::camera::Camera;

/// Draws an octree; each way of drawing is a method, in a file of its own.
pub(crate) struct Drawing<'a, 'm, T> {
    pub(crate) meter: &'a mut Meter<'m, T>,
    pub(crate) surfaces: &'a Surfaces,
    pub(crate) camera: &'a Camera,
    /// Hears of finished pixels and may stop the work.
    pub(crate) progress: &'a dyn Fn(usize) -> ControlFlow<()>,
}
