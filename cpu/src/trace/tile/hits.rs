//! `TileHits`: the nearest hit so far of each ray of a tile, a row a packet.

use leafwalk_core::lanes::Mask as _;
use leafwalk_core::{Nearest, unroll};

use super::range::Range;
use crate::lanes::Eight;
use crate::trace::packet::{PACKETS, Packet, Row, integers};

/// The nearest hit of each ray, packet by packet: all numbers of a ray are found from one address.
pub(crate) struct TileHits([PacketHits; PACKETS]);

/// [`Nearest`] of eight rays, in memory.
#[derive(Clone, Copy)]
struct PacketHits {
    t_min: Row,
    t: Row,
    u: Row,
    v: Row,
    primitive: [u32; 8],
}

impl TileHits {
    /// The nearest hits before any triangle was tested: none.
    #[inline(always)]
    pub(crate) fn new<L: Eight>(packets: &[Packet; PACKETS]) -> Self {
        let row = [0.0; 8];
        let mut hits = Self([PacketHits { t_min: row, t: row, u: row, v: row, primitive: [0; 8] }; PACKETS]);
        for (packet, rays) in packets.iter().enumerate() {
            hits.set_packet(packet, &rays.nearest::<L>());
        }
        hits
    }

    #[inline(always)]
    pub(crate) fn packet<L: Eight>(&self, packet: usize) -> Nearest<L> {
        let PacketHits { t_min, t, u, v, primitive } = &self.0[packet];
        Nearest {
            t_min: L::load(t_min),
            t: L::load(t),
            u: L::load(u),
            v: L::load(v),
            primitive: L::load(bytemuck::cast_ref(primitive)).bits(),
        }
    }

    #[inline(always)]
    pub(crate) fn set_packet<L: Eight>(&mut self, packet: usize, nearest: &Nearest<L>) {
        self.0[packet] = PacketHits {
            t_min: nearest.t_min.to_array(),
            t: nearest.t.to_array(),
            u: nearest.u.to_array(),
            v: nearest.v.to_array(),
            primitive: integers::<L>(nearest.primitive),
        };
    }

    #[inline(always)]
    pub(crate) fn ray(&self, packet: usize, lane: usize) -> Nearest {
        let PacketHits { t_min, t, u, v, primitive } = &self.0[packet];
        Nearest { t_min: t_min[lane], t: t[lane], u: u[lane], v: v[lane], primitive: primitive[lane] }
    }

    #[inline(always)]
    pub(crate) fn set_ray(&mut self, packet: usize, lane: usize, nearest: &Nearest) {
        let PacketHits { t, u, v, primitive, .. } = &mut self.0[packet];
        (t[lane], u[lane], v[lane], primitive[lane]) = (nearest.t, nearest.u, nearest.v, nearest.primitive);
    }

    /// The farthest t' that any ray still asks for.
    #[inline(always)]
    pub(crate) fn last<L: Eight>(&self) -> f32 {
        Range::of_rows(unroll!(packet in 0..8 => L::load(&self.0[packet].t))).whole().greatest
    }

    /// Packets with rays that still ask, a bit each.
    #[inline(always)]
    pub(crate) fn asking<L: Eight>(&self) -> u32 {
        let asks = unroll!(packet in 0..8 => L::splat(f32::NEG_INFINITY).less(L::load(&self.0[packet].t)).any());
        let mut packets = 0;
        for (packet, asks) in asks.into_iter().enumerate() {
            packets |= u32::from(asks) << packet;
        }
        packets
    }
}
