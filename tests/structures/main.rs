//! The structures that leafwalk is compared with.

mod bsp;
mod bvh;
mod comparison;
mod every;
mod octrees;
mod primitives;
mod triangles;
