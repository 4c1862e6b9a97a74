// The kernels of the self-test: numbers in, and what the driver makes of them.

@group(1) @binding(0) var<storage, read> questions: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> results: array<array<f32, RESULTS>>;

// gpu/src/device/departure.rs: Departure::expected. Plain expressions first, then what the tracer computes with.
@compute @workgroup_size(WORKGROUP)
fn self_test(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&questions) {
        let a = questions[id.x].x;
        let b = questions[id.x].y;
        let c = questions[id.x].z;
        results[id.x][0] = a * b + c;
        results[id.x][1] = (a + b) - b;
        results[id.x][2] = a / b;
        results[id.x][3] = add(mul(a, b), c);
        results[id.x][4] = sub(add(a, b), b);
        results[id.x][5] = divide(a, b);
        results[id.x][6] = product_error(a, b, mul(a, b));
    }
}

@group(1) @binding(1) var<storage, read_write> entries: array<u32>;

// core/src/tables.rs: EXIT_FACE, then SUB_FACE, entry by entry
@compute @workgroup_size(WORKGROUP)
fn table_entries(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&entries) {
        let row = id.x / 8u;
        let index = id.x % 8u;
        if row < 8u {
            entries[id.x] = exit_face(row, index);
        } else {
            entries[id.x] = sub_face(row - 8u, index);
        }
    }
}
