//! The octree that rays walk: a serialized, pointer-free structure whose leaves know their face neighbours, the
//! branchless step between them, and the watertight triangle test. No std, no allocation.
//!
//! An octree is a run of `u32` words ([`Octree`]), validated once and then traced in place. It is built by the crate
//! `leafwalk-cpu`. Rays go in as [`Ray`], answers come back as [`Hit`]; [`Tracer`] is the batch interface that every
//! backend shares.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]

mod aabb;
mod blocks;
pub mod canonical;
pub mod contract;
mod error;
mod frame;
pub mod lanes;
pub mod layout;
mod nearest;
mod octree;
mod parts;
mod ray;
pub mod slabs;
mod stats;
pub mod step;
pub mod tables;
#[doc(hidden)]
pub mod testing;
mod trace;
mod tracer;
pub mod triangle;
mod unroll;
mod validate;
pub mod wire;

pub use aabb::Aabb;
pub use blocks::{Blocks, Indexed};
pub use error::{DecodeError, RecordFault};
pub use frame::Frame;
pub use nearest::Nearest;
pub use octree::Octree;
pub use parts::Parts;
pub use ray::{CanonicalRay, Clock, Hit, Ray, hit_hash};
pub use stats::{LEAF_SIZES, Stats};
pub use trace::{Walk, Work};
pub use tracer::{LengthMismatch, Tracer, one_by_one};

/// The examples of the README are tests too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
