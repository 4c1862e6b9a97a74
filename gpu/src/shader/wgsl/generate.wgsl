// The kernel that makes rays by the caller's function `generate_ray`, and what it gives to that function.

@group(1) @binding(1) var<storage, read_write> rays: array<CanonicalRay>;

// gpu/src/walk/ray.rs: DeviceRay::NEVER
fn no_ray() -> CanonicalRay {
    return CanonicalRay(vec3<f32>(0.0), 0.0, vec3<f32>(1.0), 0.0);
}

// core/src/canonical.rs: CommonRays::new, its direction
fn canonical_direction(direction: vec3<f32>) -> vec3<f32> {
    let size = abs(direction);
    let exponent = bitcast<u32>(max(max(size.x, size.y), size.z)) & 0x7f800000u;
    let scaled = mul3(direction, vec3<f32>(bitcast<f32>(0x7f000000u - exponent)));
    return select(scaled, vec3<f32>(0.0), abs(scaled) < vec3<f32>(SMALLEST_DIRECTION));
}

// gpu/src/resident/generator.rs: RayGenerator::generate, on the device
@compute @workgroup_size(WORKGROUP)
fn generate_rays(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&rays) {
        rays[id.x] = generate_ray(setup.first + id.x);
    }
}
