//! `GpuTracer`: the `Tracer` whose walks run on a device.

use core::fmt;

use leafwalk_core::{Frame, Hit, Octree, Ray, Tracer, Work};

use crate::adapter::{Adapter, Pick};
use crate::batch::{Batch, Slots};
use crate::chunk::Split;
use crate::error::GpuError;
use crate::flavour::Flavour;
use crate::gpu::Gpu;
use crate::kernel::{Kernel, Module};
use crate::ray::{DeviceAnswer, DeviceHit};
use crate::self_test::{Promise, SelfTest};
use crate::shader;
use crate::structure::Structure;

/// Answers batches of rays on a device. What it promises about the bits, [`GpuTracer::promise`] says.
pub struct GpuTracer {
    pub(crate) gpu: Gpu,
    pub(crate) frame: Frame,
    flavour: Flavour,
    self_test: SelfTest,
    pub(crate) module: Module,
    pub(crate) structure: wgpu::BindGroup,
    pub(crate) closest_hits: Kernel,
    pub(crate) occlusions: Kernel,
    closest_hits_with_work: Kernel,
    slots: Slots,
    pub(crate) camera: (Module, Kernel),
}

impl GpuTracer {
    /// Opens an adapter, tests its arithmetic and uploads the octree's words as they are.
    ///
    /// An octree of smaller leaves than a CPU wants is traced faster: one built with a step cost of 64.
    ///
    /// # Errors
    /// [`GpuError`]: no such adapter, no device, no room, or an octree that is compact or larger than the
    /// shaders' bindings reach.
    pub fn new<W: AsRef<[u32]>>(octree: &Octree<W>, pick: Pick, flavour: Flavour) -> Result<Self, GpuError> {
        Gpu::open(&pick)?.tracer(octree, flavour)
    }

    /// [`Gpu::tracer`] with bindings of at most `binding_bytes`, for tests of octrees that need several.
    #[doc(hidden)]
    pub fn split<W: AsRef<[u32]>>(
        gpu: &Gpu,
        octree: &Octree<W>,
        flavour: Flavour,
        binding_bytes: u64,
    ) -> Result<Self, GpuError> {
        if octree.is_compact() {
            return Err(GpuError::CompactOctree);
        }
        let split = Split::new(size_of_val(octree.as_words()) as u64, binding_bytes)?;
        let self_test = gpu.self_test(flavour)?;
        let module = Module::new(gpu, "tracing", &shader::tracing(flavour, split), split.bindings)?;
        let kernel = |name, any_hit: bool| module.kernel(gpu, name, &[("ANY_HIT", f64::from(u8::from(any_hit)))]);
        let (closest_hits, occlusions) = (kernel("closest_hits", false)?, kernel("occlusions", true)?);
        let closest_hits_with_work = kernel("closest_hits_with_work", false)?;
        let camera = Module::new(gpu, "camera", &shader::camera(flavour), 0)?;
        let camera_rays = camera.kernel(gpu, "camera_rays", &[])?;
        let structure = Structure::upload(gpu, octree, split)?.bind(gpu, &module);
        gpu.check()?;
        Ok(Self {
            gpu: gpu.clone(),
            frame: octree.parts().frame,
            flavour,
            self_test,
            module,
            structure,
            closest_hits,
            occlusions,
            closest_hits_with_work,
            slots: Slots::default(),
            camera: (camera, camera_rays),
        })
    }

    /// The adapter that traces.
    pub fn adapter(&self) -> &Adapter {
        self.gpu.adapter()
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
    pub fn promise(&self) -> Promise {
        self.self_test.promise()
    }

    /// Closest hits, and what each takes: as many cells as the scalar tracer, and about as many blocks.
    ///
    /// # Errors
    /// [`GpuError`], when the slices differ in length or the device fails.
    pub fn closest_hits_with_work(&self, rays: &[Ray], answers: &mut [(Hit, Work)]) -> Result<(), GpuError> {
        self.batch().run(&self.closest_hits_with_work, rays, answers, |found: DeviceAnswer, clock| {
            (found.hit.reported(clock), Work { cells: found.cells, blocks: found.blocks })
        })
    }

    fn batch(&self) -> Batch<'_> {
        let Self { gpu, frame, module, structure, slots, .. } = self;
        Batch { gpu, frame: *frame, module, structure, slots }
    }
}

impl Tracer for GpuTracer {
    type Error = GpuError;

    fn closest_hits(&self, rays: &[Ray], hits: &mut [Hit]) -> Result<(), GpuError> {
        self.batch().run(&self.closest_hits, rays, hits, |hit: DeviceHit, clock| hit.reported(clock))
    }

    fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) -> Result<(), GpuError> {
        self.batch().run(&self.occlusions, rays, occluded, |is_hit: u32, _| is_hit != 0)
    }
}

impl fmt::Debug for GpuTracer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { gpu, flavour, self_test, .. } = self;
        f.debug_struct("GpuTracer")
            .field("adapter", gpu.adapter())
            .field("flavour", flavour)
            .field("self_test", self_test)
            .finish_non_exhaustive()
    }
}
