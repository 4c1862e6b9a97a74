//! `Blocks`: the triangles of an octree, whichever way its file holds them.

use crate::error::DecodeError;
use crate::layout::{BLOCK_WIDTH, Block, IndexedBlock};

/// The triangles, eight by eight.
#[derive(Clone, Copy, Debug)]
pub enum Blocks<'a> {
    /// As they are tested.
    Packed(&'a [Block]),
    /// In a compact octree: by the numbers of their vertices.
    Indexed(Indexed<'a>),
}

/// Blocks that name their vertices by number.
#[derive(Clone, Copy, Debug)]
pub struct Indexed<'a> {
    /// The blocks, which hold no corners.
    pub blocks: &'a [IndexedBlock],
    /// The corners, in lattice coordinates.
    pub vertices: &'a [[f32; 3]],
}

impl<'a> Indexed<'a> {
    /// A block as it is tested, made in `room`. `None` for a number beyond all blocks.
    #[inline]
    pub fn assemble<'b>(&self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block> {
        let IndexedBlock { primitives, base, numbers } = self.blocks.get(number)?;
        let vertices = self.vertices.get(*base as usize..)?;
        let block = room.get_or_insert(Block::VACANT);
        block.primitives = *primitives;
        for (corner, numbers) in block.vertices.iter_mut().zip(numbers) {
            for lane in 0..BLOCK_WIDTH {
                // The decoder has seen that there is such a vertex.
                let [x, y, z] = *vertices.get(usize::from(numbers[lane]))?;
                (corner[0][lane], corner[1][lane], corner[2][lane]) = (x, y, z);
            }
        }
        Some(block)
    }
}

impl<'a> Blocks<'a> {
    pub(crate) const EMPTY: Blocks<'static> = Blocks::Packed(&[]);

    /// The blocks of a file; an error where it holds them both ways.
    pub(crate) fn new(packed: &'a [Block], indexed: Indexed<'a>) -> Result<Self, DecodeError> {
        match (packed.is_empty(), indexed.blocks.is_empty() && indexed.vertices.is_empty()) {
            (_, true) => Ok(Self::Packed(packed)),
            (true, false) => Ok(Self::Indexed(indexed)),
            (false, false) => Err(DecodeError::BlocksTwice),
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Packed(blocks) => blocks.len(),
            Self::Indexed(indexed) => indexed.blocks.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A block, made in `room` where it does not stand in the file as it is. `None` for a number beyond all blocks.
    #[inline(always)]
    pub fn get<'b>(&self, number: usize, room: &'b mut Option<Block>) -> Option<&'b Block>
    where
        'a: 'b,
    {
        match self {
            Self::Packed(blocks) => blocks.get(number),
            Self::Indexed(indexed) => indexed.assemble(number, room),
        }
    }

    /// All blocks, first to last.
    pub fn iter(self) -> impl Iterator<Item = Block> + use<'a> {
        let mut room = None;
        (0..self.len()).filter_map(move |number| self.get(number, &mut room).copied())
    }
}
