//! The tree, without its volumes.

use core::ops::Range;

use crate::structures::bounds::Bounds;
use crate::structures::scene::Scene;

/// How a hierarchy is built.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Which triangles go to which child.
    pub splits: Splits,
    /// More triangles than this in a node are always split; at least 1.
    pub leaf: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { splits: Splits::SurfaceArea, leaf: 8 }
    }
}

/// Ways to split a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Splits {
    /// In halves by the middles of triangles, along the longest side of the box around these.
    Median,
    /// Where the surface area heuristic expects the least work: 16 bins along each axis.
    SurfaceArea,
}

/// From this depth on nodes are split in halves, so that no mesh makes the tree deeper than [`DEEPEST`].
const DEEPEST_FREE: usize = 40;
/// Half of fewer than 2^32 triangles, 32 times over, is one.
pub(super) const DEEPEST: usize = DEEPEST_FREE + 32;
/// Bins along an axis.
const BINS: usize = 16;
/// The cost of a node's two tests of volumes over that of a triangle test.
const NODE_COST: f32 = 1.0;

/// Nodes as (first child, 0) or (first triangle, how many), siblings side by side, and the triangles in the order of leaves.
pub(super) struct Topology {
    pub(super) nodes: Vec<(u32, u32)>,
    pub(super) listed: Vec<u32>,
}

/// A triangle as the builder sees it.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    centre: glam::Vec3,
    triangle: u32,
}

impl Topology {
    pub(super) fn new(scene: &Scene, settings: &Settings) -> Self {
        let item = |triangle| {
            let bounds = scene.bounds_of(triangle);
            Item { bounds, centre: bounds.centre(), triangle }
        };
        let mut items: Vec<Item> = (0..scene.len() as u32).map(item).collect();
        if items.is_empty() {
            return Self { nodes: Vec::new(), listed: Vec::new() };
        }
        let mut nodes = vec![(0, 0)];
        let mut open = vec![(0, 0..items.len(), 0)];
        while let Some((node, range, depth)) = open.pop() {
            match split(&mut items[range.clone()], settings, depth) {
                None => nodes[node] = (range.start as u32, range.len() as u32),
                Some(left) => {
                    let middle = range.start + left;
                    nodes[node] = (nodes.len() as u32, 0);
                    // The left child is taken up first, so that leaves come in the order of their triangles.
                    open.push((nodes.len() + 1, middle..range.end, depth + 1));
                    open.push((nodes.len(), range.start..middle, depth + 1));
                    nodes.extend([(0, 0); 2]);
                }
            }
        }
        Self { nodes, listed: items.iter().map(|item| item.triangle).collect() }
    }
}

/// Sorts items by the child that they go to, and says how many go to the left one; `None` if they stay together.
fn split(items: &mut [Item], settings: &Settings, depth: usize) -> Option<usize> {
    let count = items.len();
    if count == 1 || (settings.splits == Splits::Median && count <= settings.leaf as usize) {
        return None;
    }
    let centres =
        items.iter().fold(Bounds::EMPTY, |bounds, item| bounds.join(Bounds { lower: item.centre, upper: item.centre }));
    if settings.splits == Splits::SurfaceArea && depth < DEEPEST_FREE {
        match best_plane(items, &centres) {
            Some((cost, _)) if cost >= count as f32 && count <= settings.leaf as usize => return None,
            Some((_, plane)) => return Some(partition(items, |item| plane.bin(item) <= plane.last)),
            None if count <= settings.leaf as usize => return None,
            // The middles lie together: any halves are as good.
            None => {}
        }
    }
    let axis = longest(&centres);
    items.select_nth_unstable_by(count / 2, |a, b| {
        (a.centre[axis].total_cmp(&b.centre[axis])).then(a.triangle.cmp(&b.triangle))
    });
    Some(count / 2)
}

fn longest(bounds: &Bounds) -> usize {
    let extent = bounds.extent();
    (0..3).fold(0, |best, k| if extent[k] > extent[best] { k } else { best })
}

/// A plane between bins.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    lower: f32,
    scale: f32,
    /// The last bin on the left.
    last: usize,
}

impl Plane {
    #[inline]
    fn bin(&self, item: &Item) -> usize {
        // The cast takes NaN to 0, and what is too large to the largest.
        (((item.centre[self.axis] - self.lower) * self.scale) as usize).min(BINS - 1)
    }
}

/// The plane of the least expected cost, with that, counted in triangle tests.
fn best_plane(items: &[Item], centres: &Bounds) -> Option<(f32, Plane)> {
    let mut best: Option<(f32, Plane)> = None;
    let mut whole = 0.0;
    for axis in 0..3 {
        let extent = centres.extent()[axis];
        let scale = BINS as f32 * (1.0 - f32::EPSILON) / extent;
        if !(extent > 0.0 && scale.is_finite()) {
            continue;
        }
        let plane = Plane { axis, lower: centres.lower[axis], scale, last: 0 };
        let mut bins = [(Bounds::EMPTY, 0_u32); BINS];
        for item in items {
            let (bounds, count) = &mut bins[plane.bin(item)];
            *bounds = bounds.join(item.bounds);
            *count += 1;
        }
        // What is left of each plane, then what is right of it.
        let mut lefts = [(0.0, 0); BINS];
        let mut left = (Bounds::EMPTY, 0);
        for (sum, (bounds, count)) in lefts.iter_mut().zip(&bins) {
            left = (left.0.join(*bounds), left.1 + count);
            *sum = (left.0.area(), left.1);
        }
        whole = left.0.area();
        let mut right = (Bounds::EMPTY, 0);
        for last in (0..BINS - 1).rev() {
            right = (right.0.join(bins[last + 1].0), right.1 + bins[last + 1].1);
            let (area, count) = lefts[last];
            let cost = area * count as f32 + right.0.area() * right.1 as f32;
            if count > 0 && right.1 > 0 && best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, Plane { last, ..plane }));
            }
        }
    }
    best.map(|(cost, plane)| (NODE_COST + cost / whole, plane))
}

/// Sorts items by a condition, those that meet it first; how many these are.
fn partition(items: &mut [Item], goes_left: impl Fn(&Item) -> bool) -> usize {
    let mut left: Range<usize> = 0..items.len();
    while !left.is_empty() {
        if goes_left(&items[left.start]) {
            left.start += 1;
        } else {
            left.end -= 1;
            items.swap(left.start, left.end);
        }
    }
    left.start
}
