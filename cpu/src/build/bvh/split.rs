//! Where the triangles of a node are parted: by the surface area heuristic between bins (Wald 2007), or by number.

use leafwalk_core::layout::BLOCK_WIDTH;
use wide::f32x4;

use super::item::{Item, Part};
use crate::build::span::Span;

/// Candidate planes an axis, less one.
const BINS: usize = 16;

/// Up to so many triangles are parted into as few blocks as can be, which costs little then, and saves a tenth of the blocks.
const FILLED: usize = 128;

/// A triangle whose box is longer than this share of all triangles' may be parted from those that are not.
const LARGE: f32 = 0.25;
/// The share of the surface below which it pays to part small triangles from large ones at once: planes would part what is
/// small, again and again, before it is rid of what is large.
const SMALL_AREA: f32 = 1.0 / 64.0;

/// Blocks that so many triangles fill.
fn blocks(triangles: usize) -> usize {
    triangles.div_ceil(BLOCK_WIDTH)
}

/// What falls into a bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Span,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Span::EMPTY, count: 0 };

    #[inline]
    fn join(self, other: Self) -> Self {
        Self { bounds: self.bounds.join(other.bounds), count: self.count + other.count }
    }

    fn all(bins: &[Self]) -> Self {
        bins.iter().fold(Self::EMPTY, |all, bin| all.join(*bin))
    }

    /// Expected tests of a ray that meets the parent, but for a factor; of a bin that is not empty. A block costs the same
    /// however many of its lanes are vacant.
    #[inline]
    fn cost(self) -> f32 {
        self.bounds.area() * blocks(self.count as usize) as f32
    }
}

/// Which of the bins between the outermost centres a centre falls into, axis by axis.
struct Binning {
    low: f32x4,
    scale: f32x4,
}

impl Binning {
    #[inline]
    fn bins_of(&self, item: &Item) -> [usize; 3] {
        let bins = ((item.centre() - self.low) * self.scale).fast_min(f32x4::splat((BINS - 1) as f32));
        let [x, y, z, _] = bins.fast_trunc_int().to_array();
        [x, y, z].map(|bin| bin as usize % BINS)
    }
}

/// Parts more triangles than one block holds at the best of the planes between bins.
pub(super) fn by_area(Part { bounds: all, items }: Part<'_>) -> [Part<'_>; 2] {
    if items.len() <= 2 * BLOCK_WIDTH {
        return in_blocks(items);
    }
    let (centres, longest) = outline(items);
    let large = LARGE * length(all.upper - all.lower);
    if length(longest) > large
        && let Some(small) = small_ones(items, large, SMALL_AREA * all.area())
    {
        let (small, large) = items.split_at_mut(small);
        return [small, large].map(Part::new);
    }
    let Span { lower: low, upper: high } = centres;
    let extent = (high - low).to_array();
    let scale = |k: usize| if extent[k] > 0.0 { (BINS as f32 / extent[k]).min(f32::MAX) } else { 0.0 };
    let binning = Binning { low, scale: f32x4::new([scale(0), scale(1), scale(2), 0.0]) };
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    for item in items.iter() {
        for (bins, at) in bins.iter_mut().zip(binning.bins_of(item)) {
            bins[at] = bins[at].join(Bin { bounds: item.bounds(), count: 1 });
        }
    }
    let Some((k, plane)) = best_plane(&bins) else {
        // All in one place.
        return halves(items);
    };
    let whole = whole_blocks(items.len(), bins[k][..plane].iter().map(|bin| bin.count as usize).sum());
    if let Some(whole) = whole.filter(|_| items.len() <= FILLED) {
        return at(items, k, whole);
    }
    let mut first = 0;
    for at in 0..items.len() {
        // Above the plane, it changes places with another one above.
        let is_below = binning.bins_of(&items[at])[k] < plane;
        items.swap(first, at);
        first += usize::from(is_below);
    }
    let (below, above) = bins[k].split_at(plane);
    let bounds = [below, above].map(|bins| Bin::all(bins).bounds);
    let (left, right) = items.split_at_mut(first);
    [Part { bounds: bounds[0], items: left }, Part { bounds: bounds[1], items: right }]
}

/// The axis and the first bin behind the plane that parts what lies in some bins at the least cost; `None` where all lies in one.
fn best_plane(bins: &[[Bin; BINS]; 3]) -> Option<(usize, usize)> {
    let mut best = (f32::INFINITY, None);
    for (k, bins) in bins.iter().enumerate() {
        // A plane behind an empty bin parts the triangles as the one before does.
        let is_new = |plane: usize| bins[plane - 1].count > 0;
        let mut costs_above = [f32::INFINITY; BINS];
        let mut above = Bin::EMPTY;
        for plane in (1..BINS).rev() {
            above = above.join(bins[plane]);
            if is_new(plane) && above.count > 0 {
                costs_above[plane] = above.cost();
            }
        }
        let mut below = Bin::EMPTY;
        for plane in (1..BINS).filter(|plane| is_new(*plane)) {
            below = below.join(bins[plane - 1]);
            let cost = below.cost() + costs_above[plane];
            if cost < best.0 {
                best = (cost, Some((k, plane)));
            }
        }
    }
    best.1
}

/// The box around all centres, and the longest edges of the triangles' boxes.
fn outline(items: &[Item]) -> (Span, f32x4) {
    let all = (Span::EMPTY, f32x4::ZERO);
    items.iter().fold(all, |(centres, longest), item| {
        let (centre, bounds) = (item.centre(), item.bounds());
        (centres.join(Span { lower: centre, upper: centre }), longest.fast_max(bounds.upper - bounds.lower))
    })
}

/// The longest edge of a box, given by its edges.
fn length(edges: f32x4) -> f32 {
    let [x, y, z, _] = edges.to_array();
    x.max(y).max(z)
}

/// Puts the triangles first whose boxes have no edge longer than one, and counts them, if the box around them has less than
/// a surface.
#[inline(never)]
fn small_ones(items: &mut [Item], longest: f32, surface: f32) -> Option<usize> {
    let (mut count, mut bounds) = (0, Span::EMPTY);
    for at in 0..items.len() {
        let own = items[at].bounds();
        if length(own.upper - own.lower) <= longest {
            bounds = bounds.join(own);
            items.swap(count, at);
            count += 1;
        }
    }
    (count > 0 && bounds.area() < surface).then_some(count)
}

/// Parts triangles that fill two blocks into these, along the best axis.
fn in_blocks(items: &mut [Item]) -> [Part<'_>; 2] {
    let mut before = [items[0]; 2 * BLOCK_WIDTH];
    let before = &mut before[..items.len()];
    before.copy_from_slice(items);
    let mut best = (f32::INFINITY, [0; 2 * BLOCK_WIDTH]);
    for axis in 0..3 {
        // The order of the centres, and each item's place below it.
        let mut keys = [u64::MAX; 2 * BLOCK_WIDTH];
        for ((place, key), item) in (0..).zip(&mut keys).zip(before.iter()) {
            *key = u64::from(ordered(item.centre().to_array()[axis])) << 32 | place;
        }
        keys[..before.len()].sort_unstable();
        let around = |keys: &[u64]| {
            keys.iter().fold(Span::EMPTY, |all, key| all.join(before[*key as u32 as usize].bounds())).area()
        };
        let (left, right) = keys[..before.len()].split_at(BLOCK_WIDTH);
        let area = around(left) + around(right);
        if area < best.0 {
            best = (area, keys);
        }
    }
    if best.0 < f32::INFINITY {
        for (item, key) in items.iter_mut().zip(best.1) {
            *item = before[key as u32 as usize];
        }
    }
    let (left, right) = items.split_at_mut(BLOCK_WIDTH);
    [left, right].map(Part::new)
}

/// Bits that are ordered as numbers are.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    bits ^ ((bits as i32 >> 31) as u32 | 1 << 31)
}

/// Parts triangles into halves along the longest axis of their centres.
pub(super) fn by_number(items: &mut [Item]) -> [Part<'_>; 2] {
    let Span { lower: low, upper: high } = outline(items).0;
    let [x, y, z, _] = (high - low).to_array();
    let axis = if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) };
    at(items, axis, middle(items.len()))
}

/// Parts triangles such that so many come first along an axis.
fn at(items: &mut [Item], axis: usize, first: usize) -> [Part<'_>; 2] {
    items.select_nth_unstable_by(first, |a, b| {
        a.centre().to_array()[axis].total_cmp(&b.centre().to_array()[axis]).then(a.triangle().cmp(&b.triangle()))
    });
    let (left, right) = items.split_at_mut(first);
    [left, right].map(Part::new)
}

/// The place nearest to one at which triangles are parted into as few blocks as can be; `None` where the place itself is such.
fn whole_blocks(all: usize, place: usize) -> Option<usize> {
    let round = |count: usize| ((count + BLOCK_WIDTH / 2) / BLOCK_WIDTH * BLOCK_WIDTH).clamp(BLOCK_WIDTH, all - 1);
    let (from_left, from_right) = (round(place), all - round(all - place));
    if from_left == place || from_right == place {
        return None;
    }
    Some(if from_left.abs_diff(place) <= from_right.abs_diff(place) { from_left } else { from_right })
}

/// The halves of triangles in their order, of which the first fills whole blocks.
fn halves(items: &mut [Item]) -> [Part<'_>; 2] {
    let (left, right) = items.split_at_mut(middle(items.len()));
    [left, right].map(Part::new)
}

/// Where a half ends that fills whole blocks, of more triangles than one block holds.
fn middle(triangles: usize) -> usize {
    blocks(triangles).div_ceil(2) * BLOCK_WIDTH
}
