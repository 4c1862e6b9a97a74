//! `Block`: eight triangles, and how a compact octree names their corners.

use super::NONE;

/// Triangles of a block.
pub const BLOCK_WIDTH: usize = 8;
/// Words of a block.
pub const BLOCK_WORDS: usize = 80;
/// Words of an indexed block.
pub const INDEXED_BLOCK_WORDS: usize = 21;
/// Words of a vertex.
pub const VERTEX_WORDS: usize = 3;

/// One triangle as blocks hold it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its index in the mesh.
    pub primitive: u32,
    /// Its corners in lattice coordinates, which are exact.
    pub corners: [[f32; 3]; 3],
}

/// Eight triangles: 320 bytes. A vacant lane repeats the first one's corners, and its primitive never wins the tie.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Block {
    /// Corner, axis, lane: in lattice coordinates.
    pub vertices: [[[f32; BLOCK_WIDTH]; 3]; 3],
    /// The triangle of each lane, or [`NONE`].
    pub primitives: [u32; BLOCK_WIDTH],
}

impl Block {
    /// A block without a triangle.
    pub const VACANT: Self = Self { vertices: [[[0.0; BLOCK_WIDTH]; 3]; 3], primitives: [NONE; BLOCK_WIDTH] };

    /// The triangles of all lanes that are not vacant.
    pub fn triangles(self) -> impl Iterator<Item = Triangle> {
        let lanes = (0..BLOCK_WIDTH).filter(move |lane| self.primitives[*lane] != NONE);
        lanes.map(move |lane| Triangle { primitive: self.primitives[lane], corners: self.corners(lane) })
    }

    /// The three corners of a lane.
    pub fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.vertices.map(|corner| corner.map(|axis| axis[lane]))
    }
}

/// Eight triangles by the numbers of their vertices, 84 bytes: a block of a compact octree. Vacant lanes are as in
/// [`Block`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct IndexedBlock {
    /// The triangle of each lane, or [`NONE`].
    pub primitives: [u32; BLOCK_WIDTH],
    /// The vertex that the others are counted from.
    pub base: u32,
    /// Corner, lane: the number of its vertex, less `base`.
    pub numbers: [[u16; BLOCK_WIDTH]; 3],
}
