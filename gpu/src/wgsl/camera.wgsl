// gpu/src/pinhole.rs: DeviceCamera
struct Camera {
    origin: vec3<f32>,
    t_min: f32,
    corner: vec3<f32>,
    t_max: f32,
    right: vec3<f32>,
    width: u32,
    down: vec3<f32>,
    height: u32,
    tiles_across: u32,
    first: u32,
    unused_0: u32,
    unused_1: u32,
}

@group(1) @binding(0) var<storage, read> camera: array<Camera, 1>;
@group(1) @binding(1) var<storage, read_write> rays: array<CanonicalRay>;

// gpu/src/pinhole.rs: Pinhole::pixel, every_other
fn every_other(bits: u32) -> u32 {
    return (bits & 1u) | ((bits >> 1u) & 2u) | ((bits >> 2u) & 4u);
}

// gpu/src/pinhole.rs: Pinhole::pixel
fn pixel_of(number: u32) -> vec2<u32> {
    let tile = number / WORKGROUP;
    let within = number % WORKGROUP;
    let across = camera[0].tiles_across;
    return vec2<u32>(tile % across, tile / across) * TILE + vec2<u32>(every_other(within), every_other(within >> 1u));
}

// core/src/canonical.rs: Common::new, its direction
fn canonical_direction(direction: vec3<f32>) -> vec3<f32> {
    let size = abs(direction);
    let exponent = bitcast<u32>(max(max(size.x, size.y), size.z)) & 0x7f800000u;
    let scaled = mul3(direction, vec3<f32>(bitcast<f32>(0x7f000000u - exponent)));
    return select(scaled, vec3<f32>(0.0), abs(scaled) < vec3<f32>(SMALLEST_DIRECTION));
}

// gpu/src/pinhole.rs: Pinhole::ray, made canonical
@compute @workgroup_size(WORKGROUP)
fn camera_rays(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&rays) {
        return;
    }
    let pixel = pixel_of(camera[0].first + id.x);
    let across = mul3(vec3<f32>(f32(pixel.x)), camera[0].right);
    let below = mul3(vec3<f32>(f32(pixel.y)), camera[0].down);
    let direction = add3(add3(camera[0].corner, across), below);
    if pixel.x >= camera[0].width || pixel.y >= camera[0].height || all(direction == vec3<f32>(0.0)) {
        // gpu/src/ray.rs: DeviceRay::NEVER
        rays[id.x] = CanonicalRay(vec3<f32>(0.0), 0.0, vec3<f32>(1.0), 0.0);
        return;
    }
    rays[id.x] = CanonicalRay(camera[0].origin, camera[0].t_min, canonical_direction(direction), camera[0].t_max);
}
