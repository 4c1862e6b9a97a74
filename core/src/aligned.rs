//! `AlignedBytes`: bytes that start where words may.

/// Bytes at a multiple of 64, for files that are included in a program: `include_bytes!` alone gives bytes at any
/// address, of which [`Octree::from_bytes`](crate::Octree::from_bytes) takes a quarter.
///
/// ```
/// use leafwalk_core::{AlignedBytes, Octree, Ray};
///
/// static FILE: &AlignedBytes<[u8]> =
///     &AlignedBytes { bytes: *include_bytes!("../../tests/format/version_2/levels.lwk") };
///
/// let octree = Octree::from_bytes(&FILE.bytes)?;
/// assert!(octree.closest_hit(&Ray::new([9.0; 3], [1.0, 0.0, 0.0])).is_none());
/// # Ok::<(), leafwalk_core::DecodeError>(())
/// ```
// 64 bytes are a line of most caches; words alone need 4. A field of any type is how regex-automata aligns its tables.
#[derive(Debug)]
#[repr(C, align(64))]
pub struct AlignedBytes<B: ?Sized> {
    /// An array where it is made, a slice where it is used.
    pub bytes: B,
}
