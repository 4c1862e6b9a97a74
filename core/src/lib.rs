//! The octree that rays walk: a serialized, pointer-free structure whose leaves know their face neighbours, the
//! branchless step between them, and the watertight triangle test. No std, no allocation.
//!
//! An octree is a run of `u32` words ([`Octree`]), validated once and then traced in place. It is built by the crate
//! `leafwalk-cpu`. Rays go in as [`Ray`], answers come back as [`Hit`]; [`Tracer`] is the batch interface that every
//! backend shares.
#![no_std]
#![forbid(unsafe_code)]

mod axes;
mod blocks;
pub mod boxes;
pub mod canonical;
mod error;
mod frame;
pub mod lanes;
pub mod layout;
mod nearest;
mod octree;
mod policy;
mod ray;
pub mod step;
pub mod tables;
mod trace;
mod tracer;
pub mod triangle;
mod validate;
pub mod wire;

pub use blocks::{Blocks, Indexed};
pub use error::{DecodeError, RecordFault};
pub use frame::Frame;
pub use nearest::Nearest;
pub use octree::{Aabb, LEAF_SIZES, Octree, Parts, Stats};
#[doc(hidden)]
pub use policy::{Policy, Standard};
pub use ray::{CanonicalRay, Clock, Hit, Ray, hit_hash};
pub use trace::{Walk, Work};
pub use tracer::{LengthMismatch, Tracer, one_by_one};
