//! What the leaves of an octree lead to.

use leafwalk_core::Parts;
use leafwalk_core::layout::{BVH_WIDTH, BvhNode, Child, Record, Triangle};

/// The blocks that a leaf leads to, in the order of its entries.
pub fn blocks_of(parts: &Parts<'_>, leaf: &Record) -> Vec<u32> {
    let mut blocks = Vec::new();
    if let Some(payload) = parts.payload_of(leaf) {
        add_blocks(parts, payload, &mut blocks);
    }
    blocks
}

/// The triangles of these blocks: those that meet the leaf's cell, and others beside them.
pub fn triangles_of(parts: &Parts<'_>, leaf: &Record) -> Vec<Triangle> {
    let mut room = None;
    let triangles = |block: u32| {
        let block = parts.blocks.get(block as usize, &mut room).copied();
        block.into_iter().flat_map(|block| block.triangles()).collect::<Vec<_>>()
    };
    blocks_of(parts, leaf).into_iter().flat_map(triangles).collect()
}

fn add_blocks(parts: &Parts<'_>, node: &BvhNode, blocks: &mut Vec<u32>) {
    for slot in 0..BVH_WIDTH {
        match node.child(slot).1 {
            Child::Block(block) => blocks.push(block),
            Child::Node(child) => add_blocks(parts, &parts.bvh[child as usize], blocks),
            Child::Vacant => {}
        }
    }
}
