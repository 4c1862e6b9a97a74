//! Reads bytes as numbers of all kinds. Where the bytes end, all further numbers are 0.

/// The bytes that are not read yet.
pub(super) struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    /// All of these bytes.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Whether all bytes are read.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The next byte.
    pub(super) fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    /// Four bytes as a word.
    pub(super) fn word(&mut self) -> u32 {
        u32::from_le_bytes(core::array::from_fn(|_| self.byte()))
    }

    /// Two bytes as an integer in 0..n.
    pub(super) fn below(&mut self, n: usize) -> usize {
        let number = u16::from_le_bytes([self.byte(), self.byte()]);
        usize::from(number) % n.max(1)
    }

    /// A coordinate where methods fail: on a coarse lattice or one ULP off it, small, huge, or any bits at all.
    pub(super) fn coordinate(&mut self) -> f32 {
        let kind = self.byte();
        let on_lattice = f32::from(self.byte()) / 64.0 - 2.0;
        match kind % 8 {
            0..=3 => on_lattice,
            4 => on_lattice.next_up(),
            5 => on_lattice.next_down(),
            6 => on_lattice * 2f32.powi(i32::from(self.byte()) - 128),
            _ => f32::from_bits(self.word()),
        }
    }

    /// Three coordinates.
    pub(super) fn point(&mut self) -> [f32; 3] {
        core::array::from_fn(|_| self.coordinate())
    }
}
