//! What we call of Embree's interface: functions, and structures as C lays them out.

use core::alloc::Layout;
use core::ffi::{c_char, c_int, c_uint, c_void};

// As in rtcore_*.h of Embree 3.
pub(super) const VERSION: c_int = 0;
pub(super) const NATIVE_RAY16: c_int = 34;
pub(super) const TRIANGLE_GEOMETRY: c_int = 0;
pub(super) const INDEX_BUFFER: c_int = 0;
pub(super) const VERTEX_BUFFER: c_int = 1;
pub(super) const UINT3: c_int = 0x5003;
pub(super) const FLOAT3: c_int = 0x9003;
pub(super) const MEDIUM_QUALITY: c_int = 1;
pub(super) const NO_FLAGS: c_int = 0;
pub(super) const COMPACT: c_int = 1 << 1;
pub(super) const ROBUST: c_int = 1 << 2;
pub(super) const INCOHERENT: c_int = 0;
pub(super) const COHERENT: c_int = 1;
pub(super) const INVALID: u32 = u32::MAX;

pub(super) type Handle = *mut c_void;
pub(super) type Monitor = extern "C" fn(*mut c_void, isize, bool) -> bool;

#[link(name = "embree3")]
unsafe extern "C" {
    pub(super) fn rtcNewDevice(config: *const c_char) -> Handle;
    pub(super) fn rtcReleaseDevice(device: Handle);
    pub(super) fn rtcGetDeviceProperty(device: Handle, property: c_int) -> isize;
    pub(super) fn rtcGetDeviceError(device: Handle) -> c_int;
    pub(super) fn rtcSetDeviceMemoryMonitorFunction(device: Handle, monitor: Option<Monitor>, user: *mut c_void);
    pub(super) fn rtcNewGeometry(device: Handle, kind: c_int) -> Handle;
    pub(super) fn rtcReleaseGeometry(geometry: Handle);
    pub(super) fn rtcCommitGeometry(geometry: Handle);
    pub(super) fn rtcSetNewGeometryBuffer(
        geometry: Handle,
        kind: c_int,
        slot: c_uint,
        format: c_int,
        stride: usize,
        count: usize,
    ) -> *mut c_void;
    pub(super) fn rtcNewScene(device: Handle) -> Handle;
    pub(super) fn rtcReleaseScene(scene: Handle);
    pub(super) fn rtcAttachGeometry(scene: Handle, geometry: Handle) -> c_uint;
    pub(super) fn rtcSetSceneFlags(scene: Handle, flags: c_int);
    pub(super) fn rtcSetSceneBuildQuality(scene: Handle, quality: c_int);
    pub(super) fn rtcCommitScene(scene: Handle);
    pub(super) fn rtcIntersect1(scene: Handle, context: *mut Context, ray: *mut RayHits<Align16, 1>);
    pub(super) fn rtcIntersect1M(
        scene: Handle,
        context: *mut Context,
        rays: *mut RayHits<Align16, 1>,
        count: c_uint,
        stride: usize,
    );
    pub(super) fn rtcOccluded1M(
        scene: Handle,
        context: *mut Context,
        rays: *mut Rays<Align16, 1>,
        count: c_uint,
        stride: usize,
    );
    pub(super) fn rtcOccluded1(scene: Handle, context: *mut Context, ray: *mut Rays<Align16, 1>);
    pub(super) fn rtcIntersect8(
        valid: *const c_int,
        scene: Handle,
        context: *mut Context,
        rays: *mut RayHits<Align32, 8>,
    );
    pub(super) fn rtcOccluded8(valid: *const c_int, scene: Handle, context: *mut Context, rays: *mut Rays<Align32, 8>);
    pub(super) fn rtcIntersect16(
        valid: *const c_int,
        scene: Handle,
        context: *mut Context,
        rays: *mut RayHits<Align64, 16>,
    );
    pub(super) fn rtcOccluded16(
        valid: *const c_int,
        scene: Handle,
        context: *mut Context,
        rays: *mut Rays<Align64, 16>,
    );
}

/// `RTCIntersectContext`.
#[repr(C)]
pub(super) struct Context {
    pub(super) flags: c_int,
    pub(super) filter: *const c_void,
    pub(super) instance: c_uint,
}

#[repr(C, align(16))]
pub(super) struct Align16([u8; 16]);
#[repr(C, align(32))]
pub(super) struct Align32([u8; 32]);
#[repr(C, align(64))]
pub(super) struct Align64([u8; 64]);

/// `RTCRay`, `RTCRay8`, `RTCRay16`: N rays, aligned as `A`.
#[repr(C)]
pub(super) struct Rays<A, const N: usize> {
    pub(super) align: [A; 0],
    pub(super) origin: [[f32; N]; 3],
    pub(super) t_near: [f32; N],
    pub(super) direction: [[f32; N]; 3],
    pub(super) time: [f32; N],
    /// Becomes the distance of the hit, or -infinity where occluded.
    pub(super) t_far: [f32; N],
    pub(super) mask: [u32; N],
    pub(super) id: [u32; N],
    pub(super) flags: [u32; N],
}

/// `RTCRayHit`, `RTCRayHit8`, `RTCRayHit16`.
#[repr(C)]
pub(super) struct RayHits<A, const N: usize> {
    pub(super) rays: Rays<A, N>,
    pub(super) normal: [[f32; N]; 3],
    pub(super) u: [f32; N],
    pub(super) v: [f32; N],
    pub(super) primitive: [u32; N],
    pub(super) geometry: [u32; N],
    pub(super) instance: [u32; N],
}

const _: () = {
    let single = (Layout::new::<Rays<Align16, 1>>(), Layout::new::<RayHits<Align16, 1>>());
    assert!(single.0.size() == 48 && single.1.size() == 80 && single.1.align() == 16);
    let eight = (Layout::new::<Rays<Align32, 8>>(), Layout::new::<RayHits<Align32, 8>>());
    assert!(eight.0.size() == 8 * 48 && eight.1.size() == 8 * 80 && eight.1.align() == 32);
    let sixteen = (Layout::new::<Rays<Align64, 16>>(), Layout::new::<RayHits<Align64, 16>>());
    assert!(sixteen.0.size() == 16 * 48 && sixteen.1.size() == 16 * 80 && sixteen.1.align() == 64);
};
