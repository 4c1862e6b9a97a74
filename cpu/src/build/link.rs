//! Numbers and links: the tree as records, keys and entry grid.

use leafwalk_core::layout::{
    BvhNode, Key, LATTICE, LINK_COARSER, LINK_FINER, LINK_NONE, LINK_SAME, NONE, Record, RecordHead,
};

use super::tree::{Node, Tree};

/// Grid cells stay below leaves by about this factor, a power of eight at most.
const MOST_GRID_BITS: u32 = 6;

/// The tree in the order of the file.
pub(crate) struct Linked {
    /// The root, seven vacant records, then blocks of eight siblings, depth first.
    pub(crate) records: Vec<Record>,
    pub(crate) keys: Vec<[u32; 2]>,
    pub(crate) grid_bits: u32,
    pub(crate) grid: Vec<u32>,
}

/// Numbers and links the nodes of a tree, given what its leaves list: see [`listing`].
pub(crate) fn link(tree: &Tree, listing: &[u32], payloads: &[BvhNode]) -> Linked {
    let numbers = number(tree);
    let count = tree.nodes.len() + 7;
    let vacant = Record { head: 0, offset: 0, neighbours: [0; 6] };
    let mut linked = Linked {
        records: vec![vacant; count],
        keys: vec![Key::ROOT.to_words(); count],
        grid_bits: grid_bits(tree),
        grid: Vec::new(),
    };
    let mut payload_of = vec![NONE; tree.nodes.len()];
    for (payload, leaf) in (0..).zip(listing) {
        payload_of[*leaf as usize] = payload;
    }
    let neighbours = neighbours(tree);
    let mut in_order: Vec<u32> = (0..tree.nodes.len() as u32).collect();
    in_order.sort_unstable_by_key(|&node| numbers[node as usize]);
    for at in in_order {
        let node = &tree.nodes[at as usize];
        let number = numbers[at as usize] as usize;
        linked.keys[number] = node.key.to_words();
        linked.records[number] = if node.is_leaf() {
            let number = payload_of[at as usize];
            let payload = payloads.get(number as usize).map(|payload| (number, payload.count()));
            leaf_record(tree, &numbers, node, &neighbours[at as usize], payload.unwrap_or_default())
        } else {
            let children = numbers[node.children as usize];
            Record { head: RecordHead::inner(node.key.level).0, offset: children, neighbours: [0; 6] }
        };
    }
    linked.grid = grid(&linked);
    linked
}

/// Record numbers of the nodes: sibling blocks in depth-first order after the root's.
fn number(tree: &Tree) -> Vec<u32> {
    let mut numbers = vec![0; tree.nodes.len()];
    let mut next_block = 8;
    let mut pending = vec![0u32];
    while let Some(at) = pending.pop() {
        let node = &tree.nodes[at as usize];
        if !node.is_leaf() {
            for octant in 0..8 {
                numbers[(node.children + octant) as usize] = next_block + octant;
            }
            next_block += 8;
            pending.extend((0..8).rev().map(|octant| node.children + octant));
        }
    }
    numbers
}

/// The leaves that list anything, as indices of tree nodes, depth first: the order of their payloads.
pub(crate) fn listing(tree: &Tree) -> Vec<u32> {
    let mut leaves = Vec::new();
    let mut pending = vec![0u32];
    while let Some(at) = pending.pop() {
        let node = &tree.nodes[at as usize];
        if !node.is_leaf() {
            pending.extend((node.children..node.children + 8).rev());
        } else if node.lists() {
            leaves.push(at);
        }
    }
    leaves
}

/// Per node and face, the node of the same size across it, or the leaf that holds that place, or [`NONE`].
fn neighbours(tree: &Tree) -> Vec<[u32; 6]> {
    let mut neighbours = vec![[NONE; 6]; tree.nodes.len()];
    for (at, node) in tree.nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
        for (octant, face) in (0..48).map(|i| (i / 6, i % 6)) {
            let (axis, positive) = (face >> 1, face & 1);
            let mirrored = octant ^ 1 << axis;
            let outside = neighbours[at][face as usize];
            let neighbour = if octant >> axis & 1 != positive {
                node.children + mirrored
            } else if outside == NONE || tree.nodes[outside as usize].is_leaf() {
                outside
            } else {
                tree.nodes[outside as usize].children + mirrored
            };
            neighbours[(node.children + octant) as usize][face as usize] = neighbour;
        }
    }
    neighbours
}

fn leaf_record(tree: &Tree, numbers: &[u32], leaf: &Node, neighbours: &[u32; 6], payload: (u32, u32)) -> Record {
    let links = neighbours.map(|neighbour| {
        let Some(node) = tree.nodes.get(neighbour as usize) else { return (LINK_NONE, 0) };
        if !node.is_leaf() {
            (LINK_FINER, numbers[node.children as usize])
        } else if node.key.level == leaf.key.level {
            (LINK_SAME, numbers[neighbour as usize])
        } else {
            (LINK_COARSER, numbers[neighbour as usize])
        }
    });
    let (offset, t_count) = payload;
    Record {
        head: RecordHead::leaf(t_count, leaf.key.level, links.map(|(kind, _)| kind)).0,
        offset,
        neighbours: links.map(|(_, target)| target),
    }
}

/// About as many grid cells as an eighth of the leaves, and none finer than the finest leaf.
fn grid_bits(tree: &Tree) -> u32 {
    let leaves = tree.nodes.iter().filter(|node| node.is_leaf()).count() as u32;
    let deepest = tree.nodes.iter().map(|node| node.key.level).max().unwrap_or(0);
    (leaves.ilog2() / 3).min(MOST_GRID_BITS).min(deepest)
}

fn grid(linked: &Linked) -> Vec<u32> {
    let bits = linked.grid_bits;
    (0..1u32 << (3 * bits))
        .map(|entry| {
            let Key { corner, .. } = Key::of_grid(entry, bits);
            let mut number = 0;
            for level in 0..bits {
                let record = &linked.records[number as usize];
                if !record.head().is_inner() {
                    break;
                }
                number = record.offset + Key::octant_towards(LATTICE >> level, corner);
            }
            number
        })
        .collect()
}
