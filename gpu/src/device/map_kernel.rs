//! `MapKernel`: a kernel that makes one buffer out of another, an element an invocation. The self-test and ray generation
//! are such kernels.

use bytemuck::{Pod, Zeroable};

use super::error::DeviceError;
use super::gpu::Gpu;
use super::kernel::{Kernel, Module};

/// The uniform that every map kernel is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct MapSetup {
    /// The number of the first element of the output, where that is a part of something larger.
    pub first: u32,
    /// Always 0, which no compiler can know: the guards of the flavour `exact` are made of it.
    pub zero: u32,
    /// Always 0.
    pub unused_0: u32,
    /// Always 0.
    pub unused_1: u32,
}

/// A kernel that reads one storage buffer and writes another.
pub(crate) struct MapKernel {
    module: Module,
    kernel: Kernel,
}

impl MapKernel {
    /// Compiles a text and its entry point of the given name.
    pub(crate) fn compile(gpu: &Gpu, source: &str, entry: &str) -> Result<Self, DeviceError> {
        let module = Module::new(gpu, entry, source, 0)?;
        let kernel = module.kernel(gpu, entry, &[])?;
        Ok(Self { module, kernel })
    }

    /// Runs the kernel over an input for `count` elements of `element_bytes` each, the first of which has the number
    /// `first`. Does not wait.
    pub(crate) fn run(
        &self,
        gpu: &Gpu,
        input: &[u8],
        first: u32,
        (count, element_bytes): (usize, usize),
    ) -> Result<wgpu::Buffer, DeviceError> {
        use wgpu::BufferUsages as Usage;
        // A binding has at least a word, and only whole ones.
        let input = if input.is_empty() { &[0; size_of::<u32>()] } else { input };
        let input_bytes = input.len().next_multiple_of(size_of::<u32>());
        let output_bytes = count * element_bytes;
        let setup = MapSetup { first, ..MapSetup::zeroed() };
        let setup = gpu.filled("setup", bytemuck::bytes_of(&setup), Usage::UNIFORM)?;
        let input = gpu.filled("input", input, Usage::STORAGE)?;
        let output = gpu.buffer("output", output_bytes, Usage::STORAGE | Usage::COPY_SRC)?;
        let groups = [
            self.module.bind(gpu, 0, &[(&setup, size_of::<MapSetup>())]),
            self.module.bind(gpu, 1, &[(&input, input_bytes), (&output, output_bytes)]),
        ];
        gpu.submit(|encoder| self.kernel.record(encoder, groups.each_ref(), count, None)).map(|_| output)
    }
}
