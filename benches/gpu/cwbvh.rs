//! The rival: obvhs's compressed wide BVH, traversed by a kernel of its own on the same adapter.

use core::time::Duration;
use std::time::Instant;

use leafwalk::{Hit, Mesh, Ray};
use leafwalk_rivals::triangle;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;

use crate::contender::{Contender, OCCLUDED};

/// The BVH on a device.
pub(crate) struct Cwbvh {
    device: wgpu::Device,
    queue: wgpu::Queue,
    closest_hits: wgpu::ComputePipeline,
    occlusions: wgpu::ComputePipeline,
    nodes: wgpu::Buffer,
    triangles: wgpu::Buffer,
}

/// Rays a dispatch, as leafwalk's: as many workgroups as WebGPU promises along an axis.
const PIECE: usize = WORKGROUP * 65535;
const WORKGROUP: usize = 64;
/// Stands for infinity, which shaders need not know.
const FARTHEST: f32 = 1e30;

impl Cwbvh {
    /// Builds the BVH by obvhs's slow build and uploads it to the adapter of that name.
    pub(crate) fn new(mesh: &Mesh, adapter: &str) -> Self {
        let (device, queue) = open(adapter);
        let triangles = triangle::all(mesh);
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::slow_build(), &mut Duration::default());
        let in_order = bvh.primitive_indices.iter().flat_map(|primitive| {
            let triangle = &triangles[*primitive as usize];
            let [corner, b, c] = [triangle.v0, triangle.v1 - triangle.v0, triangle.v2 - triangle.v0];
            [corner.extend(f32::from_bits(*primitive)), b.extend(0.0), c.extend(0.0)].map(|quad| quad.to_array())
        });
        let in_order: Vec<[f32; 4]> = in_order.collect();
        let module = device.create_shader_module(wgpu::include_wgsl!("cwbvh.wgsl"));
        let pipeline = |name, any_hit: f64| {
            let constants = [("ANY_HIT", any_hit)];
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: None,
                module: &module,
                entry_point: Some(name),
                compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
                cache: None,
            })
        };
        let (closest_hits, occlusions) = (pipeline("closest_hits", 0.0), pipeline("occlusions", 1.0));
        let nodes = filled(&device, &queue, bytemuck::cast_slice(&bvh.nodes));
        let triangles = filled(&device, &queue, bytemuck::cast_slice(&in_order));
        Self { device, queue, closest_hits, occlusions, nodes, triangles }
    }

    /// What it holds on the device to trace with.
    pub(crate) fn bytes(&self) -> usize {
        (self.nodes.size() + self.triangles.size()) as usize
    }

    /// Ready to trace rays.
    pub(crate) fn contender<'a>(&'a self, rays: &[Ray], is_occlusion: bool) -> Box<dyn Contender + 'a> {
        let pipeline = if is_occlusion { &self.occlusions } else { &self.closest_hits };
        let answer = if is_occlusion { size_of::<u32>() } else { size_of::<[f32; 4]>() };
        let forms: Vec<[f32; 8]> = rays
            .iter()
            .map(|Ray { origin: o, t_min, direction: d, t_max }| {
                [o[0], o[1], o[2], *t_min, d[0], d[1], d[2], t_max.min(FARTHEST)]
            })
            .collect();
        let piece = |rays: &[[f32; 8]]| {
            let answers = self.buffer(rays.len() * answer, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
            let rays_buffer = filled(&self.device, &self.queue, bytemuck::cast_slice(rays));
            let buffers = [&self.nodes, &self.triangles, &rays_buffer, &answers];
            let entries = (0..).zip(buffers);
            let entries: Vec<_> = entries
                .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
                .collect();
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            Piece { group, answers, count: rays.len() }
        };
        Box::new(Traced { bvh: self, pipeline, is_occlusion, pieces: forms.chunks(PIECE).map(piece).collect() })
    }

    fn buffer(&self, bytes: usize, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        buffer(&self.device, bytes, usage)
    }

    /// The contents of a buffer, once everything is done that was asked for.
    fn read(&self, source: &wgpu::Buffer) -> Vec<u8> {
        let bytes = source.size();
        let staging = self.buffer(bytes as usize, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, bytes);
        self.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("memory that can be mapped"));
        self.wait();
        staging.get_mapped_range(..).expect("mapped").to_vec()
    }

    fn wait(&self) {
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("a working device");
    }
}

/// A dispatch's rays and answers.
struct Piece {
    group: wgpu::BindGroup,
    answers: wgpu::Buffer,
    count: usize,
}

struct Traced<'a> {
    bvh: &'a Cwbvh,
    pipeline: &'a wgpu::ComputePipeline,
    is_occlusion: bool,
    pieces: Vec<Piece>,
}

impl Contender for Traced<'_> {
    fn name(&self) -> &'static str {
        crate::report::CWBVH
    }

    fn trace(&mut self) -> Duration {
        let Cwbvh { device, queue, .. } = self.bvh;
        let has_stamps = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let start = Instant::now();
        let mut stamps = Vec::new();
        for Piece { group, count, .. } in &self.pieces {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let set = has_stamps.then(|| {
                let ty = wgpu::QueryType::Timestamp;
                device.create_query_set(&wgpu::QuerySetDescriptor { label: None, ty, count: 2 })
            });
            let timestamp_writes = set.as_ref().map(|query_set| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            });
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
            pass.set_pipeline(self.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(count.div_ceil(WORKGROUP) as u32, 1, 1);
            drop(pass);
            stamps.extend(set.map(|set| {
                let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
                let resolved = self.bvh.buffer(2 * size_of::<u64>(), usage);
                encoder.resolve_query_set(&set, 0..2, &resolved, 0);
                resolved
            }));
            queue.submit([encoder.finish()]);
        }
        self.bvh.wait();
        let by_wall = start.elapsed();
        if !has_stamps {
            return by_wall;
        }
        let ticks = |resolved: &wgpu::Buffer| {
            let [before, after]: [u64; 2] = bytemuck::pod_read_unaligned(&self.bvh.read(resolved));
            after.saturating_sub(before)
        };
        let ticks: u64 = stamps.iter().map(ticks).sum();
        Duration::from_nanos((ticks as f64 * f64::from(queue.get_timestamp_period())) as u64)
    }

    fn answers(&self) -> Vec<Hit> {
        let bytes = self.pieces.iter().map(|piece| self.bvh.read(&piece.answers));
        if self.is_occlusion {
            let of = |is_hit: &u32| if *is_hit != 0 { OCCLUDED } else { Hit::MISS };
            return bytes
                .flat_map(|bytes| bytemuck::pod_collect_to_vec(&bytes).iter().map(of).collect::<Vec<_>>())
                .collect();
        }
        let of = |hit: Hit| if hit.is_miss() || hit.primitive == Hit::MISS.primitive { Hit::MISS } else { hit };
        bytes.flat_map(|bytes| bytemuck::pod_collect_to_vec::<u8, Hit>(&bytes)).map(of).collect()
    }
}

/// A device on the adapter of that name, with all that it allows.
fn open(name: &str) -> (wgpu::Device, wgpu::Queue) {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let is_it = |adapter: &wgpu::Adapter| {
        let info = adapter.get_info();
        format!("{} by {:?}", info.name, info.backend) == name
    };
    let adapter = adapters.into_iter().find(is_it).expect("the adapter that leafwalk found");
    let descriptor = wgpu::DeviceDescriptor {
        required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
        required_limits: adapter.limits(),
        ..Default::default()
    };
    pollster::block_on(adapter.request_device(&descriptor)).expect("a device")
}

fn buffer(device: &wgpu::Device, bytes: usize, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = bytes as u64;
    device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
}

fn filled(device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> wgpu::Buffer {
    let buffer = buffer(device, bytes.len(), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
    queue.write_buffer(&buffer, 0, bytes);
    // What was written goes to the device now, so that the copies in between do not pile up.
    queue.submit([]);
    buffer
}
