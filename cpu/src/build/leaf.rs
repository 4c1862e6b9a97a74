//! What leaves list: triangles grouped into blocks of eight, their boxes, payloads.

use leafwalk_core::Frame;
use leafwalk_core::layout::{BLOCK_WIDTH, Block, Key, LatticeBox, NONE, PAYLOAD_BLOCKS, Payload, Triangle};
use wide::f32x4;

use super::bounds::Bounds;
use super::part::{Cell, Part};
use super::settings::{Settings, Spoiled};

/// Blocks that `references` triangles fill.
pub(crate) fn block_count(references: usize) -> usize {
    references.div_ceil(BLOCK_WIDTH)
}

/// Payloads that `references` triangles need.
pub(crate) fn payload_count(references: usize) -> usize {
    block_count(references).div_ceil(PAYLOAD_BLOCKS)
}

/// What some leaves list, one after the other.
#[derive(Default)]
pub(crate) struct Listing {
    pub(crate) payloads: Vec<Payload>,
    /// The triangles of each leaf, by their places in the list of all, block after block.
    pub(crate) references: Vec<u32>,
    /// How many of them each leaf has.
    pub(crate) counts: Vec<usize>,
}

impl Listing {
    pub(crate) fn block_count(&self) -> usize {
        self.payloads.iter().map(|payload| payload.count as usize).sum()
    }

    /// Leaf after leaf; only the last of each has vacant lanes.
    pub(crate) fn blocks(&self, triangles: &[Triangle]) -> impl Iterator<Item = Block> {
        let mut references = &self.references[..];
        let of_leaf = move |&count: &usize| {
            let (own, tail) = references.split_at(count);
            references = tail;
            own.chunks(BLOCK_WIDTH)
        };
        self.counts.iter().flat_map(of_leaf).map(|group| pack(group, triangles))
    }
}

/// Lists leaf after leaf, in memory that serves for all of them.
pub(crate) struct Lister<'a> {
    frame: &'a Frame,
    triangles: &'a [Triangle],
    settings: &'a Settings,
    pub(crate) listing: Listing,
    parts: Vec<Part>,
    keys: Vec<u64>,
    boxes: Vec<LatticeBox>,
}

impl<'a> Lister<'a> {
    pub(crate) fn new(frame: &'a Frame, triangles: &'a [Triangle], settings: &'a Settings) -> Self {
        let (parts, keys, boxes) = Default::default();
        Self { frame, triangles, settings, listing: Listing::default(), parts, keys, boxes }
    }

    /// Adds a leaf whose references ascend; its payloads are numbered from `payload` on, their blocks from `block` on.
    pub(crate) fn list(&mut self, cell: Key, references: &[u32], payload: u32, block: u32) {
        let cell = Cell::new(self.frame, cell, self.settings.padding());
        self.parts.clear();
        self.parts.extend(references.iter().map(|reference| cell.part(&self.triangles[*reference as usize].corners)));
        self.keys.clear();
        self.keys.extend(0..references.len() as u64);
        group(&mut self.keys, &self.parts);
        self.boxes.clear();
        for group in self.keys.chunks_mut(BLOCK_WIDTH) {
            // Ascending primitives, so that the block's bytes do not depend on how it was found.
            group.sort_unstable_by_key(|key| place(*key));
            self.listing.references.extend(group.iter().map(|key| references[place(*key)]));
            let bounds = group.iter().fold(Bounds::EMPTY, |all, key| all.join(self.parts[place(*key)].bounds));
            self.boxes.push(spoil(bounds.boxed(), self.settings.spoiled));
        }
        self.listing.counts.push(references.len());
        let (boxes, count) = (&self.boxes, payload_count(references.len()));
        let in_payload = |(i, own): (usize, &[LatticeBox])| {
            let boxed = Payload::of_boxes(core::array::from_fn(|b| own.get(b).copied().unwrap_or(LatticeBox::EMPTY)));
            let LatticeBox { lower, upper } =
                if i == 0 { LatticeBox::around(boxes.iter().copied()) } else { boxed.hull() };
            let next = if i + 1 == count { NONE } else { payload + i as u32 + 1 };
            Payload { lower, upper, first: block + (i * PAYLOAD_BLOCKS) as u32, next, ..boxed }
        };
        self.listing.payloads.extend(boxes.chunks(PAYLOAD_BLOCKS).enumerate().map(in_payload));
    }
}

/// The place of a part in its list: the low half of a key.
#[inline]
fn place(key: u64) -> usize {
    key as u32 as usize
}

/// Orders parts so that every run of eight lies close together: halves along the longest axis of the centres.
///
/// Keys hold a part's place, and above it whatever they were last ordered by.
fn group(keys: &mut [u64], parts: &[Part]) {
    if keys.len() <= BLOCK_WIDTH {
        return;
    }
    let first = f32x4::new(parts[place(keys[0])].centre);
    let (low, high) = keys.iter().fold((first, first), |(low, high), key| {
        let centre = f32x4::new(parts[place(*key)].centre);
        (low.fast_min(centre), high.fast_max(centre))
    });
    let [x, y, z, _] = (high - low).to_array();
    let axis = if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) };
    for key in &mut *keys {
        // Centres are sums of sides inside the dilated root, not negative but for the smallest of roundings.
        let order = parts[place(*key)].centre[axis].max(0.0).to_bits();
        *key = u64::from(order) << 32 | *key & u64::from(u32::MAX);
    }
    // The left half fills whole blocks, so that only the last block of a leaf has vacant lanes.
    let middle = block_count(keys.len()).div_ceil(2) * BLOCK_WIDTH;
    keys.select_nth_unstable(middle);
    let (left, right) = keys.split_at_mut(middle);
    group(left, parts);
    group(right, parts);
}

/// The box, a step smaller where boxes are spoiled.
fn spoil(LatticeBox { lower, upper }: LatticeBox, spoiled: Spoiled) -> LatticeBox {
    let shrink = |k: usize| u16::from(spoiled == Spoiled::Boxes && lower[k] < upper[k]);
    LatticeBox { lower, upper: core::array::from_fn(|k| upper[k] - shrink(k)) }
}

/// The block of up to eight references.
fn pack(group: &[u32], triangles: &[Triangle]) -> Block {
    let mut block = Block::VACANT;
    for lane in 0..BLOCK_WIDTH {
        let reference = group.get(lane);
        let Triangle { primitive, corners } = &triangles[*reference.unwrap_or(&group[0]) as usize];
        block.primitives[lane] = reference.map_or(NONE, |_| *primitive);
        for (corner, axis) in (0..9).map(|i| (i / 3, i % 3)) {
            block.vertices[corner][axis][lane] = corners[corner][axis];
        }
    }
    block
}
