//! The hierarchy over the blocks: split by the surface area heuristic (Wald 2007, binned), eight children a branch.

use leafwalk_core::layout::{BRANCH_WIDTH, Branch, Child, LatticeBox, MAX_DEPTH, Payload, hull};
use rayon::prelude::*;

/// Candidate planes an axis, less one.
const BINS: usize = 16;
/// Branches above it split by area, those below by number, so that no scene is deeper than [`MAX_DEPTH`]: ten levels of
/// eight hold 2^30 blocks.
const BY_AREA: usize = MAX_DEPTH - 10;
/// Blocks for which a second thread is worth its while.
const PARALLEL: usize = 2048;

/// A box such that the smallest around two of them is the least of each number: lower sides, upper sides negated, nothing.
#[derive(Clone, Copy, Debug)]
struct Bounds([i16; 8]);

impl Bounds {
    const EMPTY: Self = Self([i16::MAX; 8]);

    fn new((lower, upper): LatticeBox) -> Self {
        let [a, b, c] = lower.map(|side| (side ^ 0x8000) as i16);
        let [d, e, f] = upper.map(|side| (!side ^ 0x8000) as i16);
        Self([a, b, c, d, e, f, 0, 0])
    }

    fn boxed(self) -> LatticeBox {
        let [a, b, c, d, e, f, ..] = self.0;
        ([a, b, c].map(|side| side as u16 ^ 0x8000), [d, e, f].map(|side| !(side as u16 ^ 0x8000)))
    }

    /// Eight at once: a loop that compilers turn into one instruction.
    #[inline]
    fn join(self, other: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i].min(other.0[i])))
    }

    /// Half of a box's surface in square lattice steps.
    #[inline]
    fn area(self) -> f32 {
        let extent = |k: usize| -(f32::from(self.0[k]) + f32::from(self.0[k + 3]));
        let [x, y, z] = [extent(0), extent(1), extent(2)];
        x * y + y * z + z * x
    }

    /// Twice the middle.
    #[inline]
    fn centre(self, k: usize) -> i32 {
        i32::from(self.0[k]) - i32::from(self.0[k + 3])
    }
}

/// A block to be put somewhere.
#[derive(Clone, Copy, Debug)]
struct Item {
    bounds: Bounds,
    block: u32,
}

/// A subtree.
enum Grown {
    Block(u32),
    Branch([Option<(LatticeBox, Box<Grown>)>; BRANCH_WIDTH]),
}

/// The branches over all blocks that payloads list; none for none.
pub(crate) fn grow(payloads: &[Payload]) -> Vec<Branch> {
    let boxes =
        payloads.iter().flat_map(|payload| (0..payload.count).map(|b| (payload.first + b, payload.boxed(b as usize))));
    let mut items: Vec<Item> = boxes.map(|(block, boxed)| Item { bounds: Bounds::new(boxed), block }).collect();
    if items.is_empty() {
        return Vec::new();
    }
    let mut branches = vec![Branch::VACANT];
    if let Grown::Branch(children) = branch(&mut items, 0) {
        write(&children, 0, &mut branches);
    }
    branches
}

/// Puts children into a branch and those that are branches behind all others.
fn write(children: &[Option<(LatticeBox, Box<Grown>)>; BRANCH_WIDTH], at: usize, branches: &mut Vec<Branch>) {
    let mut next = branches.len();
    for (slot, child) in children.iter().enumerate() {
        let Some((boxed, grown)) = child else { continue };
        let child = match **grown {
            Grown::Block(block) => Child::Block(block),
            Grown::Branch(_) => {
                branches.push(Branch::VACANT);
                Child::Branch(branches.len() as u32 - 1)
            }
        };
        branches[at].put(slot, *boxed, child);
    }
    for (_, grown) in children.iter().flatten() {
        if let Grown::Branch(children) = &**grown {
            write(children, next, branches);
            next += 1;
        }
    }
}

/// A branch over one block or more.
fn branch(items: &mut [Item], depth: usize) -> Grown {
    let total = items.len();
    let mut parts: Vec<(Bounds, &mut [Item])> = Vec::with_capacity(BRANCH_WIDTH);
    parts.push((around(items), items));
    while parts.len() < BRANCH_WIDTH {
        let worth = |(bounds, items): &(Bounds, &mut [Item])| match items.len() {
            1 => f32::NEG_INFINITY,
            _ if depth < BY_AREA => bounds.area(),
            count => count as f32,
        };
        let widest = (0..parts.len()).max_by(|&a, &b| worth(&parts[a]).total_cmp(&worth(&parts[b])));
        let Some(widest) = widest.filter(|&at| parts[at].1.len() > 1) else { break };
        let (_, items) = parts.swap_remove(widest);
        let middle = if depth < BY_AREA { by_area(items) } else { by_number(items) };
        let (left, right) = items.split_at_mut(middle);
        parts.push((around(left), left));
        parts.push((around(right), right));
    }
    let grow = |(bounds, items): (Bounds, &mut [Item])| match items {
        [item] => (bounds.boxed(), Grown::Block(item.block)),
        items => (bounds.boxed(), branch(items, depth + 1)),
    };
    let grown: Vec<(LatticeBox, Grown)> = if total >= PARALLEL {
        parts.into_par_iter().map(grow).collect()
    } else {
        parts.into_iter().map(grow).collect()
    };
    Grown::Branch(in_slots(grown))
}

/// Puts each child into the free octant that it lies in most of all; those far from the middle come first.
fn in_slots(grown: Vec<(LatticeBox, Grown)>) -> [Option<(LatticeBox, Box<Grown>)>; BRANCH_WIDTH] {
    let middle = |boxed: &LatticeBox, k: usize| f32::from(boxed.0[k]) + f32::from(boxed.1[k]);
    let all = hull(grown.iter().map(|(boxed, _)| *boxed));
    let off = |boxed: &LatticeBox| -> [f32; 3] { core::array::from_fn(|k| middle(boxed, k) - middle(&all, k)) };
    let mut children: Vec<([f32; 3], (LatticeBox, Grown))> =
        grown.into_iter().map(|child| (off(&child.0), child)).collect();
    let distance = |off: &[f32; 3]| off.iter().map(|c| c.abs()).sum::<f32>();
    children.sort_by(|a, b| distance(&b.0).total_cmp(&distance(&a.0)));
    let mut slots = [const { None }; BRANCH_WIDTH];
    for (off, (boxed, grown)) in children {
        let along = |slot: usize| (0..3).map(|k| if slot >> k & 1 == 1 { off[k] } else { -off[k] }).sum::<f32>();
        let free = (0..BRANCH_WIDTH).filter(|slot| slots[*slot].is_none());
        if let Some(slot) = free.max_by(|a, b| along(*a).total_cmp(&along(*b))) {
            slots[slot] = Some((boxed, Box::new(grown)));
        }
    }
    slots
}

fn around(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::EMPTY, |bounds, item| bounds.join(item.bounds))
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

    /// Expected tests of a ray that meets the parent, but for a factor.
    #[inline]
    fn cost(self) -> f32 {
        if self.count == 0 { 0.0 } else { self.bounds.area() * self.count as f32 }
    }
}

/// Parts two blocks or more at the best of the planes between bins; returns how many come first.
fn by_area(items: &mut [Item]) -> usize {
    let (mut low, mut high) = ([i32::MAX; 3], [i32::MIN; 3]);
    for item in items.iter() {
        for k in 0..3 {
            let centre = item.bounds.centre(k);
            (low[k], high[k]) = (low[k].min(centre), high[k].max(centre));
        }
    }
    // Few blocks fill few bins.
    let used = BINS.min(2 * items.len());
    let scale: [f32; 3] = core::array::from_fn(|k| used as f32 / (high[k] - low[k] + 1) as f32);
    let bin_of = |item: &Item, k: usize| (((item.bounds.centre(k) - low[k]) as f32 * scale[k]) as usize).min(used - 1);
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    for item in items.iter() {
        for (k, bins) in bins.iter_mut().enumerate() {
            let bin = &mut bins[bin_of(item, k)];
            *bin = bin.join(Bin { bounds: item.bounds, count: 1 });
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for (k, bins) in bins.iter().enumerate().filter(|(k, _)| low[*k] < high[*k]) {
        let mut above = [Bin::EMPTY; BINS + 1];
        for i in (0..used).rev() {
            above[i] = above[i + 1].join(bins[i]);
        }
        let mut below = Bin::EMPTY;
        for plane in 1..used {
            below = below.join(bins[plane - 1]);
            let cost = below.cost() + above[plane].cost();
            if below.count > 0 && above[plane].count > 0 && cost < best.0 {
                best = (cost, k, plane);
            }
        }
    }
    let (cost, k, plane) = best;
    if cost == f32::INFINITY {
        // All in one place.
        return items.len() / 2;
    }
    let mut first = 0;
    for at in 0..items.len() {
        if bin_of(&items[at], k) < plane {
            items.swap(first, at);
            first += 1;
        }
    }
    first
}

/// Parts blocks into halves along the longest axis of their centres.
fn by_number(items: &mut [Item]) -> usize {
    let extent = |k: usize| {
        let centres = items.iter().map(|item| item.bounds.centre(k));
        centres.clone().max().unwrap_or(0) - centres.min().unwrap_or(0)
    };
    let axis = (0..3).max_by_key(|&k| extent(k)).unwrap_or(0);
    let middle = items.len() / 2;
    items.select_nth_unstable_by_key(middle, |item| (item.bounds.centre(axis), item.block));
    middle
}

#[cfg(test)]
mod tests {
    use leafwalk_core::layout::ABSENT;

    use super::*;

    fn payload(boxes: &[LatticeBox], first: u32) -> Payload {
        Payload { first, ..Payload::of_boxes(core::array::from_fn(|b| boxes.get(b).copied().unwrap_or(ABSENT))) }
    }

    fn depth(branches: &[Branch], at: u32) -> usize {
        let below = |slot| match branches[at as usize].child(slot).1 {
            Child::Branch(child) => depth(branches, child),
            _ => 0,
        };
        1 + (0..BRANCH_WIDTH).map(below).max().unwrap_or(0)
    }

    #[test]
    fn no_scene_is_too_deep() {
        // Boxes of one corner, each twice as large as the next: by area, the largest comes off first, every time.
        let mut payloads = Vec::new();
        for i in 0..20_000u32 {
            let size = (2f64.powf(16.0 - f64::from(i) * 16.0 / 20_000.0)) as u32 - 1;
            payloads.push(payload(&[([0; 3], [size as u16; 3])], i));
        }
        // And thousands in one place.
        payloads.extend((20_000..25_000).map(|i| payload(&[([7; 3], [7; 3])], i)));
        let branches = grow(&payloads);
        assert!(depth(&branches, 0) <= MAX_DEPTH, "{}", depth(&branches, 0));
        let mut blocks: Vec<u32> = Vec::new();
        for branch in &branches {
            blocks.extend((0..BRANCH_WIDTH).filter_map(|slot| match branch.child(slot).1 {
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
        let boxes: Vec<LatticeBox> =
            (0..8).map(|slot| (corner(7 - slot), corner(7 - slot).map(|c: u16| c + 10))).collect();
        let branches = grow(&[payload(&boxes, 0)]);
        assert_eq!(branches.len(), 1);
        for slot in 0..8 {
            assert_eq!(branches[0].child(slot).1, Child::Block(7 - slot as u32));
        }
    }
}
