//! Builds leafwalk octrees ([`Builder`]), checks them ([`verify`]) and traces them on every core ([`CpuTracer`]).
#![deny(unsafe_code)]

mod batch;
mod beam;
mod brute_force;
mod build;
mod descent;
mod entry;
mod flights;
mod found;
mod group;
mod hierarchy;
mod lanes;
mod mesh;
mod node;
mod prepare;
mod question;
mod ready;
mod sequence;
mod sieve;
mod single;
mod stack;
mod stream;
mod tile;
mod tracer;
mod verify;
mod waiting;

pub use brute_force::BruteForce;
#[doc(hidden)]
pub use build::Spoiled;
pub use build::{BuildError, Builder, Progress};
pub use mesh::Mesh;
pub use tracer::CpuTracer;
pub use verify::{Verified, VerifyError, verify, verify_against};
