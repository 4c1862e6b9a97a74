//! The constants of the numeric contract, each with its derivation in short; `docs/contract.md` has the proofs.
//!
//! Lengths are in lattice steps, the unit of all lattice coordinates: the root cube's edge is [`LATTICE`] of them.

use crate::layout::LATTICE;

/// The root's edge.
const EDGE: f32 = LATTICE as f32;

/// Unit roundoff of f32: half the distance from 1 to the next number.
pub const ROUNDOFF: f32 = 1.0 / (1 << 24) as f32;
/// A triangle is listed in every leaf whose cell, dilated by this, meets it.
///
/// 40 roundoffs of the root's edge; the bounds need 39, for where a walk stops.
pub const PADDING: f32 = 40.0 * ROUNDOFF * EDGE;
/// The mesh keeps this far inside the root cube, so that the root's own test can never cut a hit off.
pub const MESH_MARGIN: f32 = 128.0 * ROUNDOFF * EDGE;
/// The boxes of leaves, blocks and BVH nodes are dilated by this before a ray is tested against them.
///
/// One padding for the zone that binning adds around a cell, and 53.5 roundoffs for the ray and the corners: lateral
/// error 10, depth error 32, slab test 9, origin and corners seen from the root's corner 2.5 (all at an origin one root
/// edge away). Three paddings are 120, and the bound needs 93.5.
pub const BOX_MARGIN: f32 = 3.0 * PADDING;
/// A walk starts this far (in t') before `t_min`, or before it enters the hull, so that the point it starts from may carry
/// rounding.
///
/// A canonical direction covers at least t' steps, so this is at least 80 roundoffs of the root's edge; hits lie within 53
/// (lateral 10, depth 32, start point 9, origin seen from the root's corner 2).
pub const START_MARGIN: f32 = 2.0 * PADDING;

/// Lattice coordinates, barycentrics and t' below this become 0: no number of the contract is subnormal.
///
/// It is 2^-76 of the root's edge: the only change that a vertex or an origin can suffer.
pub const SMALLEST: f32 = 1.0 / (1u64 << 60) as f32;
/// Direction components of a canonical ray below this become 0.
pub const SMALLEST_DIRECTION: f32 = 1.0 / (1u64 << 40) as f32;
/// Sheared coordinates below this become 0, so that the error of their products stays a normal number.
pub const SMALLEST_SHEARED: f32 = 1.0 / (1u64 << 38) as f32;
