//! Splitting: breadth first, level by level, while it lowers the expected cost of a ray, balanced as it goes.

use leafwalk_core::Frame;
use leafwalk_core::layout::{Key, LATTICE, NONE, Triangle};
use rayon::prelude::*;

use super::error::BuildError;
use super::monitor::Monitor;
use super::overlap::Split;
use super::settings::Settings;

/// References a task bins.
const BIN_CHUNK: usize = 8192;
/// Masks that [`SPREAD`] may be summed over.
const MOST_SPREAD: usize = 255;
/// Per mask of children, a byte of 1 or 0 for each: so that eight counters take one addition.
const SPREAD: [u64; 256] = {
    let mut spread = [0; 256];
    let mut at = 0;
    while at < 8 * 256 {
        let (mask, child) = (at / 8, at % 8);
        spread[mask] |= (mask as u64 >> child & 1) << (8 * child);
        at += 1;
    }
    spread
};

/// A node of the tree; a leaf has no children but a run of references.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) key: Key,
    /// The first of eight children, or [`NONE`].
    pub(crate) children: u32,
    start: usize,
    len: usize,
}

impl Node {
    pub(crate) fn is_leaf(&self) -> bool {
        self.children == NONE
    }

    /// Whether a leaf lists anything.
    pub(crate) fn lists(&self) -> bool {
        self.len > 0
    }
}

/// A balanced tree and, leaf by leaf, the triangles that each lists.
pub(crate) struct Tree {
    /// Parents before children.
    pub(crate) nodes: Vec<Node>,
    references: Vec<u32>,
    /// References of all leaves.
    pub(crate) live: usize,
}

/// A node that is not decided yet, with its references' run in the level's list.
struct Open {
    node: u32,
    start: usize,
    len: usize,
}

/// What splitting an open node would give.
struct Proposal {
    /// How many references each child gets, from each run of [`BIN_CHUNK`].
    chunks: Vec<[usize; 8]>,
    gain: f32,
}

impl Proposal {
    fn counts(&self) -> [usize; 8] {
        self.chunks.iter().fold([0; 8], |sums, counts| core::array::from_fn(|child| sums[child] + counts[child]))
    }

    fn copies(&self) -> usize {
        self.chunks.as_flattened().iter().sum()
    }
}

impl Tree {
    /// References of a leaf.
    pub(crate) fn references(&self, leaf: &Node) -> &[u32] {
        &self.references[leaf.start..leaf.start + leaf.len]
    }

    /// Splits the root cell over all triangles; the leaves list no more than `budget` references.
    pub(crate) fn grow(
        frame: &Frame,
        triangles: &[Triangle],
        budget: usize,
        settings: &Settings,
        monitor: &Monitor<'_>,
    ) -> Result<Self, BuildError> {
        let root = Node { key: Key::ROOT, children: NONE, start: 0, len: 0 };
        let mut tree = Self { nodes: vec![root], references: Vec::new(), live: 0 };
        let mut grower = Grower { frame, triangles, budget, settings, tree: &mut tree, total: triangles.len() };
        let mut references: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut open = vec![Open { node: 0, start: 0, len: triangles.len() }];
        while !open.is_empty() {
            monitor.check(grower.tree.live as f32 / grower.total.max(1) as f32)?;
            (open, references) = grower.split_level(&open, &references, monitor)?;
        }
        Ok(tree)
    }

    /// The deepest node, no deeper than the cell's level, that holds a cell.
    fn holder(&self, cell: Key) -> u32 {
        let mut at = 0;
        for level in 0..cell.level {
            let node = &self.nodes[at as usize];
            if node.is_leaf() {
                break;
            }
            at = node.children + Key::octant_towards(LATTICE >> level, cell.corner);
        }
        at
    }
}

struct Grower<'a> {
    frame: &'a Frame,
    triangles: &'a [Triangle],
    budget: usize,
    settings: &'a Settings,
    tree: &'a mut Tree,
    /// References in leaves and open nodes.
    total: usize,
}

impl Grower<'_> {
    /// Decides all open nodes of one level; returns the children of those that were split.
    fn split_level(
        &mut self,
        open: &[Open],
        references: &[u32],
        monitor: &Monitor<'_>,
    ) -> Result<(Vec<Open>, Vec<u32>), BuildError> {
        let mut masks = vec![0u8; references.len()];
        let mut proposals: Vec<Option<Proposal>> = self.propose(open, references, &mut masks, monitor)?;
        self.accept(open, &mut proposals);

        let children = open.iter().zip(&proposals).filter_map(|(open, proposal)| Some((open, proposal.as_ref()?)));
        let (mut next, mut end) = (Vec::new(), 0);
        for (open, proposal) in children {
            let first = self.tree.nodes[open.node as usize].children;
            for (child, len) in (first..).zip(proposal.counts()) {
                next.push(Open { node: child, start: end, len });
                end += len;
            }
        }
        self.check_memory(references.len() + end)?;
        let mut next_references = vec![0u32; end];
        scatter(open, &proposals, references, &masks, &mut next_references);
        for (open, proposal) in open.iter().zip(&proposals) {
            if proposal.is_none() {
                self.close(open.node, &references[open.start..open.start + open.len]);
            }
        }
        Ok((next, next_references))
    }

    /// A leaf for good, unless balance splits it.
    fn close(&mut self, node: u32, references: &[u32]) {
        let tree = &mut *self.tree;
        let node = &mut tree.nodes[node as usize];
        (node.start, node.len) = (tree.references.len(), references.len());
        tree.references.extend_from_slice(references);
        tree.live += references.len();
    }

    /// Bins the references of every node that a split could help, and weighs it.
    fn propose(
        &self,
        open: &[Open],
        references: &[u32],
        masks: &mut [u8],
        monitor: &Monitor<'_>,
    ) -> Result<Vec<Option<Proposal>>, BuildError> {
        let mut rest = masks;
        let runs: Vec<_> = open
            .iter()
            .map(|open| {
                let (run, tail) = core::mem::take(&mut rest).split_at_mut(open.len);
                rest = tail;
                (open, run)
            })
            .collect();
        runs.into_par_iter()
            .map(|(open, masks)| {
                let key = self.tree.nodes[open.node as usize].key;
                if key.level >= self.settings.max_level || !self.may_gain(open.len) {
                    return Ok(None);
                }
                let references = &references[open.start..open.start + open.len];
                let chunks = references.par_chunks(BIN_CHUNK).zip(masks.par_chunks_mut(BIN_CHUNK));
                let bin = |(references, masks): (&[u32], &mut [u8])| {
                    monitor.check_cancelled()?;
                    Ok(self.bin(key, references, masks))
                };
                let chunks: Vec<[usize; 8]> = chunks.map(bin).collect::<Result<_, _>>()?;
                let gain = self.gain(open.len, chunks.as_flattened().iter().sum());
                Ok((gain > 0.0).then_some(Proposal { chunks, gain }))
            })
            .collect()
    }

    fn bin(&self, cell: Key, references: &[u32], masks: &mut [u8]) -> [usize; 8] {
        let split = Split::new(self.frame, cell, self.settings.padding());
        let mut counts = [0; 8];
        for (references, masks) in references.chunks(MOST_SPREAD).zip(masks.chunks_mut(MOST_SPREAD)) {
            let mut spread = 0;
            for (&reference, mask) in references.iter().zip(masks) {
                *mask = split.children_met(&self.triangles[reference as usize].corners);
                spread += SPREAD[*mask as usize];
            }
            for (count, byte) in counts.iter_mut().zip(spread.to_le_bytes()) {
                *count += usize::from(byte);
            }
        }
        counts
    }

    /// Whether a split could gain anything: it does most where no triangle lies in two children.
    fn may_gain(&self, len: usize) -> bool {
        self.gain(len, len) > 0.0
    }

    /// Expected cost saved, in triangle tests of a ray through the cell: a child is met by a quarter of the rays that
    /// meet its parent, so n triangles in `copies` child references cost a quarter of the copies, and one more step.
    fn gain(&self, len: usize, copies: usize) -> f32 {
        len as f32 - 0.25 * copies as f32 - self.settings.step_cost
    }

    /// Splits the nodes whose proposal pays, forced splits of coarser neighbours included, within the budget; clears
    /// the other proposals.
    fn accept(&mut self, open: &[Open], proposals: &mut [Option<Proposal>]) {
        let added =
            |(open, proposal): (&Open, &Option<Proposal>)| proposal.as_ref().map_or(0, |p| p.copies() - open.len);
        let wanted: usize = open.iter().zip(proposals.iter()).map(added).sum();
        let mut order: Vec<usize> = (0..open.len()).filter(|&i| proposals[i].is_some()).collect();
        if self.total + wanted > self.budget {
            // The best first, by gain a reference.
            let worth = |i: usize| {
                let gain = proposals[i].as_ref().map_or(0.0, |p| p.gain);
                gain / added((&open[i], &proposals[i])).max(1) as f32
            };
            order.sort_by(|&a, &b| worth(b).total_cmp(&worth(a)).then(a.cmp(&b)));
        }
        for i in order {
            let Some(proposal) = &proposals[i] else { continue };
            let growth = added((&open[i], &proposals[i]));
            let forced = self.forced_by(open[i].node);
            // A coarser leaf has four such neighbours on a face, and the cost of splitting it is shared among them.
            let charge = forced.len() as f32 * self.settings.step_cost;
            let splits: Vec<_> = if proposal.gain > charge { self.bin_all(&forced) } else { Vec::new() };
            let forced_growth: usize =
                splits.iter().map(|(len, parts)| parts.iter().map(Vec::len).sum::<usize>() - len).sum();
            let total = self.total + growth + forced_growth;
            if proposal.gain <= charge || total > self.budget {
                proposals[i] = None;
                continue;
            }
            self.total = total;
            for (node, (_, parts)) in forced.into_iter().zip(splits) {
                let children = self.add_children(node);
                self.tree.live -= self.tree.nodes[node as usize].len;
                for (child, part) in (children..).zip(parts) {
                    self.close(child, &part);
                }
            }
            self.add_children(open[i].node);
        }
    }

    fn add_children(&mut self, node: u32) -> u32 {
        let nodes = &mut self.tree.nodes;
        let (key, first) = (nodes[node as usize].key, nodes.len() as u32);
        nodes.extend((0..8).map(|octant| Node { key: key.child(octant), children: NONE, start: 0, len: 0 }));
        nodes[node as usize].children = first;
        first
    }

    /// The leaves that must be split before a node may have children, coarsest first.
    fn forced_by(&self, node: u32) -> Vec<u32> {
        let mut forced = Vec::new();
        let mut pending = vec![node];
        while let Some(node) = pending.pop() {
            let key = self.tree.nodes[node as usize].key;
            for across in (0..6).filter_map(|face| key.across(face)) {
                let holder = self.tree.holder(across);
                let is_coarser = self.tree.nodes[holder as usize].key.level < key.level;
                if is_coarser && !forced.contains(&holder) {
                    forced.push(holder);
                    pending.push(holder);
                }
            }
        }
        forced.sort_by_key(|&node| (self.tree.nodes[node as usize].key.level, node));
        forced
    }

    /// The references of each leaf, child by child.
    fn bin_all(&self, leaves: &[u32]) -> Vec<(usize, [Vec<u32>; 8])> {
        let bin = |&leaf: &u32| {
            let node = &self.tree.nodes[leaf as usize];
            let split = Split::new(self.frame, node.key, self.settings.padding());
            let mut parts: [Vec<u32>; 8] = Default::default();
            for &reference in self.tree.references(node) {
                let met = split.children_met(&self.triangles[reference as usize].corners);
                for (child, part) in parts.iter_mut().enumerate() {
                    if met >> child & 1 == 1 {
                        part.push(reference);
                    }
                }
            }
            (node.len, parts)
        };
        leaves.iter().map(bin).collect()
    }

    /// What the words and the lists in use will take, before either is allocated.
    fn check_memory(&self, lists: usize) -> Result<(), BuildError> {
        const BYTES_PER_LISTED: u64 = 5;
        // A reference is a number here, and then a block and its box where leaves are listed.
        const BYTES_PER_REFERENCE: u64 = 4 + 20;
        // An item of the hierarchy and a number of its block; and 40 bytes in a block, with what leads there.
        const BYTES_PER_TRIANGLE: u64 = 32 + 8 + 50;
        // A node here, and its record, key and payload.
        const BYTES_PER_NODE: u64 = 200;
        let bytes = lists as u64 * BYTES_PER_LISTED
            + self.total as u64 * BYTES_PER_REFERENCE
            + self.tree.nodes.len() as u64 * BYTES_PER_NODE
            + self.triangles.len() as u64 * (BYTES_PER_TRIANGLE + size_of::<Triangle>() as u64);
        self.settings.check_memory(bytes)
    }
}

/// A run of a split node's references, and where each child's go.
struct Run<'a> {
    references: &'a [u32],
    masks: &'a [u8],
    lists: [&'a mut [u32]; 8],
}

impl Run<'_> {
    fn scatter(self) {
        let mut ends = [0; 8];
        for (&reference, &mask) in self.references.iter().zip(self.masks) {
            let mut met = mask;
            while met != 0 {
                let child = met.trailing_zeros() as usize;
                self.lists[child][ends[child]] = reference;
                ends[child] += 1;
                met &= met - 1;
            }
        }
    }
}

/// Copies the references of split nodes to their children, in order.
fn scatter(open: &[Open], proposals: &[Option<Proposal>], references: &[u32], masks: &[u8], to: &mut [u32]) {
    let mut rest = to;
    let mut runs: Vec<Run<'_>> = Vec::new();
    for (open, proposal) in open.iter().zip(proposals) {
        let Some(proposal) = proposal else { continue };
        let all = open.start..open.start + open.len;
        let chunks = references[all.clone()].chunks(BIN_CHUNK).zip(masks[all].chunks(BIN_CHUNK));
        let first = runs.len();
        runs.extend(chunks.map(|(references, masks)| Run { references, masks, lists: Default::default() }));
        for child in 0..8 {
            for (run, counts) in runs[first..].iter_mut().zip(&proposal.chunks) {
                (run.lists[child], rest) = core::mem::take(&mut rest).split_at_mut(counts[child]);
            }
        }
    }
    runs.into_par_iter().for_each(Run::scatter);
}
