//! `WordBindings`: how the words of an octree are spread over storage buffers, and the functions that read them there.

use core::fmt::Write;

use super::prelude::QUAD_BYTES;

/// Most storage buffers that an octree may take: WebGPU promises eight, and rays and answers take two.
pub const MOST_BINDINGS: u32 = 6;

/// How the words of an octree are spread over storage buffers of equal size, the last one shorter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordBindings {
    /// How many buffers there are.
    pub count: u32,
    /// Each holds 2 to this power quads of four words.
    pub shift: u32,
}

impl WordBindings {
    /// Spreads `bytes` over as few buffers as hold them, of each of which at most `binding_bytes` can be bound. A power of
    /// two of that is used, so that a shader finds a word's buffer by a shift.
    ///
    /// # Errors
    /// The most bytes that [`MOST_BINDINGS`] such buffers hold, when these are not enough.
    pub fn new(bytes: u64, binding_bytes: u64) -> Result<Self, u64> {
        let quads = binding_bytes / QUAD_BYTES as u64;
        // Quads are numbered in 32 bits.
        let shift = quads.checked_ilog2().unwrap_or(0).min(31);
        let each = (1u64 << shift) * QUAD_BYTES as u64;
        let count = bytes.div_ceil(each).max(1);
        if count > u64::from(MOST_BINDINGS) {
            return Err(each * u64::from(MOST_BINDINGS));
        }
        Ok(Self { count: count as u32, shift })
    }

    /// The bytes that each buffer but the last one holds.
    pub fn bytes(self) -> usize {
        QUAD_BYTES << self.shift
    }

    /// The declarations of the buffers, and the functions that read a quad of words or a word.
    pub(super) fn text(self) -> String {
        let mut text = String::from("// The octree's words, unchanged.\n");
        for k in 0..self.count {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "@group(0) @binding({}) var<storage, read> words_{k}: array<vec4<u32>>;", k + 1);
        }
        // A word is loaded alone: picked out of a quad in registers, it would cost four loads and a chain of selections.
        text + &self.reader("quad(at: u32) -> vec4<u32>", "at", "")
            + &self.reader("word(at: u32) -> u32", "at >> 2u", "[at & 3u]")
    }

    /// A function that reads the quad of the number `quad`, or the `part` of it.
    fn reader(self, signature: &str, quad: &str, part: &str) -> String {
        let mut text = format!("\nfn {signature} {{\n");
        if self.count == 1 {
            return text + &format!("    return words_0[{quad}]{part};\n}}\n");
        }
        let (shift, mask) = (self.shift, (1u32 << self.shift) - 1);
        let _ = writeln!(text, "    let quad = {quad};\n    let within = quad & {mask:#x}u;");
        let _ = writeln!(text, "    switch quad >> {shift}u {{");
        for k in 1..self.count {
            let _ = writeln!(text, "        case {k}u: {{ return words_{k}[within]{part}; }}");
        }
        text + &format!("        default: {{ return words_0[within]{part}; }}\n    }}\n}}\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    #[test]
    fn an_octree_takes_as_few_bindings_as_it_can() {
        let of = |bytes, limit| WordBindings::new(bytes, limit).map(|words| (words.count, words.bytes() as u64));
        assert_eq!(of(1, 128 * MIB), Ok((1, 128 * MIB)));
        assert_eq!(of(128 * MIB, 128 * MIB), Ok((1, 128 * MIB)));
        assert_eq!(of(128 * MIB + 64, 128 * MIB), Ok((2, 128 * MIB)));
        assert_eq!(of(768 * MIB, 128 * MIB), Ok((6, 128 * MIB)));
        // A power of two of each binding is used.
        assert_eq!(of(600 * MIB, 200 * MIB), Ok((5, 128 * MIB)));
        assert_eq!(of(7 * 1024, 1024 + 1000), Err(6 * 1024));
        assert_eq!(of(u64::MAX, u64::MAX), Err(6 << 35));
    }

    #[test]
    fn as_many_buffers_are_filled_as_are_declared() {
        for (bytes, limit) in [(64, 128), (4096, 1024), (4160, 1024), (6 * 1024, 1024)] {
            let words = WordBindings::new(bytes, limit).expect("six are enough");
            assert_eq!(vec![0u8; bytes as usize].chunks(words.bytes()).len(), words.count as usize);
            assert!(words.bytes() as u64 <= limit);
        }
    }

    #[test]
    fn an_octree_leaves_bindings_for_rays_and_answers() {
        assert!(MOST_BINDINGS + 2 <= wgpu::Limits::defaults().max_storage_buffers_per_shader_stage);
    }
}
