// Error terms of products and quotients as the device has them.

// core/src/lanes.rs: Lanes::product_error, where fma rounds once.
fn product_error(a: f32, b: f32, product: f32) -> f32 {
    return fma(a, b, -product);
}

// core/src/lanes.rs: Lanes, its Div of f32
fn divide(a: f32, b: f32) -> f32 {
    return a / b;
}
