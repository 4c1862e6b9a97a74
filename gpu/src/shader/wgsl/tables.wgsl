// The tables of exits, for the self-test: the walk itself exits by slabs and reads no table.

// core/src/tables.rs: exit_face, three bits an entry
fn exit_face(neg: u32, index: u32) -> u32 {
    return (exit_face_row(neg) >> (3u * index)) & 7u;
}

// core/src/tables.rs: sub_face, two bits an entry
fn sub_face(face: u32, index: u32) -> u32 {
    return (sub_face_row(face) >> (2u * index)) & 3u;
}
