//! Measuring: how right answers are.

mod quantile;
mod sample;

pub use quantile::quantile;
pub use sample::{Accuracy, Sample};
