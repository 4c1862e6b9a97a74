//! Eight lanes: what `core` asks of lanes, for SIMD registers, and the choice among them.
//!
//! The algorithms are written once over [`Eight`] and compiled for each register set; which one runs is decided when a
//! kernel is dispatched. All give the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

use leafwalk_core::lanes::Lanes;
pub(crate) use portable::Portable;

/// Eight `f32` in a register, and ways in and out of it.
pub(crate) trait Eight: Lanes {
    /// Whether [`Eight::prefetch`] does anything.
    const PREFETCHES: bool;
    /// One number a lane.
    fn load(values: &[f32; 8]) -> Self;
    /// In which order a ray looks at the slots of nodes.
    type Order: Copy + core::fmt::Debug;
    /// The lane of a slot is the slot, not its place in the ray's order.
    const IS_BY_SLOT: bool;
    /// Slot i comes at place i XOR `neg`, which is below 8.
    fn order(neg: u32) -> Self::Order;
    /// Lattice steps as numbers: those of slots, in the ray's order or not (see [`Eight::IS_BY_SLOT`]).
    fn from_steps(steps: &[u16; 8], order: Self::Order) -> Self;
    /// Lane i: what lane `lanes[i]` XOR `flip` holds, both below 8. It need not be a number.
    fn permute_lanes(self, lanes: &[u8; 8], flip: u32) -> Self;
    /// Row i, lane k: row k, lane i.
    fn transpose(rows: [Self; 8]) -> [Self; 8];
    /// The numbers, lane by lane.
    fn to_array(self) -> [f32; 8];
    /// Asks for the cache lines of an item that is used soon.
    fn prefetch<T>(item: &T);
}

/// Work that is compiled for each kind of lanes.
pub(crate) trait Kernel {
    /// What it gives.
    type Output;
    /// Must be inlined, or it loses the lanes' instructions.
    fn run<L: Eight>(self) -> Self::Output;
}

/// The registers that kernels run on.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Registers {
    /// The registers that the compiler may assume.
    Portable,
    /// AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Available),
}

impl Registers {
    /// The widest of this machine that we know.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(available) = avx2::Available::detect() {
            return Self::Avx2(available);
        }
        Self::Portable
    }

    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Portable => kernel.run::<Portable>(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(available) => available.run(kernel),
        }
    }
}
