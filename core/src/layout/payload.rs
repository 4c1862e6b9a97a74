//! `Payload`: what a leaf of the octree lists.

use super::{LatticeBox, NONE};

/// Blocks of a payload.
pub const PAYLOAD_BLOCKS: usize = 8;
/// Words of a payload.
pub const PAYLOAD_WORDS: usize = 32;

/// What a leaf lists, 128 bytes: up to eight blocks of triangles, and where the list goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Payload {
    /// Lower and upper sides of the boxes of the blocks, axis by axis. Boxes that are not in use are
    /// [`LatticeBox::EMPTY`].
    pub sides: [[[u16; PAYLOAD_BLOCKS]; 2]; 3],
    /// Lower side of the box around all that is listed, of the whole chain.
    pub lower: [u16; 3],
    /// Upper side of that box.
    pub upper: [u16; 3],
    /// Blocks in this payload: 1 to 8.
    pub count: u32,
    /// Number of the first block; the others follow it.
    pub first: u32,
    /// The payload that continues the list, or [`NONE`].
    pub next: u32,
    /// Zero.
    pub unused: [u32; 2],
}

impl Payload {
    /// The box of a block, by its place in this payload.
    pub fn boxed(&self, at: usize) -> LatticeBox {
        LatticeBox { lower: self.sides.map(|[lower, _]| lower[at]), upper: self.sides.map(|[_, upper]| upper[at]) }
    }

    /// The box around all that is listed.
    pub fn hull(&self) -> LatticeBox {
        LatticeBox { lower: self.lower, upper: self.upper }
    }

    /// A payload with these boxes, of which empty ones are not in use; blocks and chain are left to be filled in.
    pub fn of_boxes(boxes: [LatticeBox; PAYLOAD_BLOCKS]) -> Self {
        let LatticeBox { lower, upper } = LatticeBox::around(boxes);
        Self {
            sides: core::array::from_fn(|k| [boxes.map(|b| b.lower[k]), boxes.map(|b| b.upper[k])]),
            lower,
            upper,
            count: boxes.iter().filter(|b| **b != LatticeBox::EMPTY).count() as u32,
            first: 0,
            next: NONE,
            unused: [0; 2],
        }
    }
}
