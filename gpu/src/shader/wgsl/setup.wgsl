// Where the octree's sections start, its root, and the hull.

// gpu/src/walk/octree.rs: OctreeSetup
struct Setup {
    records: u32,
    payloads: u32,
    blocks: u32,
    grid: u32,
    corner: vec3<f32>,
    grid_bits: u32,
    hull_lower: vec3<f32>,
    zero: u32,
    hull_upper: vec3<f32>,
    bvh: u32,
    lattices: u32,
    unused_0: u32,
    unused_1: u32,
    unused_2: u32,
}

@group(0) @binding(0) var<uniform> setup: Setup;
