//! The stability ladder: the same question made harder step by step, until methods fail.

mod axis;
mod rung;

pub use axis::Axis;
pub use rung::{Outcome, Rung};
