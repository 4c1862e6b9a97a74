//! The prelude of every shader: the constants and tables of `leafwalk-core`, printed as WGSL, so that no number stands in
//! two places.

use core::fmt::Write;
use core::mem::offset_of;

use leafwalk_core::contract;
use leafwalk_core::layout::{self, Block, BvhNode, Child, Record};
use leafwalk_core::{lanes, plane, step, tables, triangle};

/// Invocations of a workgroup: whole subgroups of most hardware, where they are 32 or 64 wide.
pub(crate) const WORKGROUP: u32 = 64;
/// Bytes of a `vec4<u32>`, the unit in which shaders read the octree.
pub(crate) const QUAD_BYTES: usize = 16;

/// Integers, as WGSL declares them.
const INTEGERS: [(&str, u32); 21] = [
    ("WORKGROUP", WORKGROUP),
    ("HEAD", lanes::HEAD),
    ("NONE", layout::NONE),
    ("MAX_LEVEL", layout::MAX_LEVEL),
    ("LATTICE", layout::LATTICE),
    ("T_COUNT_MASK", layout::T_COUNT_MASK),
    ("LEVEL_SHIFT", layout::LEVEL_SHIFT),
    ("LEVEL_MASK", layout::LEVEL_MASK),
    ("INNER", layout::INNER),
    ("LINK_SHIFT", layout::LINK_SHIFT),
    ("LINK_NONE", layout::LINK_NONE),
    ("LINK_COARSER", layout::LINK_COARSER),
    ("LINK_FINER", layout::LINK_FINER),
    ("RECORD_QUADS", quads(size_of::<Record>())),
    ("NODE_QUADS", quads(size_of::<BvhNode>())),
    ("CHILDREN_QUAD", quads(offset_of!(BvhNode, children))),
    ("MAX_DEPTH", layout::MAX_DEPTH as u32),
    ("NUMBERS", Child::NUMBERS),
    ("BLOCK_QUADS", quads(size_of::<Block>())),
    ("LANE_QUADS", quads(layout::BLOCK_WIDTH * size_of::<f32>())),
    ("PRIMITIVES_QUAD", quads(offset_of!(Block, primitives))),
];

/// Numbers, as WGSL declares them.
const NUMBERS: [(&str, f32); 14] = [
    ("PADDING", contract::PADDING),
    ("BOX_MARGIN", contract::BOX_MARGIN),
    ("START_MARGIN", contract::START_MARGIN),
    ("SMALLEST", contract::SMALLEST),
    ("SMALLEST_DIRECTION", contract::SMALLEST_DIRECTION),
    ("SMALLEST_SHEARED", contract::SMALLEST_SHEARED),
    ("CANDIDATE_SLACK", triangle::CANDIDATE_SLACK),
    ("CANCELLATION", plane::CANCELLATION),
    ("BEHIND", plane::BEHIND),
    ("PLANE_SLACK", plane::PLANE_SLACK),
    ("SMALLEST_WEIGHT", plane::SMALLEST_WEIGHT),
    ("SMALLEST_AREA", plane::SMALLEST_AREA),
    ("STEEP", step::STEEP),
    ("FAR_BEHIND", step::FAR_BEHIND),
];

// What the parts in `wgsl/` read out of a quad without a constant for its place.
const _: () = {
    assert!(offset_of!(Record, head) == 0 && offset_of!(Record, offset) == 4 && offset_of!(Record, neighbours) == 8);
    assert!(offset_of!(BvhNode, sides) == 0);
    assert!(offset_of!(Block, vertices) == 0);
};

/// The whole quads that so many bytes are.
const fn quads(bytes: usize) -> u32 {
    assert!(bytes.is_multiple_of(QUAD_BYTES));
    (bytes / QUAD_BYTES) as u32
}

/// The constants of the numeric contract and of the format.
pub(crate) fn constants() -> String {
    let mut text =
        String::from("// The constants of core/src/contract.rs, core/src/layout and the functions that use them.\n");
    for (name, value) in INTEGERS {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "const {name}: u32 = {value:#x}u;");
    }
    for (name, value) in NUMBERS {
        let _ = writeln!(text, "const {name}: f32 = {};", hex_float(value));
    }
    text
}

/// The tables of [`leafwalk_core::tables`], a row a word.
pub(crate) fn table_rows() -> String {
    let mut text = rows("exit_face_row", "EXIT_FACE", &tables::EXIT_FACE, 3);
    text.push('\n');
    text + &rows("sub_face_row", "SUB_FACE", &tables::SUB_FACE, 2)
}

/// A function from row number to row: arrays indexed at run time would be copied to memory.
fn rows(function: &str, table: &str, rows: &[[u8; 8]], bits: usize) -> String {
    let mut text = format!("// core/src/tables.rs: {table}, {bits} bits an entry\nfn {function}(row: u32) -> u32 {{\n");
    text += "    switch row {\n";
    for (number, row) in rows.iter().enumerate() {
        let packed = row.iter().rev().fold(0u32, |packed, entry| packed << bits | u32::from(*entry));
        let _ = writeln!(text, "        case {number}u: {{ return {packed:#x}u; }}");
    }
    text + "        default: { return 0u; }\n    }\n}\n"
}

/// A normal number as a hexadecimal literal of WGSL, without rounding.
fn hex_float(value: f32) -> String {
    const MANTISSA_BITS: u32 = f32::MANTISSA_DIGITS - 1;
    let bits = value.to_bits();
    let mantissa = bits & ((1 << MANTISSA_BITS) - 1) | 1 << MANTISSA_BITS;
    let zeros = mantissa.trailing_zeros();
    let exponent = (bits >> MANTISSA_BITS & 0xff) as i32 - 127 - MANTISSA_BITS as i32 + zeros as i32;
    let sign = if value < 0.0 { "-" } else { "" };
    format!("{sign}{:#x}p{exponent}f", mantissa >> zeros)
}

#[cfg(test)]
mod tests {
    use super::hex_float;

    #[test]
    fn hex_floats_are_exact() {
        for (value, text) in
            [(1.0, "0x1p0f"), (-0.375, "-0x3p-3f"), (1.1, "0x8ccccdp-23f"), (-(2f32.powi(56)), "-0x1p56f")]
        {
            assert_eq!(hex_float(value), text);
        }
    }
}
