// Rays against boxes. These tests err only by keeping too much, so nothing here is guarded.

// core/src/slabs.rs: Slabs
struct Slabs {
    inverse: vec3<f32>,
    near: vec3<f32>,
    far: vec3<f32>,
}

// core/src/slabs.rs: Slabs::new
fn slabs_of(origin: vec3<f32>, inverse: vec3<f32>) -> Slabs {
    let lower = -(origin + vec3<f32>(BOX_MARGIN)) * inverse;
    let upper = (vec3<f32>(1.0 + BOX_MARGIN) - origin) * inverse;
    let is_negative = inverse < vec3<f32>(0.0);
    return Slabs(inverse, select(lower, upper, is_negative), select(upper, lower, is_negative));
}

// core/src/slabs.rs: Slabs::in_lattice. The difference is guarded: regrouped, it would be of numbers of the scene's size.
fn slabs_in_lattice(lattice: vec4<f32>, origin: vec3<f32>, inverse: vec3<f32>) -> Slabs {
    let away = sub3(lattice.xyz, origin);
    let distance = abs(away);
    let farthest = max(distance.x, max(distance.y, distance.z)) + f32(LATTICE) * lattice.w;
    let margin = farthest * (BOX_MARGIN / f32(LATTICE));
    let lower = (away - vec3<f32>(margin)) * inverse;
    let upper = (away + vec3<f32>(lattice.w + margin)) * inverse;
    let is_negative = inverse < vec3<f32>(0.0);
    return Slabs(inverse * lattice.w, select(lower, upper, is_negative), select(upper, lower, is_negative));
}

// core/src/slabs.rs: Slabs::clip, at the near sides of four boxes along an axis
fn clip_near(first: vec4<f32>, near: vec4<f32>, slabs: Slabs, axis: u32) -> vec4<f32> {
    return max(first, near * pick(slabs.inverse, axis) + pick(slabs.near, axis));
}

// core/src/slabs.rs: Slabs::clip, at the far sides
fn clip_far(last: vec4<f32>, far: vec4<f32>, slabs: Slabs, axis: u32) -> vec4<f32> {
    return min(last, far * pick(slabs.inverse, axis) + pick(slabs.far, axis));
}
