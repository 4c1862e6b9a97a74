//! The hierarchy over the blocks: split by the surface area heuristic (Wald 2007, binned), eight children a node.

use leafwalk_core::layout::{BVH_WIDTH, BvhNode, Child, MAX_DEPTH, Payload};
use rayon::prelude::*;
use wide::{f32x4, i32x4};

use super::bounds::Bounds;

/// Candidate planes an axis, less one.
const BINS: usize = 16;
/// BVH nodes above it split by area, those below by number, so that no scene is deeper than [`MAX_DEPTH`]: ten levels of
/// eight hold 2^30 blocks.
const BY_AREA: usize = MAX_DEPTH - 10;
/// Blocks for which a second thread is worth its while.
const PARALLEL: usize = 2048;

/// A block to be put somewhere.
#[derive(Clone, Copy, Debug)]
struct Item {
    bounds: Bounds,
    /// The centre of the bounds, and the block's number beside it.
    place: i32x4,
}

impl Item {
    fn new(block: u32, bounds: Bounds) -> Self {
        let [x, y, z] = bounds.centre();
        Self { bounds, place: i32x4::new([x, y, z, block as i32]) }
    }

    fn block(&self) -> u32 {
        self.place.to_array()[3] as u32
    }
}

fn around(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::EMPTY, |bounds, item| bounds.join(item.bounds))
}

/// Some blocks and the box around them.
type Part<'a> = (Bounds, &'a mut [Item]);

/// The nodes over all blocks that payloads list; none for none.
pub(crate) fn grow(payloads: &[Payload]) -> Vec<BvhNode> {
    let numbered = |payload: &Payload| {
        let payload = *payload;
        (0..payload.count).map(move |b| Item::new(payload.first + b, Bounds::new(payload.boxed(b as usize))))
    };
    let mut items: Vec<Item> = payloads.iter().flat_map(numbered).collect();
    if items.is_empty() {
        return Vec::new();
    }
    let bounds = around(&items);
    subtree((bounds, &mut items), 0)
}

/// A node over one block or more, and those below it, numbered from 0.
fn subtree(part: Part<'_>, depth: usize) -> Vec<BvhNode> {
    let mut nodes = vec![BvhNode::VACANT];
    node(part, depth, 0, &mut nodes);
    nodes
}

/// Fills a node, and puts those below it behind all others.
fn node(part: Part<'_>, depth: usize, at: usize, nodes: &mut Vec<BvhNode>) {
    let is_parallel = part.1.len() >= PARALLEL && rayon::current_num_threads() > 1;
    let mut next = nodes.len();
    let mut inner = Vec::new();
    for (slot, part) in in_slots(parts(part, depth)).into_iter().enumerate() {
        let Some((bounds, items)) = part else { continue };
        let child = match items {
            [item] => Child::Block(item.block()),
            _ => {
                nodes.push(BvhNode::VACANT);
                inner.push((bounds, items));
                Child::Node(nodes.len() as u32 - 1)
            }
        };
        nodes[at].put(slot, bounds.boxed(), child);
    }
    if is_parallel {
        let grown: Vec<Vec<BvhNode>> = inner.into_par_iter().map(|part| subtree(part, depth + 1)).collect();
        for own in grown {
            graft(&own, next, nodes);
            next += 1;
        }
    } else {
        for part in inner {
            node(part, depth + 1, next, nodes);
            next += 1;
        }
    }
}

/// Puts the first node of a subtree in its place, and the others behind all.
fn graft(subtree: &[BvhNode], at: usize, nodes: &mut Vec<BvhNode>) {
    // Number 1 of the subtree becomes the next one here.
    let before = nodes.len() as u32 - 1;
    let mut renumbered = subtree.iter().map(|node| {
        let moved = |word| match Child::from_word(word) {
            Child::Node(number) => Child::Node(number + before).to_word(),
            _ => word,
        };
        BvhNode { children: node.children.map(moved), ..*node }
    });
    nodes[at] = renumbered.next().unwrap_or(BvhNode::VACANT);
    nodes.extend(renumbered);
}

/// Parts blocks again and again where it pays most, until there are as many parts as a node has slots.
fn parts(part: Part<'_>, depth: usize) -> Vec<Part<'_>> {
    let worth = |(bounds, items): &Part<'_>| match items.len() {
        1 => f32::NEG_INFINITY,
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
        let (_, items) = parts.swap_remove(widest);
        worths[widest] = worths[parts.len()];
        let (middle, bounds) = if depth < BY_AREA { by_area(items) } else { by_number(items) };
        let (left, right) = items.split_at_mut(middle);
        for part in bounds.into_iter().zip([left, right]) {
            worths[parts.len()] = worth(&part);
            parts.push(part);
        }
    }
    parts
}

/// Puts each part into the free octant that it lies in most of all; those far from the middle come first.
fn in_slots(parts: Vec<Part<'_>>) -> [Option<Part<'_>>; BVH_WIDTH] {
    let all = parts.iter().fold(Bounds::EMPTY, |all, part| all.join(part.0)).centre();
    let mut offs = [([0.0f32; 3], 0.0); BVH_WIDTH];
    for ((bounds, _), off) in parts.iter().zip(&mut offs) {
        let centre = bounds.centre();
        let from_middle: [f32; 3] = core::array::from_fn(|k| (centre[k] - all[k]) as f32);
        *off = (from_middle, from_middle.iter().map(|c| c.abs()).sum());
    }
    let mut order: [usize; BVH_WIDTH] = core::array::from_fn(|i| i);
    order[..parts.len()].sort_by(|&a, &b| offs[b].1.total_cmp(&offs[a].1));
    let mut slot_of = [0; BVH_WIDTH];
    let mut free = [true; BVH_WIDTH];
    for &part in &order[..parts.len()] {
        let [x, y, z] = offs[part].0;
        let mut best = (f32::NEG_INFINITY, 0);
        for slot in (0..BVH_WIDTH).filter(|slot| free[*slot]) {
            let toward = |k: usize, c: f32| if slot >> k & 1 == 1 { c } else { -c };
            let along = toward(0, x) + toward(1, y) + toward(2, z);
            if along >= best.0 {
                best = (along, slot);
            }
        }
        (slot_of[part], free[best.1]) = (best.1, false);
    }
    let mut slots = [const { None }; BVH_WIDTH];
    for (part, slot) in parts.into_iter().zip(slot_of) {
        slots[slot] = Some(part);
    }
    slots
}

/// What falls into a bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, count: 0 };

    #[inline]
    fn join(self, other: Self) -> Self {
        Self { bounds: self.bounds.join(other.bounds), count: self.count + other.count }
    }

    fn all(bins: &[Self]) -> Self {
        bins.iter().fold(Self::EMPTY, |all, bin| all.join(*bin))
    }

    /// Expected tests of a ray that meets the parent, but for a factor; of a bin that is not empty.
    #[inline]
    fn cost(self) -> f32 {
        self.bounds.area() * self.count as f32
    }
}

/// Which of the bins between the outermost centres a centre falls into, axis by axis.
struct Binning {
    low: i32x4,
    scale: f32x4,
}

impl Binning {
    #[inline]
    fn bins_of(&self, item: &Item) -> [usize; 3] {
        let bins = ((item.place - self.low).round_float() * self.scale).fast_trunc_int();
        let [x, y, z, _] = bins.to_array();
        // Below their number already: the extent is at most 2^18 and its scale rounded to 2^-24.
        [x, y, z].map(|bin| (bin as usize).min(BINS - 1))
    }
}

/// Parts two blocks or more at the best of the planes between bins; returns how many come first, and the boxes around both
/// parts.
fn by_area(items: &mut [Item]) -> (usize, [Bounds; 2]) {
    let first = items[0].place;
    let (low, high) =
        items.iter().fold((first, first), |(low, high), item| (low.min(item.place), high.max(item.place)));
    let extent = (high - low).to_array();
    if let [a, b] = items {
        // Any plane between them serves.
        let axis = (0..3).find(|k| extent[*k] > 0);
        if axis.is_some_and(|k| a.place.to_array()[k] > b.place.to_array()[k]) {
            core::mem::swap(a, b);
        }
        return (1, [a.bounds, b.bounds]);
    }
    // Few blocks fill few bins.
    let used = BINS.min(2 * items.len());
    let scale = |k: usize| used as f32 / (extent[k] + 1) as f32;
    let binning = Binning { low, scale: f32x4::new([scale(0), scale(1), scale(2), 0.0]) };
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    for item in items.iter() {
        for (bins, at) in bins.iter_mut().zip(binning.bins_of(item)) {
            bins[at] = bins[at].join(Bin { bounds: item.bounds, count: 1 });
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for (k, bins) in bins.iter().enumerate().filter(|(k, _)| extent[*k] > 0) {
        // A plane behind an empty bin parts the blocks as the one before does.
        let is_new = |plane: usize| bins[plane - 1].count > 0;
        let mut costs_above = [0.0; BINS];
        let mut above = Bin::EMPTY;
        for plane in (1..used).rev() {
            above = above.join(bins[plane]);
            if is_new(plane) {
                costs_above[plane] = above.cost();
            }
        }
        let mut below = Bin::EMPTY;
        for plane in (1..used).filter(|plane| is_new(*plane)) {
            below = below.join(bins[plane - 1]);
            let cost = below.cost() + costs_above[plane];
            if cost < best.0 {
                best = (cost, k, plane);
            }
        }
    }
    let (cost, k, plane) = best;
    if cost == f32::INFINITY {
        // All in one place.
        return halves(items);
    }
    let mut first = 0;
    for at in 0..items.len() {
        if binning.bins_of(&items[at])[k] < plane {
            items.swap(first, at);
            first += 1;
        }
    }
    let (below, above) = bins[k][..used].split_at(plane);
    (first, [Bin::all(below).bounds, Bin::all(above).bounds])
}

/// Parts blocks into halves along the longest axis of their centres.
fn by_number(items: &mut [Item]) -> (usize, [Bounds; 2]) {
    let centres = |k: usize| items.iter().map(move |item| item.place.to_array()[k]);
    let extent = |k: usize| centres(k).max().unwrap_or(0) - centres(k).min().unwrap_or(0);
    let axis = (0..3).max_by_key(|&k| extent(k)).unwrap_or(0);
    items.select_nth_unstable_by_key(items.len() / 2, |item| (item.place.to_array()[axis], item.block()));
    halves(items)
}

/// The halves of blocks in their order.
fn halves(items: &[Item]) -> (usize, [Bounds; 2]) {
    let middle = items.len() / 2;
    let (left, right) = items.split_at(middle);
    (middle, [left, right].map(around))
}

#[cfg(test)]
mod tests {
    use leafwalk_core::layout::LatticeBox;

    use super::*;

    fn payload(boxes: &[LatticeBox], first: u32) -> Payload {
        Payload {
            first,
            ..Payload::of_boxes(core::array::from_fn(|b| boxes.get(b).copied().unwrap_or(LatticeBox::EMPTY)))
        }
    }

    fn depth(nodes: &[BvhNode], at: u32) -> usize {
        let below = |slot| match nodes[at as usize].child(slot).1 {
            Child::Node(child) => depth(nodes, child),
            _ => 0,
        };
        1 + (0..BVH_WIDTH).map(below).max().unwrap_or(0)
    }

    #[test]
    fn no_scene_is_too_deep() {
        // Boxes of one corner, each twice as large as the next: by area, the largest comes off first, every time.
        let mut payloads = Vec::new();
        for i in 0..20_000u32 {
            let size = (2f64.powf(16.0 - f64::from(i) * 16.0 / 20_000.0)) as u32 - 1;
            payloads.push(payload(&[LatticeBox { lower: [0; 3], upper: [size as u16; 3] }], i));
        }
        // And thousands in one place.
        payloads.extend((20_000..25_000).map(|i| payload(&[LatticeBox { lower: [7; 3], upper: [7; 3] }], i)));
        let nodes = grow(&payloads);
        assert!(depth(&nodes, 0) <= MAX_DEPTH, "{}", depth(&nodes, 0));
        let mut blocks: Vec<u32> = Vec::new();
        for node in &nodes {
            blocks.extend((0..BVH_WIDTH).filter_map(|slot| match node.child(slot).1 {
                Child::Block(block) => Some(block),
                _ => None,
            }));
        }
        blocks.sort_unstable();
        assert!(blocks.into_iter().eq(0..25_000));
    }

    #[test]
    fn slots_follow_octants() {
        let corner = |slot: u16| core::array::from_fn(|k| 1000 * (slot >> k & 1));
        // Numbered against the octants, so that the order they come in does not serve.
        let boxes: Vec<LatticeBox> = (0..8)
            .map(|slot| LatticeBox { lower: corner(7 - slot), upper: corner(7 - slot).map(|c: u16| c + 10) })
            .collect();
        let nodes = grow(&[payload(&boxes, 0)]);
        assert_eq!(nodes.len(), 1);
        for slot in 0..8 {
            assert_eq!(nodes[0].child(slot).1, Child::Block(7 - slot as u32));
        }
    }
}
