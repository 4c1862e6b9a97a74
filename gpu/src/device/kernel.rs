//! `Module` and `Kernel`: a compiled shader, the layout of its bindings, and one of its entry points.

use super::error::DeviceError;
use super::gpu::Gpu;
use crate::shader::WORKGROUP;

/// A compiled shader, with the layout of the two groups of bindings that all its kernels have.
pub(crate) struct Module {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    groups: [wgpu::BindGroupLayout; 2],
}

/// One entry point of a module, ready to run.
pub(crate) struct Kernel {
    pipeline: wgpu::ComputePipeline,
}

impl Module {
    /// Compiles a shader. Its group 0 holds a uniform and `inputs` storage buffers to read; its group 1 a storage buffer to
    /// read and one to write.
    pub(crate) fn new(gpu: &Gpu, label: &str, source: &str, inputs: u32) -> Result<Self, DeviceError> {
        let uniform = wgpu::BufferBindingType::Uniform;
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let groups = [
            core::iter::once(uniform).chain((0..inputs).map(|_| storage(true))).collect::<Vec<_>>(),
            vec![storage(true), storage(false)],
        ];
        let groups = groups.map(|types| {
            let entries: Vec<_> = (0..).zip(types).map(|(binding, ty)| entry(binding, ty)).collect();
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
            gpu.device.create_bind_group_layout(&descriptor)
        });
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&groups[0]), Some(&groups[1])],
            immediate_size: 0,
        });
        let source = wgpu::ShaderSource::Wgsl(source.into());
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source });
        gpu.check().map(|()| Self { module, layout, groups })
    }

    /// Compiles an entry point, with values for the `override` declarations of the text.
    pub(crate) fn kernel(&self, gpu: &Gpu, name: &str, overrides: &[(&str, f64)]) -> Result<Kernel, DeviceError> {
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&self.layout),
            module: &self.module,
            entry_point: Some(name),
            compilation_options: wgpu::PipelineCompilationOptions { constants: overrides, ..Default::default() },
            cache: None,
        });
        gpu.check().map(|()| Kernel { pipeline })
    }

    /// Binds buffers as group 0 or 1, of each the given number of bytes.
    pub(crate) fn bind(&self, gpu: &Gpu, group: usize, buffers: &[(&wgpu::Buffer, usize)]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, (buffer, bytes))| {
                let size = core::num::NonZeroU64::new(*bytes as u64);
                let resource = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size });
                wgpu::BindGroupEntry { binding, resource }
            })
            .collect();
        let layout = &self.groups[group];
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }
}

impl Kernel {
    /// Records a run of at least `count` invocations: as many whole workgroups as that takes.
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        groups: [&wgpu::BindGroup; 2],
        count: usize,
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
        pass.set_pipeline(&self.pipeline);
        for (at, group) in (0..).zip(groups) {
            pass.set_bind_group(at, group, &[]);
        }
        pass.dispatch_workgroups(count.div_ceil(WORKGROUP as usize) as u32, 1, 1);
    }
}

fn entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
