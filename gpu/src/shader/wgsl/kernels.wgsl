// The kernels that walk, an invocation a ray, and what they write.

// core/src/ray.rs: Hit, with t'; a miss has NONE for its primitive.
struct Hit {
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
}

// core/src/trace.rs: Work beside the hit
struct Answer {
    hit: Hit,
    cells: u32,
    blocks: u32,
    unused_0: u32,
    unused_1: u32,
}

@group(1) @binding(0) var<storage, read> rays: array<CanonicalRay>;
// Each kernel writes one of the three.
@group(1) @binding(1) var<storage, read_write> hits: array<Hit>;
@group(1) @binding(1) var<storage, read_write> occluded: array<u32>;
@group(1) @binding(1) var<storage, read_write> answers: array<Answer>;

// core/src/nearest.rs: Nearest::hit, without the clock
fn hit_of(nearest: Nearest) -> Hit {
    return Hit(nearest.t, nearest.u, nearest.v, nearest.primitive);
}

// core/src/trace.rs: Walk::closest_hit
@compute @workgroup_size(WORKGROUP)
fn closest_hits(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&rays) {
        hits[id.x] = hit_of(walk(rays[id.x]).nearest);
    }
}

// core/src/trace.rs: Walk::occluded
@compute @workgroup_size(WORKGROUP)
fn occlusions(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&rays) {
        occluded[id.x] = u32(is_hit(walk(rays[id.x]).nearest));
    }
}

// core/src/trace.rs: Walk::closest_hit_with_work
@compute @workgroup_size(WORKGROUP)
fn closest_hits_with_work(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&rays) {
        let search = walk(rays[id.x]);
        answers[id.x] = Answer(hit_of(search.nearest), search.cells, search.blocks, 0u, 0u);
    }
}
