//! Embree 3.13, one thread, through a binding to the few functions that this takes.

use core::alloc::Layout;
use core::ffi::{CStr, c_char, c_int, c_uint, c_void};
use core::ptr::{self, NonNull};
use core::sync::atomic::{AtomicIsize, Ordering::Relaxed};
use core::time::Duration;
use std::rc::Rc;

use leafwalk::{Mesh, Ray};

use crate::{Answer, Family, Prepared, Rival, timed};

/// One ray a call.
pub const SINGLE: &str = "embree single";

/// All ways to call Embree on this machine, by default and ROBUST.
pub fn all(mesh: &Mesh) -> Vec<Box<dyn Rival>> {
    let mut ways = vec![
        ([SINGLE, "embree ROBUST single"], 1, INCOHERENT),
        (["embree 8", "embree ROBUST 8"], 8, INCOHERENT),
        (["embree 8 coherent", "embree ROBUST 8 coherent"], 8, COHERENT),
    ];
    let scenes = [false, true].map(|robust| Rc::new(Scene::new(mesh, robust).0));
    if scenes[0].device.property(NATIVE_RAY16) == 1 {
        ways.push((["embree 16 coherent", "embree ROBUST 16 coherent"], 16, COHERENT));
    }
    let rival = |i: usize, (names, width, flags): ([&'static str; 2], usize, c_int)| -> Box<dyn Rival> {
        Box::new(Embree { name: names[i], scene: Rc::clone(&scenes[i]), width, flags })
    };
    (0..2).flat_map(|i| ways.iter().map(move |way| (i, *way))).map(|(i, way)| rival(i, way)).collect()
}

/// The version of the library that is linked, such as 31305.
pub fn version() -> isize {
    Device::new().property(VERSION)
}

// As in rtcore_*.h of Embree 3.
const VERSION: c_int = 0;
const NATIVE_RAY16: c_int = 34;
const TRIANGLE_GEOMETRY: c_int = 0;
const INDEX_BUFFER: c_int = 0;
const VERTEX_BUFFER: c_int = 1;
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;
const MEDIUM_QUALITY: c_int = 1;
const NO_FLAGS: c_int = 0;
const ROBUST: c_int = 1 << 2;
const INCOHERENT: c_int = 0;
const COHERENT: c_int = 1;
const INVALID: u32 = u32::MAX;

type Handle = *mut c_void;
type Monitor = extern "C" fn(*mut c_void, isize, bool) -> bool;

#[link(name = "embree3")]
unsafe extern "C" {
    fn rtcNewDevice(config: *const c_char) -> Handle;
    fn rtcReleaseDevice(device: Handle);
    fn rtcGetDeviceProperty(device: Handle, property: c_int) -> isize;
    fn rtcGetDeviceError(device: Handle) -> c_int;
    fn rtcSetDeviceMemoryMonitorFunction(device: Handle, monitor: Option<Monitor>, user: *mut c_void);
    fn rtcNewGeometry(device: Handle, kind: c_int) -> Handle;
    fn rtcReleaseGeometry(geometry: Handle);
    fn rtcCommitGeometry(geometry: Handle);
    fn rtcSetNewGeometryBuffer(
        geometry: Handle,
        kind: c_int,
        slot: c_uint,
        format: c_int,
        stride: usize,
        count: usize,
    ) -> *mut c_void;
    fn rtcNewScene(device: Handle) -> Handle;
    fn rtcReleaseScene(scene: Handle);
    fn rtcAttachGeometry(scene: Handle, geometry: Handle) -> c_uint;
    fn rtcSetSceneFlags(scene: Handle, flags: c_int);
    fn rtcSetSceneBuildQuality(scene: Handle, quality: c_int);
    fn rtcCommitScene(scene: Handle);
    fn rtcIntersect1(scene: Handle, context: *mut Context, ray: *mut RayHits<Align16, 1>);
    fn rtcOccluded1(scene: Handle, context: *mut Context, ray: *mut Rays<Align16, 1>);
    fn rtcIntersect8(valid: *const c_int, scene: Handle, context: *mut Context, rays: *mut RayHits<Align32, 8>);
    fn rtcOccluded8(valid: *const c_int, scene: Handle, context: *mut Context, rays: *mut Rays<Align32, 8>);
    fn rtcIntersect16(valid: *const c_int, scene: Handle, context: *mut Context, rays: *mut RayHits<Align64, 16>);
    fn rtcOccluded16(valid: *const c_int, scene: Handle, context: *mut Context, rays: *mut Rays<Align64, 16>);
}

/// `RTCIntersectContext`.
#[repr(C)]
struct Context {
    flags: c_int,
    filter: *const c_void,
    instance: c_uint,
}

#[repr(C, align(16))]
struct Align16([u8; 16]);
#[repr(C, align(32))]
struct Align32([u8; 32]);
#[repr(C, align(64))]
struct Align64([u8; 64]);

/// `RTCRay`, `RTCRay8`, `RTCRay16`: N rays, aligned as `A`.
#[repr(C)]
struct Rays<A, const N: usize> {
    align: [A; 0],
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    /// Becomes the distance of the hit, or -infinity where occluded.
    t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
}

/// `RTCRayHit`, `RTCRayHit8`, `RTCRayHit16`.
#[repr(C)]
struct RayHits<A, const N: usize> {
    rays: Rays<A, N>,
    normal: [[f32; N]; 3],
    u: [f32; N],
    v: [f32; N],
    primitive: [u32; N],
    geometry: [u32; N],
    instance: [u32; N],
}

const _: () = {
    let single = (Layout::new::<Rays<Align16, 1>>(), Layout::new::<RayHits<Align16, 1>>());
    assert!(single.0.size() == 48 && single.1.size() == 80 && single.1.align() == 16);
    let eight = (Layout::new::<Rays<Align32, 8>>(), Layout::new::<RayHits<Align32, 8>>());
    assert!(eight.0.size() == 8 * 48 && eight.1.size() == 8 * 80 && eight.1.align() == 32);
    let sixteen = (Layout::new::<Rays<Align64, 16>>(), Layout::new::<RayHits<Align64, 16>>());
    assert!(sixteen.0.size() == 16 * 48 && sixteen.1.size() == 16 * 80 && sixteen.1.align() == 64);
};

impl<A, const N: usize> Rays<A, N> {
    /// Up to N rays; the mask of the call switches the lanes off that are left over.
    fn new(rays: &[Ray]) -> Self {
        let lane = |i: usize| rays[i.min(rays.len() - 1)];
        let lanes = |value: &dyn Fn(Ray) -> f32| core::array::from_fn(|i| value(lane(i)));
        Self {
            align: [],
            origin: core::array::from_fn(|k| lanes(&|ray| ray.origin[k])),
            t_near: lanes(&|ray| ray.t_min),
            direction: core::array::from_fn(|k| lanes(&|ray| ray.direction[k])),
            time: [0.0; N],
            t_far: lanes(&|ray| ray.t_max),
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
        }
    }

    fn answer(&self, lane: usize) -> bool {
        self.t_far[lane] == f32::NEG_INFINITY
    }
}

impl<A, const N: usize> RayHits<A, N> {
    fn new(rays: &[Ray]) -> Self {
        Self {
            rays: Rays::new(rays),
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [INVALID; N],
        }
    }

    fn answer(&self, lane: usize) -> Answer {
        match self.geometry[lane] {
            INVALID => Answer::MISS,
            _ => Answer { t: self.rays.t_far[lane], primitive: self.primitive[lane] },
        }
    }
}

struct Device {
    handle: Handle,
    /// Bytes that Embree holds, kept by [`count`].
    bytes: Box<AtomicIsize>,
}

extern "C" fn count(user: *mut c_void, bytes: isize, _: bool) -> bool {
    // SAFETY: `user` is the counter of a device, which outlives the device.
    unsafe { &*user.cast::<AtomicIsize>() }.fetch_add(bytes, Relaxed);
    true
}

impl Device {
    fn new() -> Self {
        const CONFIG: &CStr = c"threads=1";
        let bytes = Box::new(AtomicIsize::new(0));
        // SAFETY: The configuration is a C string; the counter is only shared, and lives as long as the device.
        unsafe {
            let handle = rtcNewDevice(CONFIG.as_ptr());
            assert!(!handle.is_null(), "Embree opens no device: error {}", rtcGetDeviceError(ptr::null_mut()));
            rtcSetDeviceMemoryMonitorFunction(handle, Some(count), ptr::from_ref(&*bytes).cast_mut().cast());
            Self { handle, bytes }
        }
    }

    fn property(&self, property: c_int) -> isize {
        // SAFETY: The device is open.
        unsafe { rtcGetDeviceProperty(self.handle, property) }
    }

    fn check(&self) {
        // SAFETY: The device is open.
        let error = unsafe { rtcGetDeviceError(self.handle) };
        assert_eq!(error, 0, "an error of Embree, numbered as in rtcore_device.h");
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: It is open, and nobody else holds it.
        unsafe { rtcReleaseDevice(self.handle) }
    }
}

struct Scene {
    handle: Handle,
    device: Device,
    bytes: usize,
}

impl Scene {
    /// Builds it at medium quality; with the time that it took to commit.
    fn new(mesh: &Mesh, robust: bool) -> (Self, Duration) {
        let device = Device::new();
        // SAFETY: The device is open, and each handle is passed on as what it is.
        let handle = unsafe {
            let geometry = rtcNewGeometry(device.handle, TRIANGLE_GEOMETRY);
            fill(geometry, VERTEX_BUFFER, FLOAT3, &mesh.positions);
            fill(geometry, INDEX_BUFFER, UINT3, &mesh.triangles);
            rtcCommitGeometry(geometry);
            let scene = rtcNewScene(device.handle);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcSetSceneFlags(scene, if robust { ROBUST } else { NO_FLAGS });
            rtcSetSceneBuildQuality(scene, MEDIUM_QUALITY);
            scene
        };
        device.check();
        let before = device.bytes.load(Relaxed);
        // SAFETY: The scene was made above.
        let ((), time) = timed(|| unsafe { rtcCommitScene(handle) });
        device.check();
        let bytes = device.bytes.load(Relaxed) - before;
        (Self { handle, device, bytes: bytes.unsigned_abs() }, time)
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: It was made by `new`, and nobody else holds it.
        unsafe { rtcReleaseScene(self.handle) }
    }
}

/// Copies values into a new buffer of a geometry.
///
/// # Safety
/// The geometry is one, and the format that of three numbers of 32 bits.
unsafe fn fill<T: Copy>(geometry: Handle, kind: c_int, format: c_int, values: &[[T; 3]]) {
    let stride = size_of::<[T; 3]>();
    // SAFETY: The caller answers for the geometry; the buffer has room for as many values as it was made for.
    unsafe {
        let buffer = rtcSetNewGeometryBuffer(geometry, kind, 0, format, stride, values.len());
        let buffer = NonNull::new(buffer).expect("a buffer").cast::<[T; 3]>();
        ptr::copy_nonoverlapping(values.as_ptr(), buffer.as_ptr(), values.len());
    }
}

/// Which lanes of a packet are on: -1, else 0.
#[repr(C, align(64))]
struct Valid<const N: usize>([c_int; N]);

/// As many rays as one call takes.
trait Packet {
    type Valid;
    type Answer;
    const WIDTH: usize;

    fn new(rays: &[Ray]) -> Self;
    fn valid(rays: usize) -> Self::Valid;
    /// # Safety
    /// The scene is one that was committed.
    unsafe fn trace(&mut self, valid: &Self::Valid, scene: Handle, context: &mut Context);
    fn answer(&self, lane: usize) -> Self::Answer;
}

/// Implements [`Packet`] by one of Embree's functions.
macro_rules! packet {
    ($form:ident, $align:ty, $width:literal, $answer:ty, $call:ident $(, $valid:ident)?) => {
        impl Packet for $form<$align, $width> {
            type Valid = Valid<$width>;
            type Answer = $answer;
            const WIDTH: usize = $width;

            fn new(rays: &[Ray]) -> Self {
                Self::new(rays)
            }
            fn valid(rays: usize) -> Valid<$width> {
                Valid(core::array::from_fn(|lane| if lane < rays { -1 } else { 0 }))
            }
            #[inline(always)]
            unsafe fn trace(&mut self, _valid: &Valid<$width>, scene: Handle, context: &mut Context) {
                // SAFETY: The caller answers for the scene; everything else is borrowed, of the type that is declared,
                // and has its alignment.
                unsafe { $call($(_valid.0.$valid(),)? scene, context, self) }
            }
            fn answer(&self, lane: usize) -> $answer {
                self.answer(lane)
            }
        }
    };
}

packet!(RayHits, Align16, 1, Answer, rtcIntersect1);
packet!(RayHits, Align32, 8, Answer, rtcIntersect8, as_ptr);
packet!(RayHits, Align64, 16, Answer, rtcIntersect16, as_ptr);
packet!(Rays, Align16, 1, bool, rtcOccluded1);
packet!(Rays, Align32, 8, bool, rtcOccluded8, as_ptr);
packet!(Rays, Align64, 16, bool, rtcOccluded16, as_ptr);

struct Packets<'a, P> {
    scene: &'a Scene,
    flags: c_int,
    rays: &'a [Ray],
    packets: Vec<P>,
}

impl<P: Packet> Prepared<P::Answer> for Packets<'_, P> {
    fn reset(&mut self) {
        for (packet, rays) in self.packets.iter_mut().zip(self.rays.chunks(P::WIDTH)) {
            *packet = P::new(rays);
        }
    }
    fn trace(&mut self) {
        let mut context = Context { flags: self.flags, filter: ptr::null(), instance: INVALID };
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

struct Embree {
    name: &'static str,
    scene: Rc<Scene>,
    width: usize,
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
        self.name
    }
    fn family(&self) -> Family {
        if self.name.contains("ROBUST") { Family::EmbreeRobust } else { Family::Embree }
    }
    fn bytes(&self) -> Option<usize> {
        Some(self.scene.bytes)
    }
    fn rebuild(&self, mesh: &Mesh) -> Option<Duration> {
        let robust = self.family() == Family::EmbreeRobust;
        (self.width == 1).then(|| Scene::new(mesh, robust).1)
    }
    fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a> {
        match self.width {
            1 => self.packets::<RayHits<Align16, 1>>(rays),
            8 => self.packets::<RayHits<Align32, 8>>(rays),
            _ => self.packets::<RayHits<Align64, 16>>(rays),
        }
    }
    fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a> {
        match self.width {
            1 => self.packets::<Rays<Align16, 1>>(rays),
            8 => self.packets::<Rays<Align32, 8>>(rays),
            _ => self.packets::<Rays<Align64, 16>>(rays),
        }
    }
}
