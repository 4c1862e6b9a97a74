// core/src/lanes.rs: Lanes for f32. Every operation rounds once, to nearest.

fn add(a: f32, b: f32) -> f32 {
    return guard(a + b);
}

fn sub(a: f32, b: f32) -> f32 {
    return guard(a - b);
}

fn mul(a: f32, b: f32) -> f32 {
    return guard(a * b);
}

fn add3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return guard3(a + b);
}

fn sub3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return guard3(a - b);
}

fn mul3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return guard3(a * b);
}

fn sub4(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return guard4(a - b);
}

fn mul4(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return guard4(a * b);
}

// core/src/lanes.rs: Lanes::flush
fn flush(x: f32, smallest: f32) -> f32 {
    return select(x, 0.0, abs(x) < smallest);
}
