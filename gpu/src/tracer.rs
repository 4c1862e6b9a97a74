//! `GpuTracer`: the tracer whose walks run on a device.

use core::fmt;

use leafwalk_core::{Clock, Hit, Octree, Ray, Tracer, Work};

use crate::batch::{Batch, BufferPool};
use crate::device::{Adapter, AdapterChoice, Exactness, Gpu, SelfTest};
use crate::error::GpuError;
use crate::flavour::Flavour;
use crate::resident::{DeviceHits, DeviceOcclusions, DeviceRays, RayGenerator};
use crate::shader::{self, Arithmetic};
use crate::walk::{DeviceAnswer, DeviceHit, WalkKernels};

/// Answers batches of rays on a device, by the walk from leaf to leaf that [`Octree`] makes on the CPU.
///
/// Rays of the [`Tracer`] interface are uploaded with each batch. Rays that are traced more than once, or made on the
/// device, stay there as [`DeviceRays`]; their answers stay there, too, until they are read.
pub struct GpuTracer {
    kernels: WalkKernels,
    flavour: Flavour,
    self_test: SelfTest,
    step_cost: f32,
    pool: BufferPool,
}

impl GpuTracer {
    /// Opens an adapter, tries its arithmetic, and uploads the octree's words as they are.
    ///
    /// # Errors
    /// There is no such adapter, or it fails; or the octree is compact, or larger than the shader's bindings reach.
    pub fn new<W: AsRef<[u32]>>(octree: &Octree<W>, choice: AdapterChoice, flavour: Flavour) -> Result<Self, GpuError> {
        Self::on(&Gpu::open(&choice)?, octree, flavour)
    }

    /// Makes a tracer on a device that is open, and may have other tracers.
    ///
    /// # Errors
    /// As [`GpuTracer::new`], but for the adapter.
    pub fn on<W: AsRef<[u32]>>(gpu: &Gpu, octree: &Octree<W>, flavour: Flavour) -> Result<Self, GpuError> {
        let binding_bytes = gpu.device.limits().max_storage_buffer_binding_size;
        Self::with_arithmetic(gpu, octree, flavour, flavour.into(), binding_bytes)
    }

    /// Makes a tracer whose text computes with the given arithmetic, the flavour's own or a mutant of it, and whose
    /// octree is spread over bindings of at most `binding_bytes`.
    pub(crate) fn with_arithmetic<W: AsRef<[u32]>>(
        gpu: &Gpu,
        octree: &Octree<W>,
        flavour: Flavour,
        arithmetic: Arithmetic,
        binding_bytes: u64,
    ) -> Result<Self, GpuError> {
        let kernels = WalkKernels::new(gpu, octree, arithmetic, binding_bytes)?;
        let self_test = SelfTest::of_text(gpu, &shader::checks(arithmetic))?;
        let step_cost = octree.parts().header.step_cost;
        Ok(Self { kernels, flavour, self_test, step_cost, pool: BufferPool::default() })
    }

    /// The device that traces.
    pub fn gpu(&self) -> &Gpu {
        &self.kernels.gpu
    }

    /// The adapter that traces.
    pub fn adapter(&self) -> &Adapter {
        self.gpu().adapter()
    }

    /// The flavour of the shader.
    pub fn flavour(&self) -> Flavour {
        self.flavour
    }

    /// What the device made of the flavour's arithmetic.
    pub fn self_test(&self) -> &SelfTest {
        &self.self_test
    }

    /// Whether hits have the CPU's bits.
    pub fn exactness(&self) -> Exactness {
        self.self_test.exactness()
    }

    /// The step cost that the octree was built with. Where it is larger than that of `Builder::for_walks` of
    /// `leafwalk-cpu`, the leaves are large, as CPUs want them; an octree built for walks gives the same hits sooner.
    pub fn step_cost(&self) -> f32 {
        self.step_cost
    }

    /// Finds closest hits, and counts the work of each walk: as many cells as the CPU's walk visits, and about as many
    /// blocks, since a driver may round the tests of their boxes as it likes.
    ///
    /// # Errors
    /// When the slices differ in length, or the device fails.
    pub fn closest_hits_with_work(&self, rays: &[Ray], answers: &mut [(Hit, Work)]) -> Result<(), GpuError> {
        let finish = |found: DeviceAnswer, clock: &Clock| {
            (found.hit.reported(clock), Work { cells: found.cells, blocks: found.blocks })
        };
        self.batch().run(&self.kernels.closest_hits_with_work, rays, answers, finish)
    }

    /// Uploads rays, once for any number of submissions.
    ///
    /// # Errors
    /// When the device has no room for them, or fails.
    pub fn upload(&self, rays: &[Ray]) -> Result<DeviceRays, GpuError> {
        Ok(DeviceRays::upload(&self.kernels.gpu, self.kernels.frame, rays)?)
    }

    /// Compiles a ray generation shader, which makes rays for this tracer on its device. What the text is to define,
    /// [`RayGenerator`] says.
    ///
    /// # Errors
    /// [`GpuError::RayShader`] when the text does not compile.
    pub fn ray_generator(&self, source: &str) -> Result<RayGenerator, GpuError> {
        RayGenerator::compile(&self.kernels.gpu, self.kernels.frame, self.flavour, source)
    }

    /// Finds the closest hits of rays on the device, and leaves them there. Does not wait.
    ///
    /// # Errors
    /// When the device has no room for the hits, or fails; [`GpuError::ForeignRays`] when the rays were made for an octree
    /// in another frame, or for another device.
    pub fn submit(&self, rays: &DeviceRays) -> Result<DeviceHits, GpuError> {
        DeviceHits::closest_hits(&self.kernels, rays)
    }

    /// Finds whether anything is hit by rays on the device, and leaves the answers there. Does not wait.
    ///
    /// # Errors
    /// As [`GpuTracer::submit`].
    pub fn submit_occlusions(&self, rays: &DeviceRays) -> Result<DeviceOcclusions, GpuError> {
        DeviceOcclusions::occlusions(&self.kernels, rays)
    }

    fn batch(&self) -> Batch<'_> {
        Batch { kernels: &self.kernels, pool: &self.pool }
    }
}

impl Tracer for GpuTracer {
    type Error = GpuError;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), GpuError> {
        self.batch().run(&self.kernels.closest_hits, rays, hits, |hit: DeviceHit, clock| hit.reported(clock))
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), GpuError> {
        self.batch().run(&self.kernels.occlusions, rays, occluded, |is_hit: u32, _| is_hit != 0)
    }
}

impl fmt::Debug for GpuTracer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuTracer")
            .field("adapter", self.adapter())
            .field("flavour", &self.flavour)
            .field("self_test", &self.self_test)
            .finish_non_exhaustive()
    }
}
