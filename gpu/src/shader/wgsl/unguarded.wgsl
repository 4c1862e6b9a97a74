// No guards: the driver may fuse and regroup.

fn guard(x: f32) -> f32 {
    return x;
}

fn guard3(x: vec3<f32>) -> vec3<f32> {
    return x;
}

fn guard4(x: vec4<f32>) -> vec4<f32> {
    return x;
}
