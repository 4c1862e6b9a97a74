//! Charts, as SVG: legible in print and for the colour-blind, since families differ in shape as well; on a light ground, so
//! that dark pages show them as cards.

mod error;
mod scatter;
mod style;

pub use error::ChartError;
pub use scatter::{Point, speed_and_faults};
