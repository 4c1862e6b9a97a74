//! The promises, each with its test. LEAFWALK_RAYS, a factor, scales the numbers of rays.

mod geometry;
mod invalid_rays;
mod lattice;
mod limits;
mod metamorphic;
mod mutants;
mod oracle;
mod same_answer;
mod scenes;
mod spawn;
mod truth;
mod watertight;
mod wide;
