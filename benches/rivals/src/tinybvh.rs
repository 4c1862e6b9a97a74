//! tinybvh's eight-wide BVH for CPUs, which it calls `BVH8_CPU`.
//!
//! The library inside the crate tinybvh-rs is called by the names of its C++: the crate offers this layout only to
//! builds with AVX2 throughout, no search that ends at any hit, no AVX in the builder, and its `Ray` is half as long as
//! the one that its C++ writes.

use core::alloc::Layout;
use core::ffi::{CStr, c_char, c_void};
use core::time::Duration;

use leafwalk::{Mesh, Ray};
// Only for the library inside.
use tinybvh_rs as _;

use super::{Answer, OneByOne, Prepared, Rival, timed};

#[cfg(not(all(target_arch = "x86_64", unix)))]
compile_error!("the feature `tinybvh` is for x86-64 on Unix: leave it out");

type Handle = *mut c_void;

// The names are those of the Itanium ABI, by which a method is a function of a pointer first; a result that has a
// destructor goes where the first argument points (System V on x86-64).
unsafe extern "C" {
    #[link_name = "_ZN7tinybvh12BVH8_CPU_newEv"]
    fn make(place: *mut Handle);
    #[link_name = "_ZN7tinybvh8BVH8_CPUD1Ev"]
    fn destroy(bvh: Handle);
    #[link_name = "_ZdlPv"]
    fn delete(memory: Handle);
    #[link_name = "_ZN7tinybvh8BVH8_CPU5BuildERKNS_12bvhvec4sliceE"]
    fn build(bvh: Handle, corners: *const Slice);
    #[link_name = "_ZN7tinybvh8BVH8_CPU4SaveEPKc"]
    fn save(bvh: Handle, path: *const c_char);
    #[link_name = "_ZNK7tinybvh8BVH8_CPU9IntersectERNS_3RayE"]
    fn intersect(bvh: Handle, ray: *mut TinyRay) -> i32;
    #[link_name = "_ZNK7tinybvh8BVH8_CPU10IsOccludedERKNS_3RayE"]
    fn is_occluded(bvh: Handle, ray: *const TinyRay) -> bool;
}

/// `bvhvec4slice`.
#[repr(C)]
struct Slice {
    data: *const [f32; 4],
    count: u32,
    stride: u32,
}

/// `Ray`, with `INST_IDX_BITS` 32 as is its default.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct TinyRay {
    origin: [f32; 3],
    mask: u32,
    direction: [f32; 3],
    instance: u32,
    inverse: [f32; 3],
    hit_instance: u32,
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
    of_user: [u32; 16],
}

const _: () = assert!(Layout::new::<TinyRay>().size() == 128);

/// No limit, as tinybvh has it.
const FAR: f32 = 1e30;
const NONE: u32 = u32::MAX;

impl TinyRay {
    /// As tinybvh's own constructor does, with a unit direction: its t are lengths.
    fn new(ray: &Ray) -> Self {
        assert_eq!(ray.t_min, 0.0, "tinybvh's rays start at 0");
        let length = length(ray);
        let direction = ray.direction.map(|c| c / length);
        let inverse = direction.map(|c| if c.abs() > 1e-12 { 1.0 / c } else { FAR.copysign(c) });
        let t = (ray.t_max * length).min(FAR);
        let (mask, instance, hit_instance, primitive) = (0xffff, 0, 0, NONE);
        let [u, v] = [0.0; 2];
        let of_user = [0; 16];
        Self { origin: ray.origin, mask, direction, instance, inverse, hit_instance, t, u, v, primitive, of_user }
    }
}

fn length(ray: &Ray) -> f32 {
    glam::Vec3::from(ray.direction).length()
}

struct Library(Handle);

impl Library {
    fn new(corners: &[[f32; 4]]) -> Self {
        let mut handle = core::ptr::null_mut();
        let count = u32::try_from(corners.len()).expect("fewer than 2^32 corners");
        let slice = Slice { data: corners.as_ptr(), count, stride: size_of::<[f32; 4]>() as u32 };
        // SAFETY: `make` puts a new object at the place it is given; `build` reads as many corners as the slice has.
        unsafe {
            make(&raw mut handle);
            build(handle, &raw const slice);
        }
        Self(handle)
    }

    /// The length of the structure alone, in a file, but for less than a thousand bytes of its head.
    fn bytes(&self) -> usize {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        let path = [file.path().as_os_str().as_encoded_bytes(), b"\0"].concat();
        let path = CStr::from_bytes_with_nul(&path).expect("a path without zeros");
        // SAFETY: The handle is alive, and the path a C string.
        unsafe { save(self.0, path.as_ptr()) };
        file.as_file().metadata().expect("a file").len() as usize
    }
}

impl Drop for Library {
    fn drop(&mut self) {
        // SAFETY: Made by `new`, and nobody else holds it.
        unsafe {
            destroy(self.0);
            delete(self.0);
        }
    }
}

/// The tracer.
pub struct Bvh8 {
    library: Library,
    bytes: usize,
    /// The library looks at them again whenever it likes.
    _corners: Vec<[f32; 4]>,
}

impl Bvh8 {
    /// Builds it, with the time that took; `None` on a CPU that it does not run on.
    pub fn new(mesh: &Mesh) -> Option<(Self, Duration)> {
        if !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")) {
            return None;
        }
        let corner = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        let corners: Vec<_> = (0..mesh.triangles.len()).flat_map(|i| mesh.corners(i).map(corner)).collect();
        let (library, time) = timed(|| Library::new(&corners));
        let bytes = library.bytes();
        Some((Self { library, bytes, _corners: corners }, time))
    }
}

impl Rival for Bvh8 {
    fn name(&self) -> &str {
        "tinybvh bvh8"
    }
    fn bytes(&self) -> Option<usize> {
        Some(self.bytes)
    }
    fn rebuild(&self, mesh: &Mesh) -> Option<Duration> {
        Self::new(mesh).map(|(_, time)| time)
    }
    fn closest<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<Answer> + 'a> {
        Box::new(Closest { library: &self.library, rays, forms: rays.iter().map(TinyRay::new).collect() })
    }
    fn occluded<'a>(&'a self, rays: &'a [Ray]) -> Box<dyn Prepared<bool> + 'a> {
        // SAFETY: The handle is alive, and the ray of the library's form.
        let trace = |ray: &TinyRay| unsafe { is_occluded(self.library.0, ray) };
        Box::new(OneByOne::new(rays, TinyRay::new, false, trace, |_: &_, occluded: &bool| *occluded))
    }
}

/// Rays that hold their hits.
struct Closest<'a> {
    library: &'a Library,
    rays: &'a [Ray],
    forms: Vec<TinyRay>,
}

impl Prepared<Answer> for Closest<'_> {
    fn reset(&mut self) {
        for (form, ray) in self.forms.iter_mut().zip(self.rays) {
            *form = TinyRay::new(ray);
        }
    }
    fn trace(&mut self) {
        for form in &mut self.forms {
            // SAFETY: The handle is alive, and the ray of the library's form.
            unsafe { intersect(self.library.0, form) };
        }
    }
    fn answers(&self) -> Vec<Answer> {
        let answer = |(form, ray): (&TinyRay, &Ray)| match form.primitive {
            NONE => Answer::MISS,
            primitive => Answer { t: form.t / length(ray), primitive },
        };
        self.forms.iter().zip(self.rays).map(answer).collect()
    }
}
