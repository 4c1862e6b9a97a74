// From a leaf into the neighbour behind the face that the ray leaves it by. All places are seen from the root's corner.

// core/src/step.rs: Line. What follows from other members in an operation or two takes no registers: `forward` and
// `upward` are read off `neg`, `exit_origin` off `direction`.
struct Line {
    origin: vec3<f32>,
    direction: vec3<f32>,
    inverse: vec3<f32>,
    neg: u32,
}

// core/src/step.rs: Cell
struct Cell {
    corner: vec3<u32>,
    size: u32,
}

// core/src/step.rs: Exit
struct Exit {
    axis: u32,
    face: u32,
    distance: f32,
    speed: f32,
    t: f32,
}

const ONE_EACH: vec3<u32> = vec3<u32>(1u, 1u, 1u);
const AXES: vec3<u32> = vec3<u32>(0u, 1u, 2u);

// core/src/step.rs: Line::new
fn line_of(ray: CanonicalRay) -> Line {
    let down = select(vec3<u32>(0u), ONE_EACH, ray.direction < vec3<f32>(0.0));
    var line: Line;
    line.origin = sub3(ray.origin, setup.corner);
    line.direction = ray.direction;
    line.inverse = inverse(line.direction);
    line.neg = down.x | (down.y << 1u) | (down.z << 2u);
    return line;
}

// core/src/step.rs: inverse
fn inverse(direction: vec3<f32>) -> vec3<f32> {
    let is_still = direction == vec3<f32>(0.0);
    let d = select(direction, vec3<f32>(1.0), is_still);
    return select(vec3<f32>(divide(1.0, d.x), divide(1.0, d.y), divide(1.0, d.z)), vec3<f32>(STEEP), is_still);
}

// core/src/step.rs: Line::upward, 1 where the ray moves up
fn upward(line: Line) -> vec3<u32> {
    return ((vec3<u32>(line.neg) >> AXES) & ONE_EACH) ^ ONE_EACH;
}

// core/src/step.rs: Cell::exit_planes
fn exit_planes(line: Line, cell: Cell) -> vec3<f32> {
    return vec3<f32>(cell.corner + vec3<u32>(cell.size) * upward(line));
}

// core/src/step.rs: pick
fn pick(values: vec3<f32>, axis: u32) -> f32 {
    return select(select(values.z, values.y, axis == 1u), values.x, axis == 0u);
}

// core/src/step.rs: Slab::exit and Exit::new
fn exit_of(line: Line, cell: Cell) -> Exit {
    let planes = exit_planes(line, cell);
    let exit_origin = select(line.origin, vec3<f32>(FAR_BEHIND), line.direction == vec3<f32>(0.0));
    let t = mul3(sub3(planes, exit_origin), line.inverse);
    let is_x = t.x <= t.y && t.x <= t.z;
    let is_y = t.y <= t.z && !is_x;
    let axis = select(select(2u, 1u, is_y), 0u, is_x);
    let positive = ((line.neg >> axis) & 1u) ^ 1u;
    let away = pick(sub3(planes, line.origin), axis);
    var exit: Exit;
    exit.axis = axis;
    exit.face = (axis << 1u) | positive;
    exit.distance = select(-away, away, positive == 1u);
    exit.speed = abs(pick(line.direction, axis));
    exit.t = pick(t, axis);
    return exit;
}

// core/src/step.rs: Slab::upper_halves
fn upper_halves(line: Line, cell: Cell, exit: Exit) -> u32 {
    let centre = vec3<f32>(cell.corner + vec3<u32>(cell.size >> 1u));
    let point = add3(line.origin, mul3(vec3<f32>(exit.t), line.direction));
    // A tie goes to the half that lies ahead.
    let is_upper = (centre < point) | ((centre == point) & (upward(line) == ONE_EACH));
    let upper = select(vec3<u32>(0u), ONE_EACH, is_upper);
    return upper.x | (upper.y << 1u) | (upper.z << 2u);
}

// core/src/step.rs: link_kind
fn link_kind(head: u32, face: u32) -> u32 {
    return (head >> (LINK_SHIFT + 2u * face)) & 3u;
}

// core/src/step.rs: cross, what it returns
struct Crossing {
    record: u32,
    cell: Cell,
}

// core/src/step.rs: cross
fn cross_face(line: Line, cell: Cell, exit: Exit, head: u32, neighbour: u32) -> Crossing {
    let kind = link_kind(head, exit.face);
    let is_finer = kind == LINK_FINER;
    let size = (cell.size << u32(kind == LINK_COARSER)) >> u32(is_finer);
    // Up by the old cell's edge, or down by the new one's; lateral axes fall to the new cell's grid.
    let along = select(0u - size, cell.size, (exit.face & 1u) == 1u);
    let onward = select(vec3<u32>(0u), vec3<u32>(along), AXES == vec3<u32>(exit.axis));
    var corner = (cell.corner + onward) & vec3<u32>(~(size - 1u));
    var record = neighbour;
    if is_finer {
        let exit_bit = 1u << exit.axis;
        let quadrant = upper_halves(line, cell, exit) & ~exit_bit;
        record += quadrant | (line.neg & exit_bit);
        corner += vec3<u32>(size) * ((vec3<u32>(quadrant) >> AXES) & ONE_EACH);
    }
    return Crossing(record, Cell(corner, size));
}
