// The traversal of compressed wide BVHs by Ylitie, Karras and Laine (2017), over obvhs's nodes (obvhs/src/cwbvh/node.rs),
// with the triangle test of Möller and Trumbore. Left out are the paper's postponed triangles and its fetching of new
// rays by idle lanes: they take votes across a subgroup, which WebGPU does not promise.

struct Ray {
    origin: vec3<f32>,
    t_min: f32,
    direction: vec3<f32>,
    t_max: f32,
}

struct Hit {
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
}

@group(0) @binding(0) var<storage, read> nodes: array<vec4<u32>>;
// Each triangle: the first vertex with the primitive's index, and the edges from it.
@group(0) @binding(1) var<storage, read> triangles: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> rays: array<Ray>;
// Each kernel writes one of the two.
@group(0) @binding(3) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(3) var<storage, read_write> occluded: array<u32>;

// Whether the first hit ends it, whichever that is.
override ANY_HIT: bool = false;

const NONE: u32 = 0xffffffffu;
// Nodes a ray may have to come back to: what obvhs allows itself.
const STACK: u32 = 32u;
const NODE_QUADS: u32 = 5u;
const TRIANGLE_QUADS: u32 = 3u;
// A group: the hits that are nodes, nearest first from the top; below them which children are nodes.
const NODES: u32 = 0xff000000u;
// Stands for smaller direction components.
const SMALLEST: f32 = 1e-20;

// The bytes of a word, lowest first.
fn bytes(word: u32) -> vec4<u32> {
    return (vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(0xffu);
}

// From a node's grid to distances along the ray.
struct Grid {
    scale: vec3<f32>,
    start: vec3<f32>,
}

// The bits of those of four children that the ray meets between two distances.
fn met(grid: Grid, near: vec3<u32>, far: vec3<u32>, about: u32, octant: u32, first: f32, last: f32) -> u32 {
    let near_x = vec4<f32>(bytes(near.x)) * grid.scale.x + grid.start.x;
    let near_y = vec4<f32>(bytes(near.y)) * grid.scale.y + grid.start.y;
    let near_z = vec4<f32>(bytes(near.z)) * grid.scale.z + grid.start.z;
    let far_x = vec4<f32>(bytes(far.x)) * grid.scale.x + grid.start.x;
    let far_y = vec4<f32>(bytes(far.y)) * grid.scale.y + grid.start.y;
    let far_z = vec4<f32>(bytes(far.z)) * grid.scale.z + grid.start.z;
    let enter = max(max(near_x, near_y), max(near_z, vec4<f32>(first)));
    let leave = min(min(far_x, far_y), min(far_z, vec4<f32>(last)));
    // Nodes are numbered 24 to 31, and only they have both of these bits.
    let is_node = (about & (about << 1u)) & 0x10101010u;
    let places = (about ^ (octant & ((is_node >> 4u) * 0xffu))) & 0x1f1f1f1fu;
    let ones = (about >> 5u) & 0x07070707u;
    let bits = select(vec4<u32>(0u), bytes(ones) << bytes(places), enter <= leave);
    return bits.x | bits.y | bits.z | bits.w;
}

fn test_triangle(ray: Ray, number: u32, hit: ptr<function, Hit>) {
    let corner = triangles[number * TRIANGLE_QUADS];
    let b = triangles[number * TRIANGLE_QUADS + 1u].xyz;
    let c = triangles[number * TRIANGLE_QUADS + 2u].xyz;
    let across = cross(ray.direction, c);
    let inverse = 1.0 / dot(b, across);
    let offset = ray.origin - corner.xyz;
    let u = dot(offset, across) * inverse;
    let along = cross(offset, b);
    let v = dot(ray.direction, along) * inverse;
    let t = dot(c, along) * inverse;
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray.t_min && t < (*hit).t {
        *hit = Hit(t, u, v, bitcast<u32>(corner.w));
    }
}

fn traverse(ray: Ray) -> Hit {
    var hit = Hit(ray.t_max, 0.0, 0.0, NONE);
    let is_still = abs(ray.direction) < vec3<f32>(SMALLEST);
    let inverse = vec3<f32>(1.0) / select(ray.direction, vec3<f32>(SMALLEST), is_still);
    let is_down = inverse < vec3<f32>(0.0);
    let upward = select(vec3<u32>(0x04040404u, 0x02020202u, 0x01010101u), vec3<u32>(0u), is_down);
    let octant = upward.x | upward.y | upward.z;
    var stack: array<vec2<u32>, STACK>;
    var height = 0u;
    var group = vec2<u32>(0u, 0x80000000u);
    loop {
        let bit = firstLeadingBit(group.y);
        let slot = (bit - 24u) ^ (octant & 0xffu);
        let number = group.x + countOneBits(group.y & ~(NONE << slot));
        group.y &= ~(1u << bit);
        if (group.y & NODES) != 0u {
            stack[height] = group;
            height += 1u;
        }
        let at = number * NODE_QUADS;
        let head = nodes[at];
        let list = nodes[at + 1u];
        let x = nodes[at + 2u];
        let y = nodes[at + 3u];
        let z = nodes[at + 4u];
        let exponents = bytes(head.w).xyz << vec3<u32>(23u);
        let start = (bitcast<vec3<f32>>(head.xyz) - ray.origin) * inverse;
        let grid = Grid(bitcast<vec3<f32>>(exponents) * inverse, start);
        let near_x = select(x.xy, x.zw, is_down.x);
        let near_y = select(y.xy, y.zw, is_down.y);
        let near_z = select(z.xy, z.zw, is_down.z);
        let far_x = select(x.zw, x.xy, is_down.x);
        let far_y = select(y.zw, y.xy, is_down.y);
        let far_z = select(z.zw, z.xy, is_down.z);
        let low = met(
            grid,
            vec3<u32>(near_x.x, near_y.x, near_z.x),
            vec3<u32>(far_x.x, far_y.x, far_z.x),
            list.z,
            octant,
            ray.t_min,
            hit.t,
        );
        let high = met(
            grid,
            vec3<u32>(near_x.y, near_y.y, near_z.y),
            vec3<u32>(far_x.y, far_y.y, far_z.y),
            list.w,
            octant,
            ray.t_min,
            hit.t,
        );
        let found = low | high;
        group = vec2<u32>(list.x, (found & NODES) | (head.w >> 24u));
        var waiting = found & ~NODES;
        while waiting != 0u {
            test_triangle(ray, list.y + firstTrailingBit(waiting), &hit);
            waiting &= waiting - 1u;
        }
        if ANY_HIT && hit.primitive != NONE {
            break;
        }
        if (group.y & NODES) == 0u {
            if height == 0u {
                break;
            }
            height -= 1u;
            group = stack[height];
        }
    }
    return hit;
}

@compute @workgroup_size(64)
fn closest_hits(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&rays) {
        hits[id.x] = traverse(rays[id.x]);
    }
}

@compute @workgroup_size(64)
fn occlusions(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&rays) {
        occluded[id.x] = u32(traverse(rays[id.x]).primitive != NONE);
    }
}
