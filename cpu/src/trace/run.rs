//! `Run`: packets in a row that go with each other, of which a tile may be made.

use super::packet::{PACKETS, Packet};

/// Uniform packets of one octant and one main axis, and the packet that ended their run.
pub(crate) struct Run {
    /// The run, and behind it, or at the end, the packet that did not join it.
    packets: [Packet; PACKETS + 1],
    len: usize,
    outsider: Outsider,
}

/// The packet that did not join a run, by its place.
#[derive(Clone, Copy)]
enum Outsider {
    /// The run is full, or the batch has ended.
    None,
    /// Its rays do not go with each other, so it goes alone.
    Mixed(usize),
    /// It starts the next run.
    Uniform(usize),
}

impl Run {
    #[inline(always)]
    pub(crate) const fn new() -> Self {
        Self { packets: [const { Packet::EMPTY }; PACKETS + 1], len: 0, outsider: Outsider::None }
    }

    /// Packets that go with each other.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Where the next packet is made.
    #[inline(always)]
    pub(crate) fn slot(&mut self) -> &mut Packet {
        &mut self.packets[self.len]
    }

    /// Looks at the packet in the slot: whether it joins the run, and the run goes on.
    #[inline(always)]
    pub(crate) fn goes_on(&mut self) -> bool {
        let packet = &self.packets[self.len];
        if !packet.is_uniform() {
            self.outsider = Outsider::Mixed(self.len);
            return false;
        }
        if self.len > 0 && !packet.goes_with(&self.packets[0]) {
            self.outsider = Outsider::Uniform(self.len);
            return false;
        }
        self.len += 1;
        self.len < PACKETS
    }

    /// As many packets as a tile has: the last one is repeated.
    #[inline(always)]
    pub(crate) fn fill_up(&mut self) -> &[Packet; PACKETS] {
        if self.len < PACKETS {
            self.repeat_last();
        }
        let (packets, _) = self.packets.split_first_chunk().expect("more packets than a tile has");
        packets
    }

    #[inline(never)]
    fn repeat_last(&mut self) {
        self.packets.swap(self.len, PACKETS);
        self.outsider = match self.outsider {
            Outsider::None => Outsider::None,
            Outsider::Mixed(_) => Outsider::Mixed(PACKETS),
            Outsider::Uniform(_) => Outsider::Uniform(PACKETS),
        };
        for at in self.len..PACKETS {
            self.packets[at] = self.packets[self.len - 1].clone();
        }
    }

    /// The place of the first ray in the batch; the run is not empty.
    #[inline(always)]
    pub(crate) fn first(&self) -> usize {
        self.packets[0].first as usize
    }

    /// The packets to be traced alone, one after the other: those of the run from `at` on, then a mixed one.
    #[inline(always)]
    pub(crate) fn alone(&mut self, at: usize) -> Option<&mut Packet> {
        match self.outsider {
            _ if at < self.len => Some(&mut self.packets[at]),
            Outsider::Mixed(outsider) if at == self.len => Some(&mut self.packets[outsider]),
            _ => None,
        }
    }

    /// Begins the next run.
    #[inline(always)]
    pub(crate) fn restart(&mut self) {
        self.len = 0;
        if let Outsider::Uniform(outsider) = self.outsider {
            self.packets.swap(0, outsider);
            self.len = 1;
        }
        self.outsider = Outsider::None;
    }
}
