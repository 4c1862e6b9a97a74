//! How much fits: the structure into bindings, rays into dispatches. Pure arithmetic.

use core::ops::Range;

use crate::error::GpuError;
use crate::prelude::{QUAD_BYTES, WORKGROUP};

/// Bindings that the structure may take: WebGPU promises eight storage buffers, and rays and answers take two.
pub const MOST_BINDINGS: u32 = 6;
/// Rays a chunk: 32 MiB of them, so that copies overlap with tracing and nothing waits long.
pub(crate) const CHUNK_RAYS: usize = 1 << 20;
/// Rays a buffer that stays on the device: one dispatch of as many workgroups as WebGPU promises along an axis.
pub(crate) const BUFFER_RAYS: usize = 65535 * WORKGROUP as usize;

/// The structure's words over bindings of equal size, the last one shorter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// How many.
    pub bindings: u32,
    /// Each holds 2 to this power quads of four words.
    pub shift: u32,
}

impl Split {
    /// Of a structure of so many bytes over bindings of at most `binding_bytes`, of which a power of two is used.
    ///
    /// # Errors
    /// [`GpuError::StructureTooLarge`] when six bindings are not enough.
    pub fn new(bytes: u64, binding_bytes: u64) -> Result<Self, GpuError> {
        let quads = binding_bytes / QUAD_BYTES as u64;
        // Quads are numbered in 32 bits.
        let shift = quads.checked_ilog2().unwrap_or(0).min(31);
        let each = (1u64 << shift) * QUAD_BYTES as u64;
        let bindings = bytes.div_ceil(each).max(1);
        if bindings > u64::from(MOST_BINDINGS) {
            return Err(GpuError::StructureTooLarge { bytes, most: each * u64::from(MOST_BINDINGS) });
        }
        Ok(Self { bindings: bindings as u32, shift })
    }

    /// The bytes that each binding holds.
    pub fn ranges(self, bytes: usize) -> impl Iterator<Item = Range<usize>> {
        pieces(bytes, QUAD_BYTES << self.shift)
    }
}

/// `0..length` in pieces of `most`, the last one shorter; none of length 0.
///
/// # Panics
/// When `most` is 0.
pub fn pieces(length: usize, most: usize) -> impl Iterator<Item = Range<usize>> {
    (0..length).step_by(most).map(move |start| start..length.min(start.saturating_add(most)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    #[test]
    fn a_structure_takes_as_few_bindings_as_it_can() {
        let of = |bytes, limit| Split::new(bytes, limit).map(|split| (split.bindings, 16u64 << split.shift));
        assert_eq!(of(1, 128 * MIB), Ok((1, 128 * MIB)));
        assert_eq!(of(128 * MIB, 128 * MIB), Ok((1, 128 * MIB)));
        assert_eq!(of(128 * MIB + 64, 128 * MIB), Ok((2, 128 * MIB)));
        assert_eq!(of(768 * MIB, 128 * MIB), Ok((6, 128 * MIB)));
        // A power of two of each binding is used.
        assert_eq!(of(600 * MIB, 200 * MIB), Ok((5, 128 * MIB)));
        assert_eq!(of(7 * 1024, 1024 + 1000), Err(GpuError::StructureTooLarge { bytes: 7 * 1024, most: 6 * 1024 }));
        assert_eq!(of(u64::MAX, u64::MAX), Err(GpuError::StructureTooLarge { bytes: u64::MAX, most: 6 << 35 }));
    }

    #[test]
    fn bindings_cover_the_structure_once() {
        for (bytes, limit) in [(64, 128), (4096, 1024), (4160, 1024), (6 * 1024, 1024)] {
            let split = Split::new(bytes, limit).expect("six are enough");
            let ranges: Vec<_> = split.ranges(bytes as usize).collect();
            assert_eq!(ranges.len(), split.bindings as usize);
            assert!(ranges.iter().all(|range| !range.is_empty() && range.len() as u64 <= limit));
            assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert_eq!((ranges[0].start, ranges[ranges.len() - 1].end as u64), (0, bytes));
        }
    }

    #[test]
    fn pieces_are_whole_but_for_the_last() {
        let lengths = |length, most| pieces(length, most).map(|range| range.len()).collect::<Vec<_>>();
        assert_eq!(lengths(0, 5), []);
        assert_eq!(lengths(4, 5), [4]);
        assert_eq!(lengths(5, 5), [5]);
        assert_eq!(lengths(11, 5), [5, 5, 1]);
        assert_eq!(lengths(3, usize::MAX), [3]);
    }

    #[test]
    fn buffers_fit_into_bindings_and_dispatches() {
        let limits = wgpu::Limits::defaults();
        let ray = size_of::<crate::ray::DeviceRay>() as u64;
        assert!(BUFFER_RAYS as u64 * ray <= limits.max_storage_buffer_binding_size);
        const { assert!(CHUNK_RAYS <= BUFFER_RAYS) };
        assert!(BUFFER_RAYS / WORKGROUP as usize <= limits.max_compute_workgroups_per_dimension as usize);
        assert!(WORKGROUP <= limits.max_compute_invocations_per_workgroup);
        assert!(MOST_BINDINGS + 2 <= limits.max_storage_buffers_per_shader_stage);
    }
}
