//! Octrees: cubes cut in eight, and these again, as far as triangles crowd in them. One builder serves all; they differ
//! in how a ray finds the next leaf.
//!
//! | structure | to the next leaf | source |
//! | --- | --- | --- |
//! | [`TopDown`] | down from the root once, child after child | Revelles, Ureña, Lastra 2000 |
//! | [`NeighbourFinding`] | up to the nearest common ancestor, and down | Samet 1989 |
//! | [`Published`] | by a link, or one of four: neighbours differ by one level at most | Portalez, Duguet |
//! | [`Unconstrained`] | by a link to a node of the same size, and down from there | what Portalez and Duguet ask |

mod branches;
mod cells;
mod course;
mod flat;
mod limits;
mod neighbour_finding;
pub mod published;
mod top_down;
mod tree;
mod unconstrained;

pub use limits::Limits;
pub use neighbour_finding::NeighbourFinding;
pub use published::Published;
pub use top_down::TopDown;
pub use tree::Lists;
pub use unconstrained::Unconstrained;
