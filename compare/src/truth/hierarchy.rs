//! A binary hierarchy of boxes over triangles, in f64: which triangles a line may meet, about nearest first.
//!
//! It shares no code with the structures that it judges. Boxes are exact, and tests of them err towards a hit, so no
//! triangle that a line meets is left out.

use glam::DVec3;

use super::line::Line;

/// Triangles a leaf.
const LEAF: usize = 4;
/// Places on each axis where a node may be split.
const BINS: usize = 16;
/// What passing from node to node costs, in tests of a triangle.
const STEP_COST: f64 = 1.0;
/// From so many triangles on, the two halves of a node are built at once.
const SPLIT_WORK: usize = 4096;
/// How far the computed distance to a plane may be off, relatively: three roundings of 2^-53, and this widening's own.
const WIDENING: f64 = 8.0 / (1u64 << 53) as f64;

/// A node's two children.
struct Node {
    bounds: [Bounds; 2],
    /// The child's place among the nodes, or the first triangle of a leaf.
    first: [u32; 2],
    /// Triangles of a leaf; 0: the child is a node.
    count: [u32; 2],
}

#[derive(Clone, Copy)]
struct Bounds {
    lower: DVec3,
    upper: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { lower: DVec3::INFINITY, upper: DVec3::NEG_INFINITY };

    fn around(corners: &[DVec3; 3]) -> Self {
        let [a, b, c] = *corners;
        Self { lower: a.min(b).min(c), upper: a.max(b).max(c) }
    }

    fn join(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    fn half_area(&self) -> f64 {
        let e = self.upper - self.lower;
        if e.x < 0.0 { 0.0 } else { e.x * e.y + e.y * e.z + e.z * e.x }
    }
}

/// A triangle while the hierarchy is built.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    centre: DVec3,
    primitive: u32,
}

enum Tree {
    Leaf(usize),
    Inner(Box<[(Bounds, Tree); 2]>),
}

/// The hierarchy.
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
    /// Triangles and their primitives in the order of leaves.
    triangles: Vec<([DVec3; 3], u32)>,
}

impl Hierarchy {
    /// Of triangles by their primitives.
    pub(super) fn new(triangles: &[[DVec3; 3]]) -> Self {
        let item = |(primitive, corners)| {
            let bounds = Bounds::around(corners);
            Item { bounds, centre: 0.5 * bounds.lower + 0.5 * bounds.upper, primitive }
        };
        let mut items: Vec<Item> = (0..).zip(triangles).map(item).collect();
        let bounds = items.iter().fold(Bounds::EMPTY, |bounds, item| bounds.join(item.bounds));
        // Twice as a child of the first node is simpler than a case for meshes of one leaf.
        let tree = Tree::Inner(Box::new([(bounds, build(&mut items)), (Bounds::EMPTY, Tree::Leaf(0))]));
        let triangles = items.iter().map(|item| (triangles[item.primitive as usize], item.primitive)).collect();
        let mut hierarchy = Self { nodes: Vec::new(), triangles };
        hierarchy.add(tree, &mut 0);
        hierarchy
    }

    /// Adds what is below a node; `next` is the first triangle that no leaf has yet.
    fn add(&mut self, tree: Tree, next: &mut u32) -> (u32, u32) {
        match tree {
            Tree::Leaf(count) => {
                let first = *next;
                *next += count as u32;
                (first, count as u32)
            }
            Tree::Inner(children) => {
                let place = self.nodes.len();
                let bounds = [children[0].0, children[1].0];
                self.nodes.push(Node { bounds, first: [0; 2], count: [0; 2] });
                for (side, (_, child)) in children.into_iter().enumerate() {
                    let (first, count) = self.add(child, next);
                    self.nodes[place].first[side] = first;
                    self.nodes[place].count[side] = count;
                }
                (place as u32, 0)
            }
        }
    }

    /// Shows every triangle that a line may meet before `to`, which a visitor may lower.
    pub(super) fn visit(&self, line: &Line, mut visitor: impl FnMut(&[DVec3; 3], u32, &mut f64)) {
        let mut to = line.to;
        let slabs = Slabs::new(line);
        let mut stack = Vec::with_capacity(64);
        stack.push((0, 0, line.from));
        while let Some((first, count, near)) = stack.pop() {
            if near > to {
                continue;
            }
            if count > 0 {
                for (corners, primitive) in &self.triangles[first as usize..(first + count) as usize] {
                    visitor(corners, *primitive, &mut to);
                }
                continue;
            }
            let node = &self.nodes[first as usize];
            let [a, b] = [0, 1].map(|side| slabs.enter(&node.bounds[side], line.from, to));
            let child = |side: usize, near| (node.first[side], node.count[side], near);
            match (a, b) {
                (Some(a), Some(b)) => {
                    let nearer = usize::from(b < a);
                    stack.push(child(1 - nearer, a.max(b)));
                    stack.push(child(nearer, a.min(b)));
                }
                (Some(a), None) => stack.push(child(0, a)),
                (None, Some(b)) => stack.push(child(1, b)),
                (None, None) => {}
            }
        }
    }
}

/// A line as tests of boxes take it.
struct Slabs {
    origin: [f64; 3],
    inverse: [f64; 3],
    is_forward: [bool; 3],
}

impl Slabs {
    fn new(line: &Line) -> Self {
        let inverse = line.direction.to_array().map(|d| 1.0 / d);
        Self { origin: line.origin.to_array(), inverse, is_forward: inverse.map(|i| i.is_sign_positive()) }
    }

    /// Where a line enters a box, if it does so between two distances: widened by all rounding.
    fn enter(&self, bounds: &Bounds, mut near: f64, mut far: f64) -> Option<f64> {
        let (lower, upper) = (bounds.lower.to_array(), bounds.upper.to_array());
        for k in 0..3 {
            let (first, last) = if self.is_forward[k] { (lower[k], upper[k]) } else { (upper[k], lower[k]) };
            let enter = (first - self.origin[k]) * self.inverse[k];
            let leave = (last - self.origin[k]) * self.inverse[k];
            // Neither comparison takes the NaN of a line that runs in the plane itself.
            if enter > near {
                near = enter;
            }
            if leave < far {
                far = leave;
            }
        }
        let (near, far) = (near - WIDENING * near.abs(), far + WIDENING * far.abs());
        (near <= far).then_some(near)
    }
}

fn build(items: &mut [Item]) -> Tree {
    if items.len() <= LEAF {
        return Tree::Leaf(items.len());
    }
    let middle = split(items);
    let is_large = items.len() >= SPLIT_WORK;
    let (a, b) = items.split_at_mut(middle);
    let bounds = [&*a, &*b].map(|half| half.iter().fold(Bounds::EMPTY, |bounds, item| bounds.join(item.bounds)));
    let (a, b) = if is_large { rayon::join(|| build(a), || build(b)) } else { (build(a), build(b)) };
    Tree::Inner(Box::new([(bounds[0], a), (bounds[1], b)]))
}

/// Orders the items in two halves, by the surface area heuristic (J. Goldsmith and J. Salmon, 1987), and says how many
/// are in the first.
fn split(items: &mut [Item]) -> usize {
    let centres = items.iter().fold(Bounds::EMPTY, |bounds, item| Bounds {
        lower: bounds.lower.min(item.centre),
        upper: bounds.upper.max(item.centre),
    });
    let bin = |item: &Item, axis: usize| {
        let (lower, upper) = (centres.lower[axis], centres.upper[axis]);
        (((item.centre[axis] - lower) / (upper - lower) * BINS as f64) as usize).min(BINS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|axis| centres.lower[*axis] < centres.upper[*axis]) {
        let mut bins = [(Bounds::EMPTY, 0usize); BINS];
        for item in &*items {
            let (bounds, count) = &mut bins[bin(item, axis)];
            *bounds = bounds.join(item.bounds);
            *count += 1;
        }
        // The cost of what lies before, then behind, each border of bins.
        let mut costs = [0.0; BINS];
        let mut sweep = |order: &mut dyn Iterator<Item = (usize, usize)>| {
            let (mut bounds, mut count) = (Bounds::EMPTY, 0);
            for (at, border) in order {
                bounds = bounds.join(bins[at].0);
                count += bins[at].1;
                costs[border] +=
                    if count == 0 { f64::INFINITY } else { bounds.half_area() * (count as f64 + STEP_COST) };
            }
        };
        sweep(&mut (0..BINS - 1).map(|at| (at, at + 1)));
        sweep(&mut (1..BINS).rev().map(|at| (at, at)));
        for border in 1..BINS {
            if best.is_none_or(|(cost, ..)| costs[border] < cost) {
                best = Some((costs[border], axis, border));
            }
        }
    }
    let Some((_, axis, border)) = best else {
        // All centres are one point.
        return items.len() / 2;
    };
    let mut middle = 0;
    for i in 0..items.len() {
        if bin(&items[i], axis) < border {
            items.swap(i, middle);
            middle += 1;
        }
    }
    // Areas beyond all numbers give no order.
    if middle == 0 || middle == items.len() { items.len() / 2 } else { middle }
}
