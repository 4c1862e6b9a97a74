//! The constants of the numeric contract, each with its derivation in short; `docs/contract.md` has the proofs.
//!
//! Lengths are in lattice units: the root cube's edge is 1.

/// Unit roundoff of f32: half the distance from 1 to the next number.
pub const ROUNDOFF: f32 = 1.0 / (1 << 24) as f32;
/// A triangle is listed in every leaf whose cell, dilated by this, meets it.
///
/// 32 roundoffs of the root's edge; the bound needs 26.
pub const PADDING: f32 = 32.0 * ROUNDOFF;
/// The mesh keeps this far inside the root cube, so that the root's own test can never cut a hit off.
pub const MESH_MARGIN: f32 = 128.0 * ROUNDOFF;
/// The boxes of leaves, blocks and BVH nodes are dilated by this before a ray is tested against them.
///
/// One padding for the zone that binning adds around a cell, and 38 roundoffs for the ray: lateral error 10, depth
/// error 19, slab test 9 (all at an origin one root edge away). Three paddings are 96.
pub const BOX_MARGIN: f32 = 3.0 * PADDING;
/// A walk starts this far (in t') before `t_min`, so that the point it starts from may carry rounding.
///
/// A canonical direction covers at least t' root edges, so this is at least 64 roundoffs of the root's edge; hits lie
/// within 38 (lateral 10, depth 19, start point 9).
pub const START_MARGIN: f32 = 2.0 * PADDING;

/// Lattice coordinates, barycentrics and t' below this become 0: no number of the contract is subnormal.
pub const SMALLEST: f32 = 1.0 / (1u64 << 60) as f32;
/// Direction components of a canonical ray below this become 0.
pub const SMALLEST_DIRECTION: f32 = 1.0 / (1u64 << 40) as f32;
/// Sheared coordinates below this become 0, so that the error of their products stays a normal number.
pub const SMALLEST_SHEARED: f32 = 1.0 / (1u64 << 38) as f32;
