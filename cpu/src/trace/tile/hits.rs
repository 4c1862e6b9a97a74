//! `TileHits`: the nearest hit so far of each ray of a tile, a row a packet.

use leafwalk_core::lanes::Mask as _;
use leafwalk_core::{Nearest, unroll};

use super::range::Range;
use crate::lanes::Eight;
use crate::trace::packet::{PACKETS, Packet, integers};

/// A number for each ray.
type Rows<T> = [[T; 8]; PACKETS];

/// The nearest hit of each ray: [`Nearest`], in memory.
pub(crate) struct TileHits {
    t_min: Rows<f32>,
    t: Rows<f32>,
    u: Rows<f32>,
    v: Rows<f32>,
    primitive: Rows<u32>,
}

impl TileHits {
    /// The nearest hits before any triangle was tested: none.
    #[inline(always)]
    pub(crate) fn new<L: Eight>(packets: &[Packet; PACKETS]) -> Self {
        let rows = [[0.0; 8]; PACKETS];
        let mut hits = Self { t_min: rows, t: rows, u: rows, v: rows, primitive: [[0; 8]; PACKETS] };
        for (packet, rays) in packets.iter().enumerate() {
            hits.set_packet(packet, &rays.nearest::<L>());
        }
        hits
    }

    #[inline(always)]
    pub(crate) fn packet<L: Eight>(&self, packet: usize) -> Nearest<L> {
        Nearest {
            t_min: L::load(&self.t_min[packet]),
            t: L::load(&self.t[packet]),
            u: L::load(&self.u[packet]),
            v: L::load(&self.v[packet]),
            primitive: L::load(bytemuck::cast_ref(&self.primitive[packet])).bits(),
        }
    }

    #[inline(always)]
    pub(crate) fn set_packet<L: Eight>(&mut self, packet: usize, nearest: &Nearest<L>) {
        self.t_min[packet] = nearest.t_min.to_array();
        self.t[packet] = nearest.t.to_array();
        self.u[packet] = nearest.u.to_array();
        self.v[packet] = nearest.v.to_array();
        self.primitive[packet] = integers::<L>(nearest.primitive);
    }

    #[inline(always)]
    pub(crate) fn ray(&self, packet: usize, lane: usize) -> Nearest {
        Nearest {
            t_min: self.t_min[packet][lane],
            t: self.t[packet][lane],
            u: self.u[packet][lane],
            v: self.v[packet][lane],
            primitive: self.primitive[packet][lane],
        }
    }

    #[inline(always)]
    pub(crate) fn set_ray(&mut self, packet: usize, lane: usize, nearest: &Nearest) {
        self.t[packet][lane] = nearest.t;
        self.u[packet][lane] = nearest.u;
        self.v[packet][lane] = nearest.v;
        self.primitive[packet][lane] = nearest.primitive;
    }

    /// The farthest t' that any ray still asks for.
    #[inline(always)]
    pub(crate) fn last<L: Eight>(&self) -> f32 {
        Range::of_rows(unroll!(packet in 0..8 => L::load(&self.t[packet]))).whole().greatest
    }

    /// Packets with rays that still ask, a bit each.
    #[inline(always)]
    pub(crate) fn asking<L: Eight>(&self) -> u32 {
        let asks = unroll!(packet in 0..8 => L::splat(f32::NEG_INFINITY).less(L::load(&self.t[packet])).any());
        let mut packets = 0;
        for (packet, asks) in asks.into_iter().enumerate() {
            packets |= u32::from(asks) << packet;
        }
        packets
    }
}
