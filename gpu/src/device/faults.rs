//! `Faults`: what went wrong on a device, kept for the thread that it concerns.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use super::error::DeviceError;

/// The faults of a device that nobody was told of yet.
///
/// wgpu reports most faults through a callback, in the thread whose call failed and before that call returns. A fault is
/// kept under that thread's name: handed to another thread, it would leave the failed call's answers for good ones.
#[derive(Default)]
pub(super) struct Faults {
    /// The first fault of each thread since it last asked. Those that come after it follow from it.
    first: Mutex<HashMap<ThreadId, DeviceError>>,
    /// The loss of the device, which stays.
    lost: Mutex<Option<DeviceError>>,
}

impl Faults {
    /// Listens to a device from now on.
    pub(super) fn listen(device: &wgpu::Device) -> Arc<Self> {
        let faults = Arc::new(Self::default());
        let (errors, losses) = (Arc::clone(&faults), Arc::clone(&faults));
        device.on_uncaptured_error(Arc::new(move |error| {
            lock(&errors.first).entry(thread::current().id()).or_insert_with(|| DeviceError::of_wgpu(&error));
        }));
        device.set_device_lost_callback(move |_, reason| {
            lock(&losses.lost).get_or_insert(DeviceError::Lost { reason });
        });
        faults
    }

    /// Takes the first fault of the calling thread since it last asked.
    pub(super) fn take(&self) -> Option<DeviceError> {
        lock(&self.first).remove(&thread::current().id())
    }

    /// The loss of the device, if it is lost.
    pub(super) fn loss(&self) -> Option<DeviceError> {
        lock(&self.lost).clone()
    }
}

/// Locks a mutex. None of them guards anything that a panic could leave half done.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
