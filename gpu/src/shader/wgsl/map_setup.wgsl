// What a kernel is given that makes one buffer out of another.

// gpu/src/device/map_kernel.rs: MapSetup
struct Setup {
    first: u32,
    zero: u32,
    unused_0: u32,
    unused_1: u32,
}

@group(0) @binding(0) var<uniform> setup: Setup;
