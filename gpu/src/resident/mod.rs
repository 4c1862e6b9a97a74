//! What stays on the device: rays that are uploaded once or made there, and answers that are read when they are wanted.

mod generator;
mod rays;
mod submission;

pub use generator::RayGenerator;
pub use rays::DeviceRays;
pub use submission::{DeviceHits, DeviceOcclusions, Submission};
