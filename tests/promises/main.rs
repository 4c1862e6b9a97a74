//! The promises, each with its test. LEAFWALK_RAYS, a factor, scales the numbers of rays.

#[path = "../support/mod.rs"]
mod support;

mod lattice;
mod same_answer;
mod scenes;
mod tally;
mod variants;
