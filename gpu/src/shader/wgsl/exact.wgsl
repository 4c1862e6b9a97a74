// Error terms of products, and quotients that round to nearest on any device, of operations that round once.

// core/src/lanes.rs: Lanes::product_error
fn product_error(a: f32, b: f32, product: f32) -> f32 {
    let a1 = bitcast<f32>(bitcast<u32>(a) & HEAD);
    let b1 = bitcast<f32>(bitcast<u32>(b) & HEAD);
    let a2 = sub(a, a1);
    let b2 = sub(b, b1);
    let rest = sub(sub(sub(product, mul(a1, b1)), mul(a2, b1)), mul(a1, b2));
    return sub(mul(a2, b2), rest);
}

// core/src/lanes.rs: Lanes::product_error serves here too: a - q * b for positive numbers, without error where q is one
// of the two floats next to a / b.
fn residual(a: f32, q: f32, b: f32) -> f32 {
    let product = mul(q, b);
    return sub(sub(a, product), product_error(q, b, product));
}

// core/src/lanes.rs: Lanes, its Div of f32 as near as the device comes
fn quotient(a: f32, b: f32) -> f32 {
    return guard(a / b);
}

// core/src/lanes.rs: Lanes, its Div of f32. A device's quotient may be 2.5 units off: a first correction brings it next
// to the true one, and of the two floats around that the one with the smaller residual is nearest (a quotient is never
// half way).
// b is normal and not 0; quotients under 2^-60 are small, not exact.
fn divide(a: f32, b: f32) -> f32 {
    // A power of two brings |b| into 1..2, so that no residual is subnormal.
    let exponent = bitcast<u32>(b) & 0x7f800000u;
    let scale = bitcast<f32>(0x7f000000u - exponent);
    let top = mul(abs(a), scale);
    let bottom = mul(abs(b), scale);
    let rough = quotient(top, bottom);
    let close = add(rough, quotient(residual(top, rough, bottom), bottom));
    let left = residual(top, close, bottom);
    // Floats of one sign are ordered as their bits.
    let other = bitcast<f32>(bitcast<u32>(close) + select(1u, 0xffffffffu, left < 0.0));
    let nearest = select(close, other, abs(residual(top, other, bottom)) < abs(left));
    return bitcast<f32>(bitcast<u32>(nearest) | ((bitcast<u32>(a) ^ bitcast<u32>(b)) & 0x80000000u));
}
