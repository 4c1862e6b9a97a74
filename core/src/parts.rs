//! `Parts`: the sections of an octree as slices.

use crate::aabb::Aabb;
use crate::blocks::{Blocks, Indexed};
use crate::error::DecodeError;
use crate::frame::Frame;
use crate::layout::{Block, BvhNode, Key, Lattice, LatticeBox, Record, Section, Triangle};
use crate::wire::{Header, Spans};

/// The sections of an octree as slices.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// Counts and settings.
    pub header: Header,
    /// The frame that the header holds.
    pub frame: Frame,
    /// All nodes; the root is number 0, and numbers 1 to 7 are vacant.
    pub records: &'a [Record],
    keys: &'a [[u32; 2]],
    /// What leaves that are not empty list: nodes of the BVH or blocks, with boxes that are cut to the leaf's cell.
    pub payloads: &'a [BvhNode],
    /// The triangles, each in one block.
    pub blocks: Blocks<'a>,
    /// The BVH over the blocks, its root first; empty where no triangle is listed.
    pub bvh: &'a [BvhNode],
    /// In wide octrees one lattice a node of the BVH; else empty, and all count the root's steps.
    pub lattices: &'a [Lattice],
    /// The box around all triangles; without any, one that few rays meet.
    pub hull: LatticeBox,
    /// Record numbers of the entry grid, x fastest.
    pub grid: &'a [u32],
    /// One material id a triangle, or empty.
    pub materials: &'a [u32],
}

impl<'a> Parts<'a> {
    pub(crate) const EMPTY: Parts<'static> = Parts {
        header: Header {
            primitives: 0,
            dropped: 0,
            collapsed: 0,
            grid_bits: 0,
            scale_exponent: 0,
            padding: 0.0,
            rounding: 0.0,
            step_cost: 0.0,
            max_level: 0,
            anchor: [0; 6],
            corner: [0; 3],
        },
        frame: Frame { anchor: [0.0; 3], corner: [0.0; 3], scale_exponent: 0 },
        records: &[],
        keys: &[],
        payloads: &[],
        blocks: Blocks::EMPTY,
        bvh: &[],
        lattices: &[],
        hull: LatticeBox::VACANT,
        grid: &[],
        materials: &[],
    };

    pub(crate) fn new(words: &'a [u32], spans: &Spans, hull: LatticeBox) -> Result<Self, DecodeError> {
        let header: &[Header] = slice(words, spans, Section::Header)?;
        let &[header] = header else { return Err(wrong_length(spans, Section::Header)) };
        let (indexed, vertices) = (Section::IndexedBlocks, Section::Vertices);
        let indexed = Indexed { blocks: slice(words, spans, indexed)?, vertices: slice(words, spans, vertices)? };
        let blocks = Blocks::new(slice(words, spans, Section::Blocks)?, indexed)?;
        Ok(Self {
            header,
            frame: header.frame(),
            records: slice(words, spans, Section::Records)?,
            keys: slice(words, spans, Section::Keys)?,
            payloads: slice(words, spans, Section::Payloads)?,
            blocks,
            bvh: slice(words, spans, Section::Bvh)?,
            lattices: slice(words, spans, Section::Lattices)?,
            hull,
            grid: slice(words, spans, Section::Grid)?,
            materials: slice(words, spans, Section::Materials)?,
        })
    }

    /// The key of a record.
    pub fn key(&self, record: u32) -> Key {
        Key::from_words(self.keys[record as usize])
    }

    pub(crate) fn key_count(&self) -> usize {
        self.keys.len()
    }

    /// Leaves, as (record number, record), in depth-first order.
    pub fn leaves(&self) -> impl Iterator<Item = (u32, &'a Record)> + use<'a> {
        let numbered = (0..).zip(self.records);
        numbered.filter(|(number, record)| (*number == 0 || *number > 7) && !record.head().is_inner())
    }

    /// What a leaf lists, unless that is nothing.
    pub fn payload_of(&self, leaf: &Record) -> Option<&'a BvhNode> {
        (leaf.head().t_count() != 0).then(|| &self.payloads[leaf.offset as usize])
    }

    /// The lattice that the sides of a node's boxes count the steps of.
    pub fn lattice(&self, node: u32) -> Lattice {
        self.lattices.get(node as usize).copied().unwrap_or_else(|| Lattice::root(&self.frame))
    }

    /// All triangles.
    pub fn triangles(&self) -> impl Iterator<Item = Triangle> + use<'a> {
        self.blocks.iter().flat_map(Block::triangles)
    }

    /// See [`crate::Octree::bounds`].
    pub(crate) fn bounds(&self) -> Aabb {
        if self.bvh.is_empty() {
            return Aabb { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3] };
        }
        let LatticeBox { lower, upper } = self.hull;
        let at = |steps: [u16; 3], end: f32| {
            let corner = self.frame.corner;
            self.frame.to_caller(core::array::from_fn(|k| corner[k] + (f32::from(steps[k]) + end)))
        };
        Aabb { lower: at(lower, 0.0), upper: at(upper, 1.0) }
    }
}

/// The words of a section as items; an error where they are no whole number of them.
#[inline]
pub(crate) fn slice<'a, T: bytemuck::Pod>(
    words: &'a [u32],
    spans: &Spans,
    section: Section,
) -> Result<&'a [T], DecodeError> {
    let (offset, length) = spans[section as usize];
    let words = &words[offset as usize..][..length as usize];
    bytemuck::try_cast_slice(words).map_err(|_| wrong_length(spans, section))
}

fn wrong_length(spans: &Spans, section: Section) -> DecodeError {
    DecodeError::SectionLength { section, words: spans[section as usize].1 }
}
