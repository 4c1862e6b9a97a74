//! Embree 3.13, on one thread, through a binding to the few functions that this takes.

use core::ffi::{c_int, c_uint};
use core::ptr;
use core::time::Duration;
use std::rc::Rc;

use leafwalk::{Mesh, Ray};

use super::{Answer, Prepared, Rival};

mod binding;
mod packet;
mod scene;

use binding::{
    Align16, Align32, Align64, COHERENT, COMPACT, Context, INCOHERENT, INVALID, NATIVE_RAY16, NO_FLAGS, ROBUST,
    RayHits, Rays, VERSION, rtcIntersect1M, rtcOccluded1M,
};
use packet::Packet;
use scene::{Device, Scene};

/// What a scene may be built under: as names say it, and Embree's flags.
type Setting = (&'static str, c_int);

/// By default, ROBUST and COMPACT.
pub const SETTINGS: [Setting; 3] = [("", NO_FLAGS), ("ROBUST ", ROBUST), ("COMPACT ", COMPACT)];

/// All ways to call Embree on this machine, under each of some settings.
pub fn all(mesh: &Mesh, settings: &[Setting]) -> Vec<Box<dyn Rival>> {
    let mut ways = vec![
        ("single", Calls::Single, INCOHERENT),
        ("stream", Calls::Stream, INCOHERENT),
        ("stream coherent", Calls::Stream, COHERENT),
        ("8", Calls::Eight, INCOHERENT),
        ("8 coherent", Calls::Eight, COHERENT),
    ];
    let mut rivals: Vec<Box<dyn Rival>> = Vec::new();
    for &(setting, scene_flags) in settings {
        let scene = Rc::new(Scene::new(mesh, scene_flags).0);
        if rivals.is_empty() && scene.device.property(NATIVE_RAY16) == 1 {
            ways.push(("16 coherent", Calls::Sixteen, COHERENT));
        }
        for &(way, calls, flags) in &ways {
            let name = format!("embree {setting}{way}");
            rivals.push(Box::new(Embree { name, scene: Rc::clone(&scene), scene_flags, calls, flags }));
        }
    }
    rivals
}

/// The version of the library that is linked, such as 31305.
pub fn version() -> isize {
    Device::new().property(VERSION)
}

struct Packets<'a, P> {
    scene: &'a Scene,
    flags: c_int,
    rays: &'a [Ray],
    packets: Vec<P>,
}

impl<P> Packets<'_, P> {
    fn context(&self) -> Context {
        Context { flags: self.flags, filter: ptr::null(), instance: INVALID }
    }
}

impl<P: Packet> Prepared<P::Answer> for Packets<'_, P> {
    fn reset(&mut self) {
        for (packet, rays) in self.packets.iter_mut().zip(self.rays.chunks(P::WIDTH)) {
            *packet = P::new(rays);
        }
    }
    fn trace(&mut self) {
        let mut context = self.context();
        let (full, rest) = self.packets.split_at_mut(self.rays.len() / P::WIDTH);
        for (packets, valid) in [(full, P::valid(P::WIDTH)), (rest, P::valid(self.rays.len() % P::WIDTH))] {
            for packet in packets {
                // SAFETY: Scenes are committed when they are made.
                unsafe { packet.trace(&valid, self.scene.handle, &mut context) }
            }
        }
    }
    fn answers(&self) -> Vec<P::Answer> {
        let lanes = self.packets.iter().flat_map(|packet| (0..P::WIDTH).map(|lane| packet.answer(lane)));
        lanes.take(self.rays.len()).collect()
    }
}

/// Packets of one ray that are passed all at once.
struct Stream<'a, P>(Box<Packets<'a, P>>);

/// Implements [`Prepared`] by one of Embree's functions.
macro_rules! stream {
    ($form:ident, $answer:ty, $call:ident) => {
        impl Prepared<$answer> for Stream<'_, $form<Align16, 1>> {
            fn reset(&mut self) {
                self.0.reset();
            }
            fn trace(&mut self) {
                let mut context = self.0.context();
                let count = self.0.packets.len() as c_uint;
                let (rays, stride) = (self.0.packets.as_mut_ptr(), size_of::<$form<Align16, 1>>());
                // SAFETY: Scenes are committed when they are made; there are as many rays as are said.
                unsafe { $call(self.0.scene.handle, &mut context, rays, count, stride) }
            }
            fn answers(&self) -> Vec<$answer> {
                self.0.answers()
            }
        }
    };
}

stream!(RayHits, Answer, rtcIntersect1M);
stream!(Rays, bool, rtcOccluded1M);

/// How many rays a call takes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Calls {
    Single,
    /// The whole batch, single rays behind each other; Embree 4 has no such calls any more.
    Stream,
    Eight,
    Sixteen,
}

struct Embree {
    name: String,
    scene: Rc<Scene>,
    scene_flags: c_int,
    calls: Calls,
    flags: c_int,
}

impl Embree {
    fn packets<'a, P: Packet>(&'a self, rays: &'a [Ray]) -> Box<Packets<'a, P>> {
        let packets = rays.chunks(P::WIDTH).map(P::new).collect();
        Box::new(Packets { scene: &self.scene, flags: self.flags, rays, packets })
    }
}

impl Rival for Embree {
    fn name(&self) -> &str {
        &self.name
    }
    fn bytes(&self) -> Option<usize> {
        Some(self.scene.bytes)
    }
    fn rebuild(&self, mesh: &Mesh) -> Option<Duration> {
        (self.calls == Calls::Single).then(|| Scene::new(mesh, self.scene_flags).1)
    }
    fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a> {
        match self.calls {
            Calls::Single => self.packets::<RayHits<Align16, 1>>(rays),
            Calls::Stream => Box::new(Stream(self.packets::<RayHits<Align16, 1>>(rays))),
            Calls::Eight => self.packets::<RayHits<Align32, 8>>(rays),
            Calls::Sixteen => self.packets::<RayHits<Align64, 16>>(rays),
        }
    }
    fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a> {
        match self.calls {
            Calls::Single => self.packets::<Rays<Align16, 1>>(rays),
            Calls::Stream => Box::new(Stream(self.packets::<Rays<Align16, 1>>(rays))),
            Calls::Eight => self.packets::<Rays<Align32, 8>>(rays),
            Calls::Sixteen => self.packets::<Rays<Align64, 16>>(rays),
        }
    }
}
