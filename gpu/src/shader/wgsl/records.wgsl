// The bit fields of a record, which describes a node of the octree.

// core/src/layout/record.rs: RecordHead::t_count
fn t_count(head: u32) -> u32 {
    return head & T_COUNT_MASK;
}

// core/src/layout/record.rs: RecordHead::level
fn level(head: u32) -> u32 {
    return (head >> LEVEL_SHIFT) & LEVEL_MASK;
}

// core/src/layout/record.rs: RecordHead::is_inner
fn is_inner(head: u32) -> bool {
    return (head & INNER) != 0u;
}

// core/src/step.rs: neighbour, of a record's two quads
fn neighbour(head: vec4<u32>, rest: vec4<u32>, face: u32) -> u32 {
    let low = select(head.w, head.z, face == 0u);
    let high = select(select(rest.w, rest.z, face == 4u), select(rest.y, rest.x, face == 2u), face < 4u);
    return select(high, low, face < 2u);
}
