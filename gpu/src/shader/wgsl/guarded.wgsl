// An exclusive or with a zero that only the run knows: nothing can be fused or regrouped across it.

fn guard(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ setup.zero);
}

fn guard3(x: vec3<f32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bitcast<vec3<u32>>(x) ^ vec3<u32>(setup.zero));
}

fn guard4(x: vec4<f32>) -> vec4<f32> {
    return bitcast<vec4<f32>>(bitcast<vec4<u32>>(x) ^ vec4<u32>(setup.zero));
}
