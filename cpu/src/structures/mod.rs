//! The structures that leafwalk is compared with, each after its source, and the triangle tests that go with them.
//!
//! A [`Structure`] leads a ray past triangles, a [`TriangleTest`] decides which of these it hits, and [`Traced`] makes the
//! two a [`Tracer`](leafwalk_core::Tracer). Each pair is to be had in two ways of handling rounding:
//!
//! * as published: in the caller's numbers, without margins. What is lost by that is what the comparison shows.
//! * conservatively: on the lattice, with the margins of the numeric contract. With the test of the contract ([`Exact`])
//!   every structure then gives the bits of [`BruteForce`](crate::BruteForce).
//!
//! ```
//! use leafwalk_core::{Hit, Ray, Tracer};
//! use leafwalk_cpu::structures::{Every, Exact, Traced};
//! use leafwalk_cpu::{BruteForce, Mesh};
//!
//! let mesh = Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
//! let every = Traced::<Every, Exact>::conservative(&mesh, &())?;
//! let ray = Ray::new([0.25, 0.5, 2.0], [0.0, 0.0, -1.0]);
//! let mut hits = [Hit::MISS];
//! every.closest_hits(&[ray], &mut hits)?;
//! assert_eq!(BruteForce::new(&mesh)?.closest_hit(&ray), Some(hits[0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bounds;
pub mod bsp;
pub mod bvh;
mod every;
mod input;
mod line;
pub mod octrees;
pub mod primitives;
mod refit_error;
mod scene;
mod structure;
mod traced;
pub mod triangles;

pub use bounds::Bounds;
pub use bsp::Bsp;
pub use bvh::Bvh;
pub use every::Every;
pub use line::Line;
pub use refit_error::RefitError;
pub use scene::Scene;
pub use structure::{Refit, Search, Structure};
pub use traced::Traced;
pub use triangles::{Exact, TriangleTest};
