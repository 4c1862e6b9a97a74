//! The sections as one run of words.

use leafwalk_core::Octree;
use leafwalk_core::contract::PADDING;
use leafwalk_core::layout::{
    BLOCK_WIDTH, BLOCK_WORDS, BVH_NODE_WORDS, Block, BvhNode, INDEXED_BLOCK_WORDS, KEY_WORDS, LATTICE_WORDS, NONE,
    RECORD_WORDS, Section, Triangle, VERTEX_WORDS,
};
use leafwalk_core::testing::{self, Policy};
use leafwalk_core::wire::{self, Header};
use rayon::prelude::*;

use super::bvh::Hierarchy;
use super::compact::index;
use super::error::BuildError;
use super::leaf::{BlockIndex, Lister};
use super::link::{link, listing};
use super::monitor::Monitor;
use super::normalise::Normalised;
use super::settings::{Settings, Spoiled};
use super::tree::Tree;
use crate::mesh::MeshRef;

/// Leaves a task fills.
const LEAVES_A_TASK: usize = 256;

/// Writes the tree and the triangles that its leaves list.
pub(crate) fn assemble(
    mesh: MeshRef<'_>,
    normalised: &Normalised,
    tree: &Tree,
    settings: &Settings,
    monitor: &Monitor<'_>,
) -> Result<Octree<Vec<u32>>, BuildError> {
    let hierarchy = Hierarchy::grow(&normalised.frame, &normalised.triangles, settings.spoiled);
    monitor.check(0.3)?;
    let listing = listing(tree);
    let payloads = list_leaves(normalised, tree, &listing, &hierarchy, settings, &monitor.part(0.3, 1.0))?;
    let linked = link(tree, &listing, &payloads);
    let (blocks, (indexed, vertices)) = if settings.is_compact {
        (0, index(hierarchy.blocks().map(|block| pack(block, &normalised.triangles))))
    } else {
        (hierarchy.block_count(), Default::default())
    };
    let header = Header {
        primitives: mesh.triangles.len() as u32,
        dropped: normalised.dropped,
        collapsed: normalised.collapsed,
        grid_bits: linked.grid_bits,
        scale_exponent: normalised.frame.scale_exponent,
        padding: PADDING,
        rounding: normalised.rounding,
        step_cost: settings.step_cost,
        max_level: settings.max_level,
        anchor: Header::anchor_words(&normalised.frame),
        corner: normalised.frame.corner.map(|steps| steps as i32),
    };
    let lengths = Section::ALL.map(|section| match section {
        Section::Header => size_of::<Header>() / size_of::<u32>(),
        Section::Records => linked.records.len() * RECORD_WORDS,
        Section::Keys => linked.keys.len() * KEY_WORDS,
        Section::Payloads => payloads.len() * BVH_NODE_WORDS,
        Section::Blocks => blocks * BLOCK_WORDS,
        Section::IndexedBlocks => indexed.len() * INDEXED_BLOCK_WORDS,
        Section::Vertices => vertices.len() * VERTEX_WORDS,
        Section::Bvh => hierarchy.nodes.len() * BVH_NODE_WORDS,
        Section::Lattices => hierarchy.lattices.len() * LATTICE_WORDS,
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
    let needed = u64::from(total) * size_of::<u32>() as u64;
    settings.check_memory(needed)?;
    // Zeroed by whoever maps the pages, on the threads that fill them.
    let mut words = bytemuck::allocation::try_zeroed_vec(total as usize)
        .map_err(|()| BuildError::OutOfMemory { needed, limit: settings.memory_limit })?;

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
    section(Section::Payloads).copy_from_slice(bytemuck::cast_slice(&payloads));
    if !settings.is_compact {
        let blocks: &mut [Block] = bytemuck::cast_slice_mut(section(Section::Blocks));
        let triangles = &normalised.triangles;
        blocks.par_iter_mut().zip(hierarchy.par_blocks()).for_each(|(block, own)| *block = pack(own, triangles));
    }
    section(Section::IndexedBlocks).copy_from_slice(bytemuck::cast_slice(&indexed));
    section(Section::Vertices).copy_from_slice(bytemuck::cast_slice(&vertices));
    section(Section::Bvh).copy_from_slice(bytemuck::cast_slice(&hierarchy.nodes));
    section(Section::Lattices).copy_from_slice(bytemuck::cast_slice(&hierarchy.lattices));
    section(Section::Grid).copy_from_slice(&linked.grid);
    section(Section::Materials).copy_from_slice(mesh.material_ids);
    wire::seal(&mut words, &spans);
    let octree = match settings.spoiled {
        Spoiled::MeshMargin => testing::from_sealed::<_, Touching>(words),
        _ => Octree::from_sealed(words),
    };
    Ok(octree.unwrap_or_else(|error| unreachable!("a build gives valid words: {error}")))
}

/// For builds whose mesh margin is spoiled.
#[derive(Clone, Copy)]
struct Touching;
impl Policy for Touching {
    const KEEPS_MESH_MARGIN: bool = false;
}

/// Finds what each leaf lists, tasks in parallel.
fn list_leaves(
    normalised: &Normalised,
    tree: &Tree,
    listing: &[u32],
    hierarchy: &Hierarchy,
    settings: &Settings,
    monitor: &Monitor<'_>,
) -> Result<Vec<BvhNode>, BuildError> {
    let blocks = BlockIndex::new(hierarchy);
    let list = |leaves: &[u32]| {
        monitor.check_cancelled()?;
        let mut lister = Lister::new(&normalised.frame, &normalised.triangles, &blocks, settings);
        let payload = |leaf: &u32| {
            let leaf = &tree.nodes[*leaf as usize];
            lister.list(leaf.key, tree.references(leaf))
        };
        Ok(leaves.iter().map(payload).collect::<Vec<_>>())
    };
    let payloads: Vec<Vec<BvhNode>> = listing.par_chunks(LEAVES_A_TASK).map(list).collect::<Result<_, _>>()?;
    monitor.check(1.0)?;
    Ok(payloads.concat())
}

/// The block of up to eight triangles, given by their places in the list of all.
fn pack(own: &[u32], triangles: &[Triangle]) -> Block {
    let mut block = Block::VACANT;
    for lane in 0..BLOCK_WIDTH {
        let number = own.get(lane);
        let Triangle { primitive, corners } = &triangles[*number.unwrap_or(&own[0]) as usize];
        block.primitives[lane] = number.map_or(NONE, |_| *primitive);
        for (corner, axis) in (0..9).map(|i| (i / 3, i % 3)) {
            block.vertices[corner][axis][lane] = corners[corner][axis];
        }
    }
    block
}
