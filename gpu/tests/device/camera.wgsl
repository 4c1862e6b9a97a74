// A pinhole camera, by which the tests use the door for ray generation shaders.

// gpu/tests/device/pinhole.rs: DeviceCamera
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
    unused_0: u32,
    unused_1: u32,
    unused_2: u32,
}

// gpu/tests/device/pinhole.rs: TILE
const TILE: u32 = 8u;

@group(1) @binding(0) var<storage, read> camera: array<Camera, 1>;

// gpu/tests/device/pinhole.rs: every_other
fn every_other(bits: u32) -> u32 {
    return (bits & 1u) | ((bits >> 1u) & 2u) | ((bits >> 2u) & 4u);
}

// gpu/tests/device/pinhole.rs: Pinhole::pixel
fn pixel_of(number: u32) -> vec2<u32> {
    let tile = number / (TILE * TILE);
    let within = number % (TILE * TILE);
    let across = camera[0].tiles_across;
    return vec2<u32>(tile % across, tile / across) * TILE + vec2<u32>(every_other(within), every_other(within >> 1u));
}

// gpu/tests/device/pinhole.rs: Pinhole::ray, made canonical
fn generate_ray(number: u32) -> CanonicalRay {
    let pixel = pixel_of(number);
    let across = mul3(vec3<f32>(f32(pixel.x)), camera[0].right);
    let below = mul3(vec3<f32>(f32(pixel.y)), camera[0].down);
    let direction = add3(add3(camera[0].corner, across), below);
    if pixel.x >= camera[0].width || pixel.y >= camera[0].height || all(direction == vec3<f32>(0.0)) {
        return no_ray();
    }
    return CanonicalRay(camera[0].origin, camera[0].t_min, canonical_direction(direction), camera[0].t_max);
}
