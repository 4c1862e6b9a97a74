//! Any words: an error, or an octree that can be traced, counted and verified.

use std::sync::LazyLock;

use leafwalk_core::layout::Section;
use leafwalk_core::layout::{MAGIC, VERSION};
use leafwalk_core::wire;
use leafwalk_core::{Octree, Ray};
use leafwalk_cpu::{Builder, Mesh, verify};

use super::bytes::Bytes;

/// Rays traced through what decodes.
const RAYS: usize = 24;

/// Decodes the words that the bytes spell: edits of a valid octree, or the words themselves. Preamble and checksum are
/// made valid first, since no fuzzer guesses a checksum. Returns whether they decoded.
pub fn check(bytes: &[u8]) -> bool {
    static VALID: LazyLock<[Octree<Vec<u32>>; 8]> = LazyLock::new(valid);
    let mut bytes = Bytes::new(bytes);
    let words = match VALID.get(usize::from(bytes.byte() % 9)) {
        Some(valid) => edited(valid, &mut bytes),
        None => spelled(&mut bytes),
    };
    let Ok(octree) = Octree::from_words(&words) else { return false };
    let stats = octree.stats();
    assert!(stats.primitives - stats.dropped <= 8 * stats.blocks, "{stats:?}");
    // A hostile octree may verify or not; either way it must end.
    let _ = (octree.bounds(), verify(&octree));
    for _ in 0..RAYS {
        let ray = super::trace::ray(&mut bytes);
        trace(&octree, &ray);
    }
    let bounds = octree.bounds();
    let centre: [f32; 3] = core::array::from_fn(|k| (0.5 * (bounds.lower[k] + bounds.upper[k])) as f32);
    for (x, y, z) in (0..27).map(|i| (i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)) {
        trace(&octree, &Ray::new(centre, [x, y, z].map(|c| c as f32)));
    }
    for k in 0..8 {
        let mut numbers = [0.1f32, 0.2, 0.3, 0.0, 1.0, -1.0, 0.5, 9.0];
        numbers[k] = f32::NAN;
        let [a, b, c, t_min, d, e, f, t_max] = numbers;
        assert_eq!(octree.closest_hit(&Ray::between([a, b, c], [d, e, f], t_min, t_max)), None, "NaN at {k}");
    }
    true
}

/// What is reported must be sane even where the lists leave triangles out.
fn trace(octree: &Octree<&Vec<u32>>, ray: &Ray) {
    let hit = octree.closest_hit(ray);
    assert_eq!(hit.is_some(), octree.occluded(ray), "{ray:?}");
    if let Some(hit) = hit {
        let in_triangle = |w: f32| (-1e-6..=1.0 + 1e-6).contains(&w);
        assert!(hit.t.is_finite() && in_triangle(hit.u) && in_triangle(hit.v), "{hit:?} of {ray:?}");
        assert!(hit.primitive < octree.stats().primitives, "{hit:?} of {ray:?}");
    }
}

fn spelled(bytes: &mut Bytes<'_>) -> Vec<u32> {
    let mut words = Vec::new();
    while !bytes.is_empty() {
        words.push(bytes.word());
    }
    words.splice(..0, [MAGIC, VERSION, words.len() as u32 + 4, 0]);
    sealed(words)
}

/// A valid octree's words after edits; preamble and table are a section like the others.
fn edited(octree: &Octree<Vec<u32>>, bytes: &mut Bytes<'_>) -> Vec<u32> {
    let mut words = octree.as_words().to_vec();
    for _ in 0..1 + bytes.byte() % 4 {
        let (offset, length) = match Section::ALL.get(usize::from(bytes.byte()) % (Section::ALL.len() + 1)) {
            Some(section) => octree.span(*section),
            None => (4, 1 + (wire::TABLE_ROW * Section::ALL.len()) as u32),
        };
        if length == 0 {
            continue;
        }
        let at = offset as usize + bytes.below(length as usize);
        let operation = bytes.byte();
        let value = bytes.word();
        words[at] = match operation % 6 {
            0 => value,
            1 => words[at] ^ 1 << (value & 31),
            2 => words[at].wrapping_add(1 + (value & 7)),
            3 => words[at].wrapping_sub(1 + (value & 7)),
            4 => words[offset as usize + value as usize % length as usize],
            _ => [0, 8, u32::MAX, 1 << 31, 0x7fc0_0000, 0x7f80_0000, 1, 0x3f80_0000][value as usize & 7],
        };
    }
    sealed(words)
}

fn sealed(mut words: Vec<u32>) -> Vec<u32> {
    words[3] = wire::checksum(&words);
    words
}

/// Nothing; one leaf; levels with coarser and finer neighbours; leaves that list nodes. Then all of them compact.
fn valid() -> [Octree<Vec<u32>>; 8] {
    let speck = |i: u32, size: f32, at: [f32; 3]| -> [[f32; 3]; 3] {
        let turn = |c: u32| size * ((i * 7 + c * 5) % 11) as f32 / 11.0;
        core::array::from_fn(|c| core::array::from_fn(|k| at[k] + turn(3 * c as u32 + k as u32)))
    };
    let scattered: Vec<_> = (0..24u32)
        .map(|i| speck(i, 2f32.powi(-(i as i32 % 6)), [i % 2, i / 2 % 2, i / 4 % 2].map(|c| c as f32)))
        .collect();
    let mesh = |corners: &[[[f32; 3]; 3]]| {
        let triangles = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let material_ids = (0..corners.len() as u32).collect();
        Mesh { positions: corners.as_flattened().to_vec(), triangles, material_ids }
    };
    let crowded: Vec<_> = (0..150).map(|i| speck(i, 1.0, [0.0; 3])).collect();
    let packed = Builder::new().step_cost(0.5).max_level(6);
    let builders = [packed.clone(), packed.compact()];
    let build = |i: usize| {
        let builder = &builders[i / 4];
        match i % 4 {
            0 => builder.build(&Mesh::default()),
            1 => builder.build(&mesh(&scattered[..1])),
            2 => builder.build(&mesh(&scattered)),
            _ => builder.clone().max_level(1).build(&mesh(&crowded)),
        }
    };
    core::array::from_fn(|i| build(i).expect("a valid mesh"))
}
