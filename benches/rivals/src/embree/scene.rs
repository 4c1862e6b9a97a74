//! A mesh in Embree's hands.

use core::ffi::{CStr, c_int, c_void};
use core::ptr::{self, NonNull};
use core::sync::atomic::{AtomicIsize, Ordering::Relaxed};
use core::time::Duration;

use leafwalk::Mesh;

use super::super::timed;
use super::binding::*;

pub(super) struct Device {
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
    pub(super) fn new() -> Self {
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

    pub(super) fn property(&self, property: c_int) -> isize {
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

pub(super) struct Scene {
    pub(super) handle: Handle,
    pub(super) device: Device,
    pub(super) bytes: usize,
}

impl Scene {
    /// Builds it at medium quality under flags; with the time that it took to commit.
    pub(super) fn new(mesh: &Mesh, flags: c_int) -> (Self, Duration) {
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
            rtcSetSceneFlags(scene, flags);
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
