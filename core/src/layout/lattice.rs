//! `Lattice`: where the sides of a node's boxes lie, in scenes whose detail takes few of the root's steps.

use super::{LATTICE, LatticeBox};
use crate::frame::Frame;

/// Words of a lattice.
pub const LATTICE_WORDS: usize = 4;
/// The finest step of a lattice: 2^-48 of the root's edge. The margin of boxes whose sides count finer steps would no longer
/// cover what the triangle test takes for 0.
pub const FINEST_STEP: f32 = 1.0 / (1u64 << 32) as f32;

/// A corner, and the step that the sides of a node's boxes count from there: side n lies at `corner + n * step`, which is
/// exact in f64.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Lattice {
    /// In lattice coordinates, a multiple of the step.
    pub corner: [f32; 3],
    /// A power of two: of the root's steps, one at most, and [`FINEST_STEP`] at least.
    pub step: f32,
}

impl Lattice {
    /// The lattice of the root: its steps, from its corner.
    pub fn root(frame: &Frame) -> Self {
        Self { corner: frame.corner, step: 1.0 }
    }

    /// Whether the step is a power of two in its range, and the corner a multiple of it in or near the root.
    pub(crate) fn is_sound(&self) -> bool {
        const FRACTION: u32 = (1 << (f32::MANTISSA_DIGITS - 1)) - 1;
        let is_step = self.step >= FINEST_STEP && self.step <= 1.0 && self.step.to_bits() & FRACTION == 0;
        is_step && self.corner.iter().all(|c| self.counts_to(*c))
    }

    fn counts_to(&self, coordinate: f32) -> bool {
        // Exact, and below 2^51.
        let steps = f64::from(coordinate) / f64::from(self.step);
        coordinate.abs() <= (3 * LATTICE) as f32 && steps as i64 as f64 == steps
    }

    /// Lower and upper corner of a box whose sides count the steps of this lattice, in lattice coordinates.
    pub fn bounds(&self, LatticeBox { lower, upper }: LatticeBox) -> [[f64; 3]; 2] {
        let at = |k: usize, steps: u32| f64::from(self.corner[k]) + f64::from(steps) * f64::from(self.step);
        [core::array::from_fn(|k| at(k, lower[k].into())), core::array::from_fn(|k| at(k, u32::from(upper[k]) + 1))]
    }

    /// Whether a point in lattice coordinates lies in a box of this lattice, or on it.
    pub fn touches(&self, boxed: LatticeBox, point: [f32; 3]) -> bool {
        let [lower, upper] = self.bounds(boxed);
        (0..3).all(|k| (lower[k]..=upper[k]).contains(&f64::from(point[k])))
    }

    /// Whether a box of this lattice holds a box of another one.
    pub fn holds(&self, outer: LatticeBox, other: &Self, inner: LatticeBox) -> bool {
        let ([a, b], [c, d]) = (self.bounds(outer), other.bounds(inner));
        (0..3).all(|k| a[k] <= c[k] && d[k] <= b[k])
    }

    /// The steps of another lattice that a box of this one touches, as far as a box may reach there.
    pub fn seen_from(&self, other: &Self, boxed: LatticeBox) -> LatticeBox {
        let [lower, upper] = self.bounds(boxed);
        let steps = |k: usize, side: f64| (side - f64::from(other.corner[k])) / f64::from(other.step);
        // Casts cut off what lies outside.
        let last = |steps: f64| if steps as i64 as f64 == steps { steps - 1.0 } else { steps };
        LatticeBox {
            lower: core::array::from_fn(|k| steps(k, lower[k]) as u16),
            upper: core::array::from_fn(|k| last(steps(k, upper[k])) as u16),
        }
    }

    /// The step that holds a coordinate, as far as a box may reach.
    pub fn step_of(&self, axis: usize, coordinate: f32) -> u16 {
        let (corner, step, coordinate) = (f64::from(self.corner[axis]), f64::from(self.step), f64::from(coordinate));
        let steps = ((coordinate - corner) / step) as u16;
        // The difference may have been rounded up to the next step, to which the sum is exact.
        let is_before = corner + f64::from(steps) * step > coordinate;
        steps - u16::from(is_before && steps > 0)
    }

    /// The finest lattice whose boxes hold all that lies between two corners, which are in or near the root.
    pub fn around(lower: [f32; 3], upper: [f32; 3]) -> Self {
        let largest = lower.iter().chain(&upper).fold(0.0, |largest: f32, c| largest.max(c.abs()));
        // Coordinates as large are whole in units of this.
        let unit = f32::from_bits(largest.to_bits() & !((1 << (f32::MANTISSA_DIGITS - 1)) - 1)) * f32::EPSILON;
        let mut step = FINEST_STEP;
        loop {
            let at = |c: f32| {
                let steps = f64::from(c) / f64::from(step);
                let whole = steps as i64;
                (whole - i64::from(whole as f64 > steps)) as f64 * f64::from(step)
            };
            let lattice = Self { corner: lower.map(|c| at(c) as f32), step };
            let is_far = (0..3)
                .any(|k| f64::from(upper[k]) - f64::from(lattice.corner[k]) >= f64::from(LATTICE) * f64::from(step));
            if step >= unit && !is_far {
                return lattice;
            }
            step *= 2.0;
        }
    }
}
