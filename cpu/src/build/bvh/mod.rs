//! The hierarchy over all triangles: split by the surface area heuristic down to blocks of eight, eight children a node.
//!
//! ```text
//! node(triangles):
//!     part the triangles in two, then the part of the largest area again, until there are eight parts
//!     put the parts into slots by octant
//!     a part of eight triangles or fewer is a block; any other is a node in its turn
//! ```

mod item;
mod lattices;
mod slots;
mod split;

use leafwalk_core::Frame;
use leafwalk_core::layout::{BLOCK_WIDTH, BVH_WIDTH, BvhNode, Child, Lattice, LatticeBox, MAX_DEPTH, Triangle};
use rayon::prelude::*;
use wide::f32x4;

use super::bounds::Bounds;
use super::settings::Spoiled;
use super::span::{Span, lanes, steps};
use item::{Item, Part};
pub(super) use slots::by_octant;
use split::{by_area, by_number};

/// BVH nodes above it split by area, those below by number, so that no scene is deeper than [`MAX_DEPTH`]: ten levels of
/// eight part 2^32 triangles into blocks.
const BY_AREA: usize = MAX_DEPTH - 10;
/// The share of a node's surface below which a part is not parted any more: its parts would be of few steps of the node's
/// lattice, and have one of their own as a node's children.
const LEAST_AREA: f32 = 1.0 / (1 << 20) as f32;
/// Triangles for which a second thread is worth its while.
const PARALLEL: usize = 16 * 1024;

/// The hierarchy over all triangles.
pub(crate) struct Hierarchy {
    /// In the order of the file; none for no triangles.
    pub(crate) nodes: Vec<BvhNode>,
    /// One a node in wide scenes, else none.
    pub(crate) lattices: Vec<Lattice>,
    /// The triangles of the blocks, by their places in the list of all, block after block.
    pub(crate) triangles: Vec<u32>,
    /// Where the triangles of each block start, and where the last one's end.
    pub(crate) starts: Vec<u32>,
}

impl Hierarchy {
    pub(crate) fn grow(frame: &Frame, triangles: &[Triangle], spoiled: Spoiled) -> Self {
        let mut items: Vec<Item> =
            triangles.par_iter().enumerate().map(|(number, triangle)| Item::new(number as u32, triangle)).collect();
        let mut hierarchy = Self::empty();
        if items.is_empty() {
            return hierarchy;
        }
        let part = Part::new(&mut items);
        let grower = Grower { root: lanes(frame.corner), spoiled };
        hierarchy.nodes.push(BvhNode::VACANT);
        grower.node(part, 0, 0, &mut hierarchy);
        hierarchy.enclose();
        hierarchy.widen(frame, triangles, spoiled);
        hierarchy
    }

    fn empty() -> Self {
        Self { nodes: Vec::new(), lattices: Vec::new(), triangles: Vec::new(), starts: vec![0] }
    }

    pub(crate) fn block_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The triangles of a block.
    fn block(&self, number: u32) -> &[u32] {
        let end = |at: u32| self.starts[at as usize] as usize;
        &self.triangles[end(number)..end(number + 1)]
    }

    /// The triangles of all blocks.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|ends| &self.triangles[ends[0] as usize..ends[1] as usize])
    }

    /// [`Hierarchy::blocks`], for threads.
    pub(crate) fn par_blocks(&self) -> impl IndexedParallelIterator<Item = &[u32]> {
        self.starts.par_windows(2).map(|ends| &self.triangles[ends[0] as usize..ends[1] as usize])
    }

    /// Adds a block, and gives its number.
    fn add_block(&mut self, items: &[Item]) -> u32 {
        let first = self.triangles.len();
        self.triangles.extend(items.iter().map(Item::triangle));
        // Ascending, so that the block's bytes do not depend on how it was found.
        self.triangles[first..].sort_unstable();
        self.starts.push(self.triangles.len() as u32);
        self.block_count() as u32 - 1
    }

    /// Puts the first node of another hierarchy in its place, and all others, and all blocks, behind those that there are.
    fn graft(&mut self, other: &Self, at: usize) {
        // Number 1 of the other becomes the next one here.
        let (nodes, blocks) = (self.nodes.len() as u32 - 1, self.block_count() as u32);
        let mut renumbered = other.nodes.iter().map(|node| {
            let moved = |word| match Child::from_word(word) {
                Child::Node(number) => Child::Node(number + nodes).to_word(),
                Child::Block(number) => Child::Block(number + blocks).to_word(),
                Child::Vacant => word,
            };
            BvhNode { children: node.children.map(moved), ..*node }
        });
        self.nodes[at] = renumbered.next().unwrap_or(BvhNode::VACANT);
        self.nodes.extend(renumbered);
        let before = self.triangles.len() as u32;
        self.triangles.extend_from_slice(&other.triangles);
        self.starts.extend(other.starts[1..].iter().map(|end| before + end));
    }

    /// Gives each child that is a node the box around that node's own children.
    fn enclose(&mut self) {
        for at in (0..self.nodes.len()).rev() {
            for slot in 0..BVH_WIDTH {
                if let (_, Child::Node(child)) = self.nodes[at].child(slot) {
                    // Its number is larger, so its boxes are final.
                    let hull = self.nodes[child as usize].hull();
                    self.nodes[at].put(slot, hull, Child::Node(child));
                }
            }
        }
    }
}

struct Grower {
    root: f32x4,
    spoiled: Spoiled,
}

impl Grower {
    /// Fills a node over one triangle or more, and puts those below it behind all others.
    fn node(&self, part: Part<'_>, depth: usize, at: usize, hierarchy: &mut Hierarchy) {
        let is_parallel = part.items.len() >= PARALLEL && rayon::current_num_threads() > 1;
        let mut next = hierarchy.nodes.len();
        let mut inner = Vec::new();
        let parts = parts(part, depth);
        let mut centres = [[0.0; 3]; BVH_WIDTH];
        for (centre, part) in centres.iter_mut().zip(&parts) {
            let [x, y, z, _] = (part.bounds.lower + part.bounds.upper).to_array();
            *centre = [x, y, z];
        }
        let slots = by_octant(&centres[..parts.len()]);
        let mut in_slots = [const { None }; BVH_WIDTH];
        for (part, slot) in parts.into_iter().zip(slots) {
            in_slots[slot] = Some(part);
        }
        for (slot, part) in in_slots.into_iter().enumerate() {
            let Some(part) = part else { continue };
            if part.items.len() <= BLOCK_WIDTH {
                let block = hierarchy.add_block(part.items);
                hierarchy.nodes[at].put(slot, self.boxed(part.bounds), Child::Block(block));
            } else {
                let number = hierarchy.nodes.len() as u32;
                hierarchy.nodes.push(BvhNode::VACANT);
                // The box follows when all that it holds is known.
                hierarchy.nodes[at].put(slot, LatticeBox::EMPTY, Child::Node(number));
                inner.push(part);
            }
        }
        if is_parallel {
            let grow = |part| {
                let mut below = Hierarchy::empty();
                below.nodes.push(BvhNode::VACANT);
                self.node(part, depth + 1, 0, &mut below);
                below
            };
            for below in inner.into_par_iter().map(grow).collect::<Vec<_>>() {
                hierarchy.graft(&below, next);
                next += 1;
            }
        } else {
            for part in inner {
                self.node(part, depth + 1, next, hierarchy);
                next += 1;
            }
        }
    }

    /// The lattice steps that a box touches.
    fn boxed(&self, bounds: Span) -> LatticeBox {
        self.spoiled.boxed(Bounds::of_steps(steps(bounds.lower - self.root), steps(bounds.upper - self.root)))
    }
}

/// Parts triangles again and again where it pays most, until there are as many parts as a node has slots.
fn parts(part: Part<'_>, depth: usize) -> Vec<Part<'_>> {
    let least = LEAST_AREA * part.bounds.area();
    let worth = |Part { bounds, items }: &Part<'_>| match items.len() {
        0..=BLOCK_WIDTH => f32::NEG_INFINITY,
        _ if depth < BY_AREA && bounds.area() < least => f32::NEG_INFINITY,
        _ if depth < BY_AREA => bounds.area(),
        count => count as f32,
    };
    let mut parts = Vec::with_capacity(BVH_WIDTH);
    let mut worths = [f32::NEG_INFINITY; BVH_WIDTH];
    worths[0] = worth(&part);
    parts.push(part);
    while parts.len() < BVH_WIDTH {
        let (mut most, mut widest) = (f32::NEG_INFINITY, 0);
        for (at, &worth) in worths[..parts.len()].iter().enumerate() {
            if worth >= most {
                (most, widest) = (worth, at);
            }
        }
        if most == f32::NEG_INFINITY {
            break;
        }
        let part = parts.swap_remove(widest);
        worths[widest] = worths[parts.len()];
        for part in if depth < BY_AREA { by_area(part) } else { by_number(part.items) } {
            worths[parts.len()] = worth(&part);
            parts.push(part);
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(nodes: &[BvhNode], at: u32) -> usize {
        let below = |slot| match nodes[at as usize].child(slot).1 {
            Child::Node(child) => depth(nodes, child),
            _ => 0,
        };
        1 + (0..BVH_WIDTH).map(below).max().unwrap_or(0)
    }

    /// A triangle whose box reaches from a point to another.
    fn triangle(primitive: u32, lower: [f32; 3], upper: [f32; 3]) -> Triangle {
        Triangle { primitive, corners: [lower, upper, [lower[0], upper[1], lower[2]]] }
    }

    fn grow(triangles: &[Triangle]) -> Hierarchy {
        let frame = Frame { anchor: [0.0; 3], corner: [0.0; 3], scale_exponent: 16 };
        Hierarchy::grow(&frame, triangles, Spoiled::Nothing)
    }

    #[test]
    fn no_scene_is_too_deep() {
        // Boxes of one corner, each twice as large as the next: by area, the largest comes off first, every time.
        let nested = |i: u32| {
            let size = 2f64.powf(15.0 - f64::from(i) * 60.0 / 20_000.0) as f32;
            triangle(i, [0.0; 3], [size; 3])
        };
        // And thousands in one place.
        let equal = |i| triangle(i, [7.0; 3], [8.0; 3]);
        let triangles: Vec<Triangle> = (0..20_000).map(nested).chain((20_000..25_000).map(equal)).collect();
        let hierarchy = grow(&triangles);
        assert!(depth(&hierarchy.nodes, 0) <= MAX_DEPTH, "{}", depth(&hierarchy.nodes, 0));
        let children = hierarchy.nodes.iter().flat_map(|node| (0..BVH_WIDTH).map(|slot| node.child(slot).1));
        let mut blocks: Vec<u32> =
            children.filter_map(|child| if let Child::Block(block) = child { Some(block) } else { None }).collect();
        blocks.sort_unstable();
        assert!(blocks.into_iter().eq(0..hierarchy.block_count() as u32));
        let mut listed = hierarchy.triangles.clone();
        listed.sort_unstable();
        assert!(listed.into_iter().eq(0..25_000));
        assert!(hierarchy.blocks().all(|block| (1..=BLOCK_WIDTH).contains(&block.len())));
    }

    #[test]
    fn slots_follow_octants() {
        let corner = |slot: u32| core::array::from_fn(|k| (1000 * (slot >> k & 1)) as f32);
        // Eight of each, numbered against the octants, so that the order they come in does not serve.
        let at = |i: u32| triangle(i, corner(7 - i / 8), corner(7 - i / 8).map(|c: f32| c + 10.0));
        let hierarchy = grow(&(0..64).map(at).collect::<Vec<_>>());
        assert_eq!(hierarchy.nodes.len(), 1);
        for slot in 0..8 {
            let (_, Child::Block(block)) = hierarchy.nodes[0].child(slot) else { panic!("a block is to be here") };
            let of_octant = 8 * (7 - slot as u32);
            assert!(
                hierarchy
                    .blocks()
                    .nth(block as usize)
                    .expect("its triangles")
                    .iter()
                    .copied()
                    .eq(of_octant..of_octant + 8)
            );
        }
    }
}
