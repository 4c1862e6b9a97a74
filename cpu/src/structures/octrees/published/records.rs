//! `Records`: the leaves, in words.

use core::ops::Range;

use glam::Vec3;

use super::super::tree::{NONE, Tree};

/// The faces in the order of the paper: -y, -x, +y, +x, -z, +z. Here face 2k is the lower one across axis k, and 2k + 1
/// the upper one.
const FACES: [usize; 6] = [2, 0, 3, 1, 4, 5];
/// The place of each face in that order.
const PLACES: [usize; 6] = [1, 3, 0, 2, 4, 5];
/// Words of a record before its neighbours.
const HEAD: usize = 4;
/// Bits for the number of neighbours across each face: 0, 1 or 4.
const COUNT_BITS: u32 = 4;
/// Every other of six such numbers.
const ALTERNATE: u32 = 0x000f_0f0f;

/// The leaves, one behind the other. A record:
/// ```text
/// tCount | tOffset | index of the box | nCount | neighbours across FACES[0] | ... | neighbours across FACES[5]
/// ```
/// A leaf is named by the place of its first word.
#[derive(Clone, Debug)]
pub(super) struct Records {
    words: Vec<u32>,
    /// The corner of the least coordinates, and the edge.
    boxes: Vec<[f32; 4]>,
}

/// The box of a leaf, as it is kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cube {
    pub(super) lower: Vec3,
    pub(super) size: f32,
}

impl Records {
    /// The records of leaves in some order, and where each begins.
    pub(super) fn new(tree: &Tree<'_>, order: &[u32]) -> (Self, Vec<u32>) {
        let across = tree.neighbours();
        let neighbours = |leaf: u32, face: usize| neighbours(tree, across[leaf as usize][face], face);
        let mut address_of = vec![0; tree.nodes.len()];
        let mut end = 0;
        let addresses: Vec<u32> = order
            .iter()
            .map(|&leaf| {
                let address = end;
                address_of[leaf as usize] = address;
                end += (HEAD + (0..6).map(|face| neighbours(leaf, face).len()).sum::<usize>()) as u32;
                address
            })
            .collect();

        let mut records = Self { words: Vec::with_capacity(end as usize), boxes: Vec::with_capacity(order.len()) };
        let mut listed = 0;
        for (index, &leaf) in (0..).zip(order) {
            let node = &tree.nodes[leaf as usize];
            let len = node.triangles.len() as u32;
            let lists: [Vec<u32>; 6] = FACES.map(|face| neighbours(leaf, face));
            let counts =
                (0..).zip(&lists).fold(0, |counts, (place, list)| counts | (list.len() as u32) << (COUNT_BITS * place));
            records.words.extend([len, listed, index, counts]);
            records.words.extend(lists.iter().flatten().map(|neighbour| address_of[*neighbour as usize]));
            let [x, y, z] = tree.cells.bounds(node.cell).lower.to_array();
            records.boxes.push([x, y, z, tree.cells.step * node.cell.size as f32]);
            listed += len;
        }
        (records, addresses)
    }

    /// How many leaves there are.
    pub(super) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// What a leaf lists.
    #[inline]
    pub(super) fn triangles(&self, leaf: u32) -> Range<usize> {
        let [len, first] = [0, 1].map(|word| self.words[leaf as usize + word] as usize);
        first..first + len
    }

    /// The box of a leaf.
    #[inline]
    pub(super) fn cube(&self, leaf: u32) -> Cube {
        let [x, y, z, size] = self.boxes[self.words[leaf as usize + 2] as usize];
        Cube { lower: Vec3::new(x, y, z), size }
    }

    /// The neighbour of a leaf across a face: where there are four, the one on a sub-face.
    #[inline]
    pub(super) fn neighbour(&self, leaf: u32, face: usize, sub_face: usize) -> Option<u32> {
        let counts = self.words[leaf as usize + 3];
        let shift = COUNT_BITS * PLACES[face] as u32;
        let before = counts & ((1 << shift) - 1);
        // Their sum: of pairs, in bytes, and of these, in the highest byte.
        let pairs = (before & ALTERNATE) + (before >> COUNT_BITS & ALTERNATE);
        let first = pairs.wrapping_mul(0x0001_0101) >> 16 & 0xff;
        let count = (counts >> shift & 7) as usize;
        (count != 0).then(|| self.words[leaf as usize + HEAD + first as usize + count / 4 * sub_face])
    }

    /// The bytes of the records alone.
    pub(super) fn record_bytes(&self) -> usize {
        size_of_val(&self.words[..])
    }

    pub(super) fn bytes(&self) -> usize {
        self.record_bytes() + size_of_val(&self.boxes[..])
    }
}

/// The leaves that touch a face from outside, in the order of its sub-faces, given the node of the leaf's size there or
/// the larger leaf.
fn neighbours(tree: &Tree<'_>, node: u32, face: usize) -> Vec<u32> {
    match tree.nodes.get(node as usize) {
        None => Vec::new(),
        Some(outside) if outside.children == NONE => vec![node],
        Some(outside) => {
            let touches = |octant: &u32| (octant >> (face / 2) & 1) as usize != face % 2;
            // In the order of octants: the lower of the other two axes counts for one, the higher for two.
            (0..8).filter(touches).map(|octant| outside.children + octant).collect()
        }
    }
}
