// The walk from leaf to leaf, as core/src/trace.rs makes it:
//
//     cell = the leaf that holds the point where the ray enters the hull
//     repeat:
//         if the leaf lists anything:
//             descend to the blocks of triangles whose boxes the ray meets, test them, and keep the nearest hit
//         find the face by which the ray leaves the cell
//         end if the nearest hit, or the hull's end, lies before that face by the padding, or no leaf lies behind the face
//         cell = the leaf behind the face: as large, larger, or of four smaller ones the one that the ray enters
//
// It departs from that walk in order, not in arithmetic:
// 1. Empty leaves have a loop of their own: the lanes of a subgroup wait for each other at leaves that list something, not
//    at every cell.
// 2. Slabs and shear are made anew in each leaf, which is cheaper than to keep them in registers from leaf to leaf.
// 3. A block's triangles are sifted four at a time, and its boxes eight at a time in two halves of a word.

// core/src/nearest.rs: Nearest
struct Nearest {
    t_min: f32,
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
}

// core/src/nearest.rs: Nearest::is_hit
fn is_hit(nearest: Nearest) -> bool {
    return nearest.primitive != NONE;
}

// core/src/nearest.rs: Nearest::offer
fn offer(nearest: ptr<function, Nearest>, found: Candidate, primitive: u32) {
    let is_tie_won = found.t == (*nearest).t && primitive < (*nearest).primitive && is_hit(*nearest);
    if found.t > (*nearest).t_min && (found.t < (*nearest).t || is_tie_won) {
        *nearest = Nearest((*nearest).t_min, found.t, found.u, found.v, primitive);
    }
}

// core/src/start.rs: Span
struct Span {
    start: vec3<f32>,
    end: f32,
    is_met: bool,
}

// core/src/start.rs: Span::new
fn span_of(line: Line, ray: CanonicalRay) -> Span {
    let a = mul3(sub3(setup.hull_lower, line.origin), line.inverse);
    let b = mul3(sub3(setup.hull_upper, line.origin), line.inverse);
    let near = min(a, b);
    let far = max(a, b);
    let first = max(max(ray.t_min, near.x), max(near.y, near.z));
    let last = min(min(ray.t_max, far.x), min(far.y, far.z));
    let start = add3(line.origin, mul3(vec3<f32>(sub(first, START_MARGIN)), line.direction));
    let is_met = first <= last && ray.t_min < ray.t_max;
    return Span(clamp(start, vec3<f32>(0.0), vec3<f32>(f32(LATTICE))), last, is_met);
}

// core/src/start.rs: locate
fn locate(point: vec3<f32>, line: Line) -> Crossing {
    let whole = min(vec3<u32>(point), vec3<u32>(LATTICE - 1u));
    let backs_off = (upward(line) == vec3<u32>(0u)) & (vec3<f32>(whole) == point) & (whole > vec3<u32>(0u));
    let corner = whole - select(vec3<u32>(0u), ONE_EACH, backs_off);
    let entry = corner >> vec3<u32>(MAX_LEVEL - setup.grid_bits);
    let at = entry.x | (entry.y << setup.grid_bits) | (entry.z << (2u * setup.grid_bits));
    var record = word((setup.grid << 2u) + at);
    var head = quad(setup.records + record * RECORD_QUADS);
    var size = LATTICE >> level(head.x);
    // Each turn goes down a level.
    while is_inner(head.x) {
        size >>= 1u;
        let upper = select(vec3<u32>(0u), ONE_EACH, (corner & vec3<u32>(size)) != vec3<u32>(0u));
        record = head.y + (upper.x | (upper.y << 1u) | (upper.z << 2u));
        head = quad(setup.records + record * RECORD_QUADS);
    }
    return Crossing(record, Cell(corner & vec3<u32>(~(size - 1u)), size));
}

// core/src/probe.rs: Probe::enter; bit i: the box in slot i is met
fn boxes_met(node: u32, slabs: Slabs, neg: u32, first: f32, last: f32) -> u32 {
    var near_even = vec4<f32>(first);
    var near_odd = vec4<f32>(first);
    var far_even = vec4<f32>(last);
    var far_odd = vec4<f32>(last);
    for (var axis = 0u; axis < 3u; axis++) {
        let is_down = (neg >> axis) & 1u;
        let near = quad(node + 2u * axis + is_down);
        let far = quad(node + 2u * axis + (is_down ^ 1u));
        near_even = clip_near(near_even, vec4<f32>(near & vec4<u32>(0xffffu)), slabs, axis);
        near_odd = clip_near(near_odd, vec4<f32>(near >> vec4<u32>(16u)), slabs, axis);
        far_even = clip_far(far_even, vec4<f32>(far & vec4<u32>(0xffffu)), slabs, axis);
        far_odd = clip_far(far_odd, vec4<f32>(far >> vec4<u32>(16u)), slabs, axis);
    }
    let even = select(vec4<u32>(0u), vec4<u32>(1u, 4u, 16u, 64u), near_even <= far_even);
    let odd = select(vec4<u32>(0u), vec4<u32>(2u, 8u, 32u, 128u), near_odd <= far_odd);
    let met = even | odd;
    return met.x | met.y | met.z | met.w;
}

// core/src/probe.rs: in_order
fn in_order(met: u32, neg: u32) -> u32 {
    let x = select(met, ((met & 0x55u) << 1u) | ((met >> 1u) & 0x55u), (neg & 1u) != 0u);
    let y = select(x, ((x & 0x33u) << 2u) | ((x >> 2u) & 0x33u), (neg & 2u) != 0u);
    return select(y, ((y & 0x0fu) << 4u) | ((y >> 4u) & 0x0fu), (neg & 4u) != 0u);
}

// core/src/probe.rs: Probe::clip, a side of the box in a slot
fn side_of(node: u32, axis: u32, is_upper: u32, slot: u32) -> f32 {
    let both = word(((node + 2u * axis + is_upper) << 2u) + (slot >> 1u));
    return f32((both >> (16u * (slot & 1u))) & 0xffffu);
}

// core/src/probe.rs: Probe::clip, the rest
fn clip_slot(node: u32, slot: u32, slabs: Slabs, neg: u32, first: f32, last: f32) -> vec2<f32> {
    var part = vec2<f32>(first, last);
    for (var axis = 0u; axis < 3u; axis++) {
        let is_down = (neg >> axis) & 1u;
        part.x = max(part.x, side_of(node, axis, is_down, slot) * pick(slabs.inverse, axis) + pick(slabs.near, axis));
        part.y = min(part.y, side_of(node, axis, is_down ^ 1u, slot) * pick(slabs.inverse, axis) + pick(slabs.far, axis));
    }
    return part;
}

// core/src/trace.rs: Search::test_block
fn test_block(block: u32, shear: Shear, nearest: ptr<function, Nearest>) {
    // Few blocks hold a candidate, so all lanes are sifted before any is finished.
    var candidates = candidates4(shear, block, 0u) | (candidates4(shear, block, 1u) << 4u);
    while candidates != 0u {
        let lane = firstTrailingBit(candidates);
        candidates &= candidates - 1u;
        let primitive = word(((setup.blocks + block * BLOCK_QUADS + PRIMITIVES_QUAD) << 2u) + lane);
        // A vacant lane would be finished as often as the lane that it repeats.
        if primitive != NONE {
            let found = finish(shear, block, lane);
            if found.is_accepted {
                offer(nearest, found, primitive);
            }
        }
    }
}

// Whether the boxes of each node of the BVH count steps of a lattice of its own.
override IS_WIDE: bool = false;

// core/src/trace.rs: Walk::sides, of a node that a quad is the first of, or of what the leaf lists at depth 0
fn slabs_at(node: u32, depth: u32, slabs: Slabs, origin: vec3<f32>, line: Line) -> Slabs {
    if !IS_WIDE || depth == 0u {
        return slabs;
    }
    let lattice = quad(setup.lattices + (node - setup.bvh) / NODE_QUADS);
    return slabs_in_lattice(bitcast<vec4<f32>>(lattice), origin, line.inverse);
}

// core/src/trace.rs: Walk::leaf, which returns the number of blocks that it tested.
fn leaf(payload: u32, origin: vec3<f32>, line: Line, slope: vec3<f32>, nearest: ptr<function, Nearest>) -> u32 {
    let slabs = slabs_of(line.origin, line.inverse);
    // The node that the ray is in, those of its children that are met and still wait, and the same for the nodes above it.
    var node = setup.payloads + payload * NODE_QUADS;
    let all = vec2<f32>((*nearest).t_min, (*nearest).t);
    var part = all;
    var waiting = in_order(boxes_met(node, slabs, line.neg, part.x, part.y), line.neg);
    var path: array<vec2<u32>, MAX_DEPTH>;
    var depth = 0u;
    var blocks = 0u;
    if waiting == 0u {
        return blocks;
    }
    let shear = shear_of(origin, line.direction, slope);
    loop {
        if waiting == 0u {
            if depth == 0u {
                break;
            }
            depth -= 1u;
            if depth == 0u {
                part = all;
            }
            node = path[depth].x;
            waiting = path[depth].y;
            continue;
        }
        let slot = firstTrailingBit(waiting) ^ line.neg;
        waiting &= waiting - 1u;
        let child = word(((node + CHILDREN_QUAD) << 2u) + slot);
        if child == NONE {
            continue;
        }
        var met = part;
        if depth == 0u || is_hit(*nearest) {
            let own = slabs_at(node, depth, slabs, origin, line);
            met = clip_slot(node, slot, own, line.neg, part.x, min(part.y, (*nearest).t));
            // A nearer hit was found since the node was entered.
            if met.x > met.y {
                continue;
            }
        }
        if child > NUMBERS {
            test_block(child & NUMBERS, shear, nearest);
            blocks += 1u;
            continue;
        }
        if depth == 0u {
            part = met;
        }
        path[depth] = vec2<u32>(node, waiting);
        depth += 1u;
        node = setup.bvh + child * NODE_QUADS;
        let own = slabs_at(node, depth, slabs, origin, line);
        waiting = in_order(boxes_met(node, own, line.neg, part.x, min(part.y, (*nearest).t)), line.neg);
    }
    return blocks;
}

// core/src/trace.rs: Search and its Work. Boxes are not guarded, so that `blocks` is about the CPU's.
struct Search {
    nearest: Nearest,
    cells: u32,
    blocks: u32,
}

// Whether the walk ends at the first leaf that gives a hit, whichever that is.
override ANY_HIT: bool = false;

// core/src/trace.rs: Walk::walk_in, from the stop test on; false where the walk ends.
fn advance(line: Line, at: ptr<function, Crossing>, head: vec4<u32>, t: f32) -> bool {
    let rest = quad(setup.records + (*at).record * RECORD_QUADS + 1u);
    let exit = exit_of(line, (*at).cell);
    let is_done = mul(t, exit.speed) < sub(exit.distance, PADDING);
    if is_done || link_kind(head.x, exit.face) == LINK_NONE {
        return false;
    }
    *at = cross_face(line, (*at).cell, exit, head.x, neighbour(head, rest, exit.face));
    return true;
}

// core/src/trace.rs: Walk::walk_in. Both loops end: the Morton key of the cell's far corner grows.
fn walk(ray: CanonicalRay) -> Search {
    var nearest = Nearest(ray.t_min, ray.t_max, 0.0, 0.0, NONE);
    let line = line_of(ray);
    let span = span_of(line, ray);
    if !span.is_met {
        return Search(nearest, 0u, 0u);
    }
    let slope = slope_of(ray.direction);
    var at = locate(span.start, line);
    var head = quad(setup.records + at.record * RECORD_QUADS);
    var cells = 1u;
    var blocks = 0u;
    loop {
        while t_count(head.x) == 0u && advance(line, &at, head, min(nearest.t, span.end)) {
            head = quad(setup.records + at.record * RECORD_QUADS);
            cells += 1u;
        }
        if t_count(head.x) == 0u {
            break;
        }
        blocks += leaf(head.y, ray.origin, line, slope, &nearest);
        if (ANY_HIT && is_hit(nearest)) || !advance(line, &at, head, min(nearest.t, span.end)) {
            break;
        }
        head = quad(setup.records + at.record * RECORD_QUADS);
        cells += 1u;
    }
    return Search(nearest, cells, blocks);
}
