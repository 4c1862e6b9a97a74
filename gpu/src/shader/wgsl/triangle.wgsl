// The watertight triangle test (S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", Journal of Computer
// Graphics Techniques 2(1), 2013, https://jcgt.org/published/0002/01/05/). Differences of products only sift; candidates
// are finished with products whose rounding errors are added back.

// core/src/triangle.rs: Shear, and the permutation it was made with
struct Shear {
    origin: vec3<f32>,
    slope: vec3<f32>,
    axes: vec3<u32>,
}

// core/src/triangle.rs: permutation
fn permutation(direction: vec3<f32>) -> vec3<u32> {
    let size = abs(direction);
    let is_x = size.y <= size.x && size.z <= size.x;
    let is_y = size.z <= size.y && !is_x;
    return select(select(vec3<u32>(0u, 1u, 2u), vec3<u32>(2u, 0u, 1u), is_y), vec3<u32>(1u, 2u, 0u), is_x);
}

// core/src/triangle.rs: Shear::new, its `permuted`
fn permuted(v: vec3<f32>, axes: vec3<u32>) -> vec3<f32> {
    return vec3<f32>(pick(v, axes.x), pick(v, axes.y), pick(v, axes.z));
}

// core/src/triangle.rs: Shear::of_permuted, its slope
fn slope_of(direction: vec3<f32>) -> vec3<f32> {
    let d = permuted(direction, permutation(direction));
    return vec3<f32>(divide(d.x, d.z), divide(d.y, d.z), divide(1.0, d.z));
}

// core/src/triangle.rs: Shear::new
fn shear_of(origin: vec3<f32>, direction: vec3<f32>, slope: vec3<f32>) -> Shear {
    let axes = permutation(direction);
    return Shear(permuted(origin, axes), slope, axes);
}

// core/src/layout/block.rs: Block::vertices, four lanes of them: a corner on one axis
fn coordinates(block: u32, corner: u32, axis: u32, half: u32) -> vec4<f32> {
    let at = block * BLOCK_QUADS + (3u * corner + axis) * LANE_QUADS + half;
    return bitcast<vec4<f32>>(quad(setup.blocks + at));
}

// core/src/triangle.rs: Sheared::x and Sheared::y, of four lanes
struct Sheared4 {
    x: vec4<f32>,
    y: vec4<f32>,
}

// core/src/triangle.rs: Sheared::new, of four lanes
fn sheared4(shear: Shear, block: u32, corner: u32, half: u32) -> Sheared4 {
    let z = sub4(coordinates(block, corner, shear.axes.z, half), vec4<f32>(shear.origin.z));
    let x = sub4(coordinates(block, corner, shear.axes.x, half), vec4<f32>(shear.origin.x));
    let y = sub4(coordinates(block, corner, shear.axes.y, half), vec4<f32>(shear.origin.y));
    return Sheared4(sub4(x, mul4(vec4<f32>(shear.slope.x), z)), sub4(y, mul4(vec4<f32>(shear.slope.y), z)));
}

// core/src/triangle.rs: Sheared::is_candidate, of four lanes
fn candidates4(shear: Shear, block: u32, half: u32) -> u32 {
    let a = sheared4(shear, block, 0u, half);
    let b = sheared4(shear, block, 1u, half);
    let c = sheared4(shear, block, 2u, half);
    let u = sub4(mul4(c.x, b.y), mul4(c.y, b.x));
    let v = sub4(mul4(a.x, c.y), mul4(a.y, c.x));
    let w = sub4(mul4(b.x, a.y), mul4(b.y, a.x));
    let slack = vec4<f32>(CANDIDATE_SLACK);
    let is_candidate = (-slack <= min(min(u, v), w)) | (max(max(u, v), w) <= slack);
    return mask4(is_candidate);
}

// core/src/lanes.rs: Mask::to_bits, of four lanes
fn mask4(lanes: vec4<bool>) -> u32 {
    let bits = select(vec4<u32>(0u), vec4<u32>(1u, 2u, 4u, 8u), lanes);
    return bits.x | bits.y | bits.z | bits.w;
}

// core/src/triangle.rs: difference_of_products
fn difference_of_products(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let p = mul(a, b);
    let q = mul(c, d);
    return add(sub(p, q), sub(product_error(a, b, p), product_error(c, d, q)));
}

// core/src/triangle.rs: Candidate, and whether it was accepted
struct Candidate {
    is_accepted: bool,
    t: f32,
    u: f32,
    v: f32,
}

// core/src/layout/block.rs: Block::vertices, one lane of them
fn coordinate(block: u32, corner: u32, axis: u32, lane: u32) -> f32 {
    let at = setup.blocks + block * BLOCK_QUADS + (3u * corner + axis) * LANE_QUADS;
    return bitcast<f32>(word((at << 2u) + lane));
}

// core/src/layout/block.rs: Block::corners, one corner of one lane, permuted
fn permuted_corner(shear: Shear, block: u32, corner: u32, lane: u32) -> vec3<f32> {
    return vec3<f32>(
        coordinate(block, corner, shear.axes.x, lane),
        coordinate(block, corner, shear.axes.y, lane),
        coordinate(block, corner, shear.axes.z, lane),
    );
}

// core/src/triangle.rs: Sheared::new, of one corner of one lane
fn sheared(shear: Shear, point: vec3<f32>) -> vec3<f32> {
    let p = sub3(point, shear.origin);
    return vec3<f32>(sub(p.x, mul(shear.slope.x, p.z)), sub(p.y, mul(shear.slope.y, p.z)), p.z);
}

// core/src/plane.rs: sum
fn sum_of(a: f32, b: f32) -> vec2<f32> {
    let sum = add(a, b);
    let other = sub(sum, a);
    return vec2<f32>(sum, add(sub(a, sub(sum, other)), sub(b, other)));
}

// core/src/plane.rs: Interpolated
struct Interpolated {
    at: vec2<f32>,
    ab: f32,
    ac: f32,
}

// core/src/plane.rs: Interpolated::new, of the coordinates of three corners on one axis
fn interpolated(origin: f32, a: f32, b: f32, c: f32, v: f32, w: f32) -> Interpolated {
    let from_origin = sum_of(a, -origin);
    let ab = sum_of(b, -a);
    let ac = sum_of(c, -a);
    let p = mul(v, ab.x);
    let q = mul(w, ac.x);
    let moved = sum_of(p, q);
    let at = sum_of(from_origin.x, moved.x);
    let products = add(product_error(v, ab.x, p), product_error(w, ac.x, q));
    let rests = add(from_origin.y, add(mul(v, ab.y), mul(w, ac.y)));
    return Interpolated(vec2<f32>(at.x, add(add(add(moved.y, at.y), products), rests)), ab.x, ac.x);
}

// core/src/plane.rs: Interpolated::beside
fn beside(at: vec2<f32>, depth: vec2<f32>, slope: f32) -> f32 {
    let product = mul(slope, depth.x);
    let rest = sub(sub(at.y, product_error(slope, depth.x, product)), mul(slope, depth.y));
    return flush(add(sub(at.x, product), rest), SMALLEST_SHEARED);
}

// core/src/plane.rs: met, for corners that are a, b and c
fn met(
    shear: Shear,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    of_b: f32,
    of_c: f32,
    area: f32,
    by_weights: f32,
    largest: f32,
) -> f32 {
    if abs(area) < SMALLEST_AREA || largest < SMALLEST_SHEARED {
        return by_weights;
    }
    let v = flush(of_b, SMALLEST_WEIGHT);
    let w = flush(of_c, SMALLEST_WEIGHT);
    let x = interpolated(shear.origin.x, a.x, b.x, c.x, v, w);
    let y = interpolated(shear.origin.y, a.y, b.y, c.y, v, w);
    let z = interpolated(shear.origin.z, a.z, b.z, c.z, v, w);
    let depth = vec2<f32>(flush(z.at.x, SMALLEST_SHEARED), flush(z.at.y, SMALLEST_SHEARED));
    let beside_x = beside(x.at, depth, shear.slope.x);
    let beside_y = beside(y.at, depth, shear.slope.y);
    let normal_x = flush(sub(mul(y.ac, z.ab), mul(z.ac, y.ab)), SMALLEST_AREA);
    let normal_y = flush(sub(mul(z.ac, x.ab), mul(x.ac, z.ab)), SMALLEST_AREA);
    let to_ray = flush(divide(add(mul(normal_x, beside_x), mul(normal_y, beside_y)), area), SMALLEST_SHEARED);
    let found = add(depth.x, add(depth.y, to_ray));
    let sizes = abs(vec3<f32>(sub(a.z, shear.origin.z), sub(b.z, shear.origin.z), sub(c.z, shear.origin.z)));
    let slack = mul(max(sizes.x, max(sizes.y, sizes.z)), PLANE_SLACK);
    return max(sub(by_weights, slack), min(found, add(by_weights, slack)));
}

// core/src/triangle.rs: Sheared::finish
fn finish(shear: Shear, block: u32, lane: u32) -> Candidate {
    let corners = array<vec3<f32>, 3>(
        permuted_corner(shear, block, 0u, lane),
        permuted_corner(shear, block, 1u, lane),
        permuted_corner(shear, block, 2u, lane),
    );
    let a = sheared(shear, corners[0]);
    let b = sheared(shear, corners[1]);
    let c = sheared(shear, corners[2]);
    let ax = flush(a.x, SMALLEST_SHEARED);
    let bx = flush(b.x, SMALLEST_SHEARED);
    let cx = flush(c.x, SMALLEST_SHEARED);
    let ay = flush(a.y, SMALLEST_SHEARED);
    let by = flush(b.y, SMALLEST_SHEARED);
    let cy = flush(c.y, SMALLEST_SHEARED);
    let u = difference_of_products(cx, by, cy, bx);
    let v = difference_of_products(ax, cy, ay, cx);
    let w = difference_of_products(bx, ay, by, ax);
    let is_negative = u < 0.0 || v < 0.0 || w < 0.0;
    let is_positive = 0.0 < u || 0.0 < v || 0.0 < w;
    if is_negative == is_positive {
        return Candidate(false, 0.0, 0.0, 0.0);
    }
    let area = add(add(u, v), w);
    let of_b = divide(v, area);
    let of_c = divide(w, area);
    let towards_b = mul(of_b, sub(b.z, a.z));
    let depth = add(a.z, add(towards_b, mul(of_c, sub(c.z, a.z))));
    var t = mul(depth, shear.slope.z);
    let largest = max(abs(a.z), abs(towards_b));
    if mul(t, CANCELLATION) < largest && mul(t, BEHIND) < largest {
        t = mul(met(shear, corners[0], corners[1], corners[2], of_b, of_c, area, depth, largest), shear.slope.z);
    }
    return Candidate(true, flush(t, SMALLEST), flush(of_b, SMALLEST), flush(of_c, SMALLEST));
}
