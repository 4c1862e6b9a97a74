//! The file format of leafwalk, and the scalar tracer that walks it: no std, no allocation, no unsafe code.
//!
//! A file is a run of `u32` words. It holds two structures over the same blocks of triangles: an octree whose leaves know
//! their face neighbours, and a bounding volume hierarchy (BVH) of eight children a node. This crate checks the words once
//! ([`Octree::from_words`]), and then walks rays from leaf to leaf through them where they lie, in memory, in a memory map
//! or in flash. The crate `leafwalk-cpu` builds files, and descends the BVH with eight lanes. No answer depends on the way
//! to it, so both give the same bits.
//!
//! Rays go in as [`Ray`], answers come back as [`Hit`]; [`Tracer`] is the batch interface that every backend shares.
//!
//! ```
//! use leafwalk_core::{DecodeError, Octree, Ray};
//!
//! /// How far a sensor sees; the words are a file.
//! fn range(words: &[u32]) -> Result<Option<f32>, DecodeError> {
//!     let octree = Octree::from_words(words)?;
//!     let ray = Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -1.0]);
//!     Ok(octree.closest_hit(&ray).map(|hit| hit.t))
//! }
//! assert!(range(&[]).is_err());
//! ```
//!
//! [`layout`] says what the words mean, [`wire`] how they are framed, and [`contract`] which tolerances every tracer keeps.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;

mod aabb;
mod aligned;
mod blocks;
pub mod canonical;
mod clock;
pub mod contract;
mod error;
mod frame;
pub mod lanes;
pub mod layout;
mod leaf;
mod nearest;
mod normal;
#[cfg(feature = "serde")]
pub mod numbers;
mod octree;
mod parts;
pub mod plane;
mod policy;
mod probe;
mod ray;
mod ray_f64;
pub mod slabs;
mod spawn;
pub mod start;
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
pub use aligned::AlignedBytes;
pub use blocks::{Blocks, Indexed};
pub use clock::Clock;
pub use error::{DecodeError, RecordFault};
pub use frame::Frame;
pub use leaf::Leaf;
pub use nearest::{Nearest, weight_of_vertex_2};
pub use normal::geometric_normal;
pub use octree::Octree;
pub use parts::Parts;
pub use ray::{CanonicalRay, Hit, Ray, hit_hash};
pub use ray_f64::{HitF64, RayF64};
pub use stats::{LEAF_SIZES, Stats};
pub use trace::{Walk, Work};
pub use tracer::{LengthMismatch, Tracer, one_by_one};

/// The examples of the README are tests too.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
