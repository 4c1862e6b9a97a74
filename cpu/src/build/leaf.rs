//! What leaves list: nodes and blocks of the hierarchy, with boxes that are cut to the leaf's cell.

use core::ops::Range;

use leafwalk_core::Frame;
use leafwalk_core::layout::{BVH_WIDTH, BvhNode, Child, Key, Triangle};

use super::bounds::Bounds;
use super::bvh::{Hierarchy, by_octant};
use super::part::Cell;
use super::settings::Settings;

/// Which block holds each triangle, and which blocks lie below each node.
pub(crate) struct BlockIndex<'a> {
    nodes: &'a [BvhNode],
    /// Per triangle, by its place in the list of all, its block.
    of_triangle: Vec<u32>,
    /// Per node, the blocks below it.
    below: Vec<Range<u32>>,
}

impl<'a> BlockIndex<'a> {
    pub(crate) fn new(hierarchy: &'a Hierarchy) -> Self {
        let nodes = &hierarchy.nodes;
        let mut of_triangle = vec![0; hierarchy.triangles.len()];
        for (number, block) in (0..).zip(hierarchy.blocks()) {
            block.iter().for_each(|triangle| of_triangle[*triangle as usize] = number);
        }
        let mut below = vec![0..0; nodes.len()];
        for (at, node) in nodes.iter().enumerate().rev() {
            let ranges = (0..BVH_WIDTH).filter_map(|slot| match node.child(slot).1 {
                Child::Vacant => None,
                Child::Block(block) => Some(block..block + 1),
                Child::Node(child) => Some(below[child as usize].clone()),
            });
            let around = |a: Range<u32>, b: Range<u32>| a.start.min(b.start)..a.end.max(b.end);
            below[at] = ranges.reduce(around).unwrap_or_default();
        }
        Self { nodes, of_triangle, below }
    }

    /// The blocks that a child leads to; none for a vacant one.
    fn range(&self, child: Child) -> Range<u32> {
        match child {
            Child::Node(node) => self.below[node as usize].clone(),
            Child::Block(block) => block..block + 1,
            Child::Vacant => 0..0,
        }
    }
}

/// A block, and the part of it inside a cell.
#[derive(Clone, Copy)]
struct Met {
    block: u32,
    bounds: Bounds,
}

/// What a leaf may list: a node or a block, and which of the blocks that the cell meets lie below it.
#[derive(Clone)]
struct Entry {
    child: Child,
    met: Range<usize>,
    bounds: Bounds,
    /// Whether it has more children than there is room for.
    is_closed: bool,
}

/// Lists leaf after leaf, in memory that serves for all of them.
pub(crate) struct Lister<'a> {
    frame: &'a Frame,
    triangles: &'a [Triangle],
    blocks: &'a BlockIndex<'a>,
    settings: &'a Settings,
    parts: Vec<Met>,
    met: Vec<Met>,
}

impl<'a> Lister<'a> {
    pub(crate) fn new(
        frame: &'a Frame,
        triangles: &'a [Triangle],
        blocks: &'a BlockIndex<'a>,
        settings: &'a Settings,
    ) -> Self {
        Self { frame, triangles, blocks, settings, parts: Vec::new(), met: Vec::new() }
    }

    /// What a leaf lists, given its references, of which there is one at least.
    pub(crate) fn list(&mut self, cell: Key, references: &[u32]) -> BvhNode {
        let cell = Cell::new(self.frame, cell, self.settings.padding());
        self.parts.clear();
        self.parts.extend(references.iter().map(|&reference| Met {
            block: self.blocks.of_triangle[reference as usize],
            bounds: cell.part(&self.triangles[reference as usize].corners),
        }));
        self.parts.sort_unstable_by_key(|met| met.block);
        self.met.clear();
        for part in &self.parts {
            match self.met.last_mut() {
                Some(last) if last.block == part.block => last.bounds = last.bounds.join(part.bounds),
                _ => self.met.push(*part),
            }
        }
        let entries = self.entries();
        let mut centres = [[0.0; 3]; BVH_WIDTH];
        for (centre, entry) in centres.iter_mut().zip(&entries) {
            *centre = entry.bounds.centre().map(|c| c as f32);
        }
        let mut payload = BvhNode::VACANT;
        for (entry, slot) in entries.iter().zip(by_octant(&centres[..entries.len()])) {
            payload.put(slot, self.settings.spoiled.boxed(entry.bounds), entry.child);
        }
        payload
    }

    /// As many entries as a payload has slots, at most: blocks where they fit in, else nodes, of which the one with the
    /// largest box is opened as long as its children have room.
    fn entries(&self) -> Vec<Entry> {
        let mut entries = Vec::with_capacity(BVH_WIDTH);
        if self.met.len() <= BVH_WIDTH {
            let of_block = |(at, met): (usize, &Met)| self.entry(Child::Block(met.block), at..at + 1);
            entries.extend(self.met.iter().enumerate().map(of_block));
            return entries;
        }
        entries.push(self.entry(Child::Node(0), 0..self.met.len()));
        loop {
            let openable = entries.iter().enumerate().filter_map(|(at, entry)| match entry.child {
                Child::Node(node) if !entry.is_closed => Some((at, node, entry.bounds.area())),
                _ => None,
            });
            let Some((at, node, _)) = openable.max_by(|a, b| a.2.total_cmp(&b.2)) else { return entries };
            let opened = self.open(node, entries[at].met.clone());
            if entries.len() + opened.len() <= BVH_WIDTH + 1 {
                entries.swap_remove(at);
                entries.extend(opened);
            } else {
                entries[at].is_closed = true;
            }
        }
    }

    /// The children of a node below which there are blocks of a run.
    fn open(&self, node: u32, run: Range<usize>) -> Vec<Entry> {
        let node = &self.blocks.nodes[node as usize];
        let met = &self.met[run.clone()];
        let child = |slot: usize| {
            let child = node.child(slot).1;
            let blocks = self.blocks.range(child);
            let first = met.partition_point(|met| met.block < blocks.start);
            let end = met.partition_point(|met| met.block < blocks.end);
            (first < end).then(|| self.entry(child, run.start + first..run.start + end))
        };
        (0..BVH_WIDTH).filter_map(child).collect()
    }

    fn entry(&self, child: Child, met: Range<usize>) -> Entry {
        let bounds = self.met[met.clone()].iter().fold(Bounds::EMPTY, |all, met| all.join(met.bounds));
        Entry { child, met, bounds, is_closed: false }
    }
}
