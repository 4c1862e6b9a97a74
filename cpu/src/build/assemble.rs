//! The sections as one run of words.

use leafwalk_core::layout::{BLOCK_WORDS, Block, KEY_WORDS, NONE, PADDING, PAYLOAD_WORDS, Payload, RECORD_WORDS};
use leafwalk_core::wire::{self, Header, Section};
use leafwalk_core::{Octree, Policy};
use rayon::prelude::*;

use super::leaf::{self, Place, block_count};
use super::link::{Linked, Payloads, link};
use super::monitor::Monitor;
use super::normalise::Normalised;
use super::tree::Tree;
use super::{BuildError, Settings, Spoiled};
use crate::mesh::Mesh;

/// Leaves a task fills.
const LEAVES_A_TASK: usize = 256;

/// Writes the tree and the triangles that its leaves list.
pub(crate) fn assemble(
    mesh: &Mesh,
    normalised: &Normalised,
    tree: &Tree,
    settings: &Settings,
    monitor: &Monitor<'_>,
) -> Result<Octree<Vec<u32>>, BuildError> {
    let linked = link(tree);
    let references = |leaf: &u32| tree.references(&tree.nodes[*leaf as usize]).len();
    let payloads = linked.payloads.count as usize;
    let blocks: usize = linked.payloads.leaves.iter().map(|leaf| block_count(references(leaf))).sum();
    let header = Header {
        primitives: mesh.triangles.len() as u32,
        dropped: normalised.dropped,
        collapsed: normalised.collapsed,
        references: tree.live as u32,
        grid_bits: linked.grid_bits,
        scale_exponent: normalised.frame.scale_exponent,
        padding: PADDING,
        rounding: normalised.rounding,
        step_cost: settings.step_cost,
        max_level: settings.max_level,
        origin: Header::origin_words(&normalised.frame),
    };
    let lengths = Section::ALL.map(|section| match section {
        Section::Header => size_of::<Header>() / size_of::<u32>(),
        Section::Records => linked.records.len() * RECORD_WORDS,
        Section::Keys => linked.keys.len() * KEY_WORDS,
        Section::Payloads => payloads * PAYLOAD_WORDS,
        Section::Blocks => blocks * BLOCK_WORDS,
        Section::Grid => linked.grid.len(),
        Section::Materials => mesh.material_ids.len(),
        _ => 0,
    });
    let words: u64 = lengths.iter().map(|length| *length as u64).sum();
    let (spans, total) = wire::plan(lengths).ok_or(BuildError::TooLarge {
        what: "words of octree",
        count: words,
        limit: u64::from(u32::MAX),
    })?;
    let mut words = Vec::new();
    let needed = u64::from(total) * size_of::<u32>() as u64;
    settings.check_memory(needed)?;
    let out_of_memory = BuildError::OutOfMemory { needed, limit: settings.memory_limit };
    words.try_reserve_exact(total as usize).map_err(|_| out_of_memory)?;
    words.resize(total as usize, 0u32);

    let mut rest = &mut words[..];
    let mut taken = 0;
    let mut section = |section: Section| {
        let (offset, length) = spans[section as usize];
        let (_, tail) = core::mem::take(&mut rest).split_at_mut(offset as usize - taken);
        let (own, tail) = tail.split_at_mut(length as usize);
        rest = tail;
        taken = (offset + length) as usize;
        own
    };
    section(Section::Header).copy_from_slice(bytemuck::cast_slice(&[header]));
    section(Section::Records).copy_from_slice(bytemuck::cast_slice(&linked.records));
    section(Section::Keys).copy_from_slice(bytemuck::cast_slice(&linked.keys));
    let payloads = bytemuck::cast_slice_mut(section(Section::Payloads));
    let blocks = bytemuck::cast_slice_mut(section(Section::Blocks));
    fill_leaves(normalised, tree, &linked, settings, payloads, blocks, monitor)?;
    gather(tree, &linked.payloads, payloads);
    section(Section::Grid).copy_from_slice(&linked.grid);
    section(Section::Materials).copy_from_slice(&mesh.material_ids);
    wire::seal(&mut words, &spans);
    let octree = match settings.spoiled {
        Spoiled::MeshMargin => Octree::from_words_with::<Touching>(words),
        _ => Octree::from_words(words),
    };
    Ok(octree.unwrap_or_else(|error| unreachable!("a build gives valid words: {error}")))
}

/// For builds whose mesh margin is spoiled.
#[derive(Clone, Copy)]
struct Touching;
impl Policy for Touching {
    const KEEPS_MESH_MARGIN: bool = false;
}

/// Fills the leaves' payloads and blocks, tasks in parallel.
fn fill_leaves(
    normalised: &Normalised,
    tree: &Tree,
    linked: &Linked,
    settings: &Settings,
    payloads: &mut [Payload],
    blocks: &mut [Block],
    monitor: &Monitor<'_>,
) -> Result<(), BuildError> {
    let block_count = |leaf: &u32| block_count(tree.references(&tree.nodes[*leaf as usize]).len());
    let (mut rest, mut first_block) = (blocks, 0);
    let mut tasks = Vec::new();
    for leaves in linked.payloads.leaves.chunks(LEAVES_A_TASK) {
        let count = leaves.iter().map(block_count).sum();
        let (own, tail) = core::mem::take(&mut rest).split_at_mut(count);
        rest = tail;
        tasks.push((leaves, first_block, own));
        first_block += count as u32;
    }
    monitor.check(0.0)?;
    let filled: Result<Vec<_>, BuildError> = tasks
        .into_par_iter()
        .map(|(leaves, mut block, mut blocks)| {
            monitor.check_cancelled()?;
            let mut filled = Vec::with_capacity(leaves.len());
            for leaf in leaves {
                let node = &tree.nodes[*leaf as usize];
                let (own, tail) = blocks.split_at_mut(block_count(leaf));
                blocks = tail;
                let place = Place { block, chain: linked.payloads.chain[*leaf as usize] };
                block += own.len() as u32;
                filled.extend(leaf::fill(
                    node.key,
                    tree.references(node),
                    &normalised.triangles,
                    settings,
                    &place,
                    own,
                ));
            }
            Ok(filled)
        })
        .collect();
    let mut filled = filled?.into_iter().flatten();
    for &leaf in &linked.payloads.leaves {
        let mut number = linked.payloads.first[leaf as usize];
        // A leaf's payloads name the next, the last one none.
        while let Some(payload) = payloads.get_mut(number as usize) {
            *payload = filled.next().unwrap_or(*payload);
            number = payload.next;
        }
    }
    monitor.check(1.0)
}

/// Fills the inner nodes' payloads, children before parents.
fn gather(tree: &Tree, numbers: &Payloads, payloads: &mut [Payload]) {
    for (node, &number) in tree.nodes.iter().zip(&numbers.first).rev() {
        if node.is_leaf() || number == NONE {
            continue;
        }
        let numbers = &numbers.first[node.children as usize..][..8];
        let children = core::array::from_fn(|octant| payloads.get(numbers[octant] as usize));
        let first = numbers.iter().copied().find(|number| *number != NONE).unwrap_or(NONE);
        payloads[number as usize] = leaf::gather(&children, first);
    }
}
