//! The sections as one run of words.

use leafwalk_core::Octree;
use leafwalk_core::contract::PADDING;
use leafwalk_core::layout::{
    BLOCK_WORDS, BVH_NODE_WORDS, Block, INDEXED_BLOCK_WORDS, KEY_WORDS, PAYLOAD_WORDS, Payload, RECORD_WORDS, Section,
    VERTEX_WORDS,
};
use leafwalk_core::testing::{self, Policy};
use leafwalk_core::wire::{self, Header};
use rayon::prelude::*;

use super::bvh;
use super::compact::index;
use super::error::BuildError;
use super::leaf::{Lister, Listing, block_count};
use super::link::{Linked, Payloads, link};
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
    let linked = link(tree);
    let listings = list_leaves(normalised, tree, &linked, settings, monitor)?;
    let payloads: Vec<Payload> = listings.iter().flat_map(|listing| &listing.payloads).copied().collect();
    let bvh = bvh::grow(&payloads);
    let (blocks, (indexed, vertices)) = if settings.is_compact {
        (0, index(listings.iter().flat_map(|listing| listing.blocks(&normalised.triangles))))
    } else {
        (payloads.iter().map(|payload| payload.count as usize).sum(), Default::default())
    };
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
        anchor: Header::anchor_words(&normalised.frame),
        corner: normalised.frame.corner.map(|steps| steps as i32),
    };
    let lengths = Section::ALL.map(|section| match section {
        Section::Header => size_of::<Header>() / size_of::<u32>(),
        Section::Records => linked.records.len() * RECORD_WORDS,
        Section::Keys => linked.keys.len() * KEY_WORDS,
        Section::Payloads => payloads.len() * PAYLOAD_WORDS,
        Section::Blocks => blocks * BLOCK_WORDS,
        Section::IndexedBlocks => indexed.len() * INDEXED_BLOCK_WORDS,
        Section::Vertices => vertices.len() * VERTEX_WORDS,
        Section::Bvh => bvh.len() * BVH_NODE_WORDS,
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
        pack(&listings, normalised, bytemuck::cast_slice_mut(section(Section::Blocks)));
    }
    section(Section::IndexedBlocks).copy_from_slice(bytemuck::cast_slice(&indexed));
    section(Section::Vertices).copy_from_slice(bytemuck::cast_slice(&vertices));
    section(Section::Bvh).copy_from_slice(bytemuck::cast_slice(&bvh));
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

/// Groups what each leaf lists, tasks in parallel.
fn list_leaves(
    normalised: &Normalised,
    tree: &Tree,
    linked: &Linked,
    settings: &Settings,
    monitor: &Monitor<'_>,
) -> Result<Vec<Listing>, BuildError> {
    let Payloads { first, leaves } = &linked.payloads;
    let references = |leaf: &u32| tree.references(&tree.nodes[*leaf as usize]);
    let mut next_block = 0;
    let tasks: Vec<_> = leaves
        .chunks(LEAVES_A_TASK)
        .map(|leaves| {
            let block = next_block;
            next_block += leaves.iter().map(|leaf| block_count(references(leaf).len())).sum::<usize>();
            (leaves, block)
        })
        .collect();
    monitor.check(0.0)?;
    let list = |(leaves, mut block): (&[u32], usize)| {
        monitor.check_cancelled()?;
        let mut lister = Lister::new(&normalised.frame, &normalised.triangles, settings);
        for leaf in leaves {
            let references = references(leaf);
            lister.list(tree.nodes[*leaf as usize].key, references, first[*leaf as usize], block as u32);
            block += block_count(references.len());
        }
        Ok(lister.listing)
    };
    let listings = tasks.into_par_iter().map(list).collect();
    monitor.check(1.0)?;
    listings
}

/// Fills the blocks, tasks in parallel.
fn pack(listings: &[Listing], normalised: &Normalised, blocks: &mut [Block]) {
    let mut rest = blocks;
    let mut tasks = Vec::new();
    for listing in listings {
        let (own, tail) = core::mem::take(&mut rest).split_at_mut(listing.block_count());
        rest = tail;
        tasks.push((listing, own));
    }
    tasks.into_par_iter().for_each(|(listing, blocks)| {
        for (block, packed) in blocks.iter_mut().zip(listing.blocks(&normalised.triangles)) {
            *block = packed;
        }
    });
}
