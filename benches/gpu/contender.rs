//! Kernels with rays ready on the device, ours among them.

use core::time::Duration;
use std::time::Instant;

use leafwalk::Hit;
use leafwalk_gpu::{DeviceHits, DeviceOcclusions, DeviceRays, GpuTracer};

/// A kernel and a batch of rays on the device.
pub(crate) trait Contender {
    /// As tables print it.
    fn name(&self) -> &'static str;
    /// Traces all rays, and gives the time that the device took, or the time by the clock on the wall where the device
    /// can't tell.
    fn trace(&mut self) -> Duration;
    /// What the last trace answered, ray by ray; of occlusions [`OCCLUDED`] or a miss.
    fn answers(&self) -> Vec<Hit>;
}

/// Stands for any hit.
pub(crate) const OCCLUDED: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, primitive: 0 };

/// One of our flavours.
pub(crate) struct Ours<'a> {
    name: &'static str,
    tracer: &'a GpuTracer,
    rays: &'a DeviceRays,
    is_occlusion: bool,
    last: Option<Answers>,
}

enum Answers {
    Hits(DeviceHits),
    Occlusions(DeviceOcclusions),
}

impl<'a> Ours<'a> {
    pub(crate) fn new(name: &'static str, tracer: &'a GpuTracer, rays: &'a DeviceRays, is_occlusion: bool) -> Self {
        Self { name, tracer, rays, is_occlusion, last: None }
    }
}

impl Contender for Ours<'_> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn trace(&mut self) -> Duration {
        let start = Instant::now();
        let (time, answers) = if self.is_occlusion {
            let answers = self.tracer.submit_occlusions(self.rays).expect("a working device");
            (answers.device_time(), Answers::Occlusions(answers))
        } else {
            let answers = self.tracer.submit(self.rays).expect("a working device");
            (answers.device_time(), Answers::Hits(answers))
        };
        self.last = Some(answers);
        time.expect("a working device").unwrap_or_else(|| start.elapsed())
    }

    fn answers(&self) -> Vec<Hit> {
        match &self.last {
            None => vec![],
            Some(Answers::Hits(hits)) => hits.read().expect("a working device"),
            Some(Answers::Occlusions(answers)) => {
                let answers = answers.read().expect("a working device");
                answers.into_iter().map(|occluded| if occluded { OCCLUDED } else { Hit::MISS }).collect()
            }
        }
    }
}
