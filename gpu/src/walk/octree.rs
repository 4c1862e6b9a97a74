//! The octree on a device: its words as they are in the file, and a uniform that says where its sections start, and where
//! its root and the hull are.

use bytemuck::{Pod, Zeroable};
use leafwalk_core::Octree;
use leafwalk_core::contract::BOX_MARGIN;
use leafwalk_core::layout::{SECTION_ALIGN, Section};

use crate::device::{DeviceError, Gpu, Module};
use crate::shader::{QUAD_BYTES, WordBindings};

/// The uniform of the kernels that walk: where the sections start, in quads of four words, and where the root and
/// the hull are.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct OctreeSetup {
    /// First quad of the records.
    pub records: u32,
    /// First quad of the payloads.
    pub payloads: u32,
    /// First quad of the blocks.
    pub blocks: u32,
    /// First quad of the entry grid.
    pub grid: u32,
    /// The root's lower corner, in lattice coordinates.
    pub corner: [f32; 3],
    /// The entry grid has 2 to this power cells an axis.
    pub grid_bits: u32,
    /// The hull's lower corner as seen from the root's, dilated by the box margin.
    pub hull_lower: [f32; 3],
    /// Always 0, which no compiler can know: the guards of the flavour `exact` are made of it.
    pub zero: u32,
    /// The hull's upper corner, likewise.
    pub hull_upper: [f32; 3],
    /// First quad of the nodes of the BVH.
    pub bvh: u32,
    /// First quad of their lattices, of which there are none unless the octree is wide.
    pub lattices: u32,
    /// Fill the last quad.
    pub unused_0: u32,
    /// Likewise.
    pub unused_1: u32,
    /// Likewise.
    pub unused_2: u32,
}

impl OctreeSetup {
    fn of<W: AsRef<[u32]>>(octree: &Octree<W>) -> Self {
        const { assert!((SECTION_ALIGN * size_of::<u32>()).is_multiple_of(QUAD_BYTES), "sections start at whole quads") }
        let parts = octree.parts();
        let [hull_lower, hull_upper] = parts.hull.dilated(BOX_MARGIN);
        let quad = |section| octree.span(section).0 / (QUAD_BYTES / size_of::<u32>()) as u32;
        Self {
            records: quad(Section::Records),
            payloads: quad(Section::Payloads),
            blocks: quad(Section::Blocks),
            grid: quad(Section::Grid),
            corner: parts.frame.corner,
            grid_bits: parts.header.grid_bits,
            hull_lower,
            hull_upper,
            bvh: quad(Section::Bvh),
            lattices: quad(Section::Lattices),
            unused_0: 0,
            unused_1: 0,
            unused_2: 0,
            zero: 0,
        }
    }
}

/// Uploads an octree, and binds it as group 0 of a module that was compiled for bindings such as `words`.
pub(super) fn upload<W: AsRef<[u32]>>(
    gpu: &Gpu,
    octree: &Octree<W>,
    words: WordBindings,
    module: &Module,
) -> Result<wgpu::BindGroup, DeviceError> {
    let setup = OctreeSetup::of(octree);
    let setup = gpu.filled("setup", bytemuck::bytes_of(&setup), wgpu::BufferUsages::UNIFORM)?;
    let mut buffers = vec![(setup, size_of::<OctreeSetup>())];
    let bytes: &[u8] = bytemuck::cast_slice(octree.as_words());
    for part in bytes.chunks(words.bytes()) {
        // Files need not end with a whole quad, but buffers do.
        let length = part.len().next_multiple_of(QUAD_BYTES);
        buffers.push((gpu.filled("octree", part, wgpu::BufferUsages::STORAGE)?, length));
        // What was written goes to the device now, so that the copies in between do not pile up.
        gpu.queue.submit([]);
    }
    let buffers: Vec<_> = buffers.iter().map(|(buffer, bytes)| (buffer, *bytes)).collect();
    Ok(module.bind(gpu, 0, &buffers))
}
