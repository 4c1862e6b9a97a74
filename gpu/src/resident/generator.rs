//! `RayGenerator`: the door for rays that a shader of the caller's makes on the device, such as a camera's primary rays.

use core::fmt;
use std::sync::Arc;

use leafwalk_core::{Frame, Ray};

use super::rays::{Clocks, DeviceRays};
use crate::device::{DeviceError, Gpu, MapKernel};
use crate::error::GpuError;
use crate::flavour::Flavour;
use crate::shader;
use crate::walk::DeviceRay;

/// A ray generation shader: a function of the caller's, in WGSL, that makes rays on the device.
///
/// The text defines `fn generate_ray(number: u32) -> CanonicalRay`, and may declare one storage buffer of parameters, as
/// `@group(1) @binding(0) var<storage, read>`. Before it stands a prelude with
///
/// * the struct `CanonicalRay`, which is [`DeviceRay`] in Rust: a ray on the lattice. Its limits are finite, and count in
///   t', which is the caller's t times a power of two that depends on the length of the direction;
/// * `no_ray()`, for numbers that have no ray;
/// * `canonical_direction(direction: vec3<f32>)`, which scales a direction by a power of two as the CPU does. The bits are
///   the CPU's where the largest component lies in 2^-60..2^60. A zero direction has no canonical one: return `no_ray()`;
/// * `add`, `sub`, `mul`, `divide` and `add3`, `sub3`, `mul3`, which round once, to nearest, in the flavour
///   [`Flavour::Exact`]: who writes `a * b + c` instead leaves it to the driver whether the CPU makes the same ray;
/// * the constants of `leafwalk-core` and `WORKGROUP`, the number of neighbouring rays that are traced together.
///
/// An origin within a root edge of the root cube does not depend on the direction: [`DeviceRay::new`] of any ray from
/// there gives it, for the parameters. Rays from farther outside are moved to the root cube along their directions, in
/// f64; upload those instead. No value that the shader writes can make a walk read out of bounds or run for ever.
///
/// A fan of rays from one origin, without limits:
///
/// ```
/// use leafwalk_core::{Hit, Octree, Ray};
/// use leafwalk_gpu::{DeviceRay, GpuError, GpuTracer};
///
/// const FAN: &str = "
///     @group(1) @binding(0) var<storage, read> first: array<CanonicalRay>;
///
///     fn generate_ray(number: u32) -> CanonicalRay {
///         let direction = canonical_direction(vec3<f32>(f32(number), 0.0, -100.0));
///         return CanonicalRay(first[0].origin, first[0].t_min, direction, first[0].t_max);
///     }";
///
/// fn fan(octree: &Octree<Vec<u32>>, tracer: &GpuTracer, eye: [f32; 3]) -> Result<Vec<Hit>, GpuError> {
///     let ray = move |number: usize| Ray::new(eye, [number as f32, 0.0, -100.0]);
///     let first = DeviceRay::new(&octree.parts().frame, &ray(0));
///     let generator = tracer.ray_generator(FAN)?;
///     let rays = generator.generate(100, bytemuck::bytes_of(&first), move |number| Some(ray(number)))?;
///     tracer.submit(&rays)?.read()
/// }
/// # let text = leafwalk_gpu::RayGenerator::text(leafwalk_gpu::Flavour::Exact, FAN);
/// # naga::front::wgsl::parse_str(&text).expect("a text that compiles");
/// ```
pub struct RayGenerator {
    gpu: Gpu,
    frame: Frame,
    kernel: MapKernel,
}

impl RayGenerator {
    /// The whole text that is compiled for a source: the prelude, the source, and the kernel that calls it. For tools that
    /// check WGSL without a device.
    pub fn text(flavour: Flavour, source: &str) -> String {
        shader::generating(flavour.into(), source)
    }

    pub(crate) fn compile(gpu: &Gpu, frame: Frame, flavour: Flavour, source: &str) -> Result<Self, GpuError> {
        let compiled = MapKernel::compile(gpu, &Self::text(flavour, source), "generate_rays");
        let kernel = compiled.map_err(|error| match error {
            DeviceError::Driver { reason } => GpuError::RayShader { reason },
            error => error.into(),
        })?;
        Ok(Self { gpu: gpu.clone(), frame, kernel })
    }

    /// Makes the rays of the numbers `0..count` on the device. Does not wait.
    ///
    /// `parameters` are the contents of the shader's storage buffer. `ray` gives the ray that the shader makes for a
    /// number, in the caller's units, or `None` where it makes none. It is called when hits are read, since what turns a
    /// distance on the device into the caller's is the length of the ray's direction.
    ///
    /// # Errors
    /// When the device has no room for the rays, or fails; [`GpuError::TooManyRays`] for 2^32 rays or more.
    pub fn generate(
        &self,
        count: usize,
        parameters: &[u8],
        ray: impl Fn(usize) -> Option<Ray> + Send + Sync + 'static,
    ) -> Result<DeviceRays, GpuError> {
        if u32::try_from(count).is_err() {
            return Err(GpuError::TooManyRays { rays: count });
        }
        let make = |range: core::ops::Range<usize>| {
            let shape = (range.len(), size_of::<DeviceRay>());
            Ok((self.kernel.run(&self.gpu, parameters, range.start as u32, shape)?, range.len()))
        };
        let buffers = DeviceRays::buffer_ranges(count).map(make).collect::<Result<_, DeviceError>>()?;
        let clocks = Arc::new(Clocks::Generated(self.frame, Box::new(ray)));
        Ok(DeviceRays { gpu: self.gpu.clone(), frame: self.frame, buffers, clocks })
    }
}

impl fmt::Debug for RayGenerator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RayGenerator").field("gpu", &self.gpu).finish_non_exhaustive()
    }
}
