//! The octree on the device: its words as they are, and where its sections start.

use bytemuck::{Pod, Zeroable};
use leafwalk_core::Octree;
use leafwalk_core::layout::SECTION_ALIGN;
use leafwalk_core::layout::Section;

use crate::chunk::Split;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernel::Module;
use crate::prelude::QUAD_BYTES;

/// What every kernel is told: where sections start, in quads of four words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Setup {
    /// First quad of the records.
    pub records: u32,
    /// First quad of the payloads.
    pub payloads: u32,
    /// First quad of the blocks.
    pub blocks: u32,
    /// First quad of the entry grid.
    pub grid: u32,
    /// The entry grid has 2 to this power cells an axis.
    pub grid_bits: u32,
    /// Zero, which no compiler can know: guards are made of it.
    pub zero: u32,
    /// Zero.
    pub unused_0: u32,
    /// Zero.
    pub unused_1: u32,
}

impl Setup {
    pub(crate) fn of<W: AsRef<[u32]>>(octree: &Octree<W>) -> Self {
        const { assert!((SECTION_ALIGN * size_of::<u32>()).is_multiple_of(QUAD_BYTES), "sections start at whole quads") }
        let quad = |section| octree.span(section).0 / (QUAD_BYTES / size_of::<u32>()) as u32;
        Self {
            records: quad(Section::Records),
            payloads: quad(Section::Payloads),
            blocks: quad(Section::Blocks),
            grid: quad(Section::Grid),
            grid_bits: octree.parts().header.grid_bits,
            ..Self::zeroed()
        }
    }

    pub(crate) fn upload(&self, gpu: &Gpu) -> Result<wgpu::Buffer, GpuError> {
        gpu.filled("setup", bytemuck::bytes_of(self), wgpu::BufferUsages::UNIFORM)
    }
}

/// The buffers that hold the words, and the setup.
pub(crate) struct Structure {
    words: Vec<(wgpu::Buffer, usize)>,
    setup: wgpu::Buffer,
}

impl Structure {
    pub(crate) fn upload<W: AsRef<[u32]>>(gpu: &Gpu, octree: &Octree<W>, split: Split) -> Result<Self, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(octree.as_words());
        let buffer = |range: core::ops::Range<usize>| {
            // Files need not end with a whole quad; shaders read nothing smaller.
            let length = range.len().next_multiple_of(QUAD_BYTES);
            let buffer = gpu.filled("octree", &bytes[range], wgpu::BufferUsages::STORAGE)?;
            // What was written goes to the device now, so that the copies in between do not pile up.
            gpu.queue.submit([]);
            Ok((buffer, length))
        };
        let words = split.ranges(bytes.len()).map(buffer).collect::<Result<_, GpuError>>()?;
        let setup = Setup::of(octree).upload(gpu)?;
        Ok(Self { words, setup })
    }

    pub(crate) fn bind(&self, gpu: &Gpu, module: &Module) -> wgpu::BindGroup {
        let setup = core::iter::once((&self.setup, size_of::<Setup>()));
        let buffers: Vec<_> = setup.chain(self.words.iter().map(|(buffer, bytes)| (buffer, *bytes))).collect();
        module.bind(gpu, 0, &buffers)
    }
}
