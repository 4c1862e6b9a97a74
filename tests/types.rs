//! What the compiler can say of the public types: the sizes of those that cross every border as plain data, and that all
//! of them may be sent to other threads and shared between them.

use std::sync::Arc;

use leafwalk::wire::Header;
use leafwalk::{
    Aabb, BruteForce, BuildError, Builder, CanonicalRay, CpuTracer, DecodeError, FileError, Frame, Hit, HitF64,
    LengthMismatch, Mesh, MeshRef, Octree, Parts, Progress, Ray, RayF64, RecordFault, Stats, Tracer, Verified,
    VerifyError, Work,
};
use leafwalk_core::layout::Section;

/// Compiles only where all of the types are `Send` and `Sync`.
macro_rules! assert_send_and_sync {
    ($($kind:ty),+ $(,)?) => {
        const {
            const fn assert<T: Send + Sync>() {}
            $(assert::<$kind>();)+
        }
    };
}

#[test]
fn rays_and_hits_are_plain_data() {
    assert_eq!((size_of::<Ray>(), align_of::<Ray>()), (32, 4));
    assert_eq!((size_of::<Hit>(), align_of::<Hit>()), (16, 4));
    // From the bytes of a ray and back: there is no padding between or behind its members.
    let ray = Ray::between([1.0, 2.0, 3.0], [5.0, 6.0, 7.0], 4.0, 8.0);
    assert_eq!(bytemuck::cast::<Ray, [f32; 8]>(ray), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    let ray = RayF64::from(ray);
    assert_eq!(bytemuck::cast::<RayF64, [f64; 8]>(ray), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    let hit = Hit { t: 1.0, u: 2.0, v: 3.0, primitive: 4 };
    assert_eq!(bytemuck::cast::<Hit, [u32; 4]>(hit), [1f32.to_bits(), 2f32.to_bits(), 3f32.to_bits(), 4]);
}

/// What each pointer to a tracer answers, as the tracer itself does.
#[test]
fn pointers_to_tracers_are_tracers() {
    fn hits<T: Tracer<Error = LengthMismatch>>(tracer: T) -> [Hit; 2] {
        let rays = [[0.25, 0.5, 2.0], [3.0, 3.0, 2.0]].map(|origin| Ray::new(origin, [0.0, 0.0, -1.0]));
        let (mut hits, mut occluded) = ([Hit::MISS; 2], [false; 2]);
        tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
        tracer.occlusions(&rays, &mut occluded).expect("equal lengths");
        assert_eq!(occluded, hits.map(|hit| !hit.is_miss()));
        hits
    }
    let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let expected = [Hit { t: 2.0, u: 0.25, v: 0.5, primitive: 0 }, Hit::MISS];
    let any: &dyn Tracer<Error = LengthMismatch> = &octree;
    assert_eq!(hits(any), expected);
    let tracer = CpuTracer::new(octree.view());
    assert_eq!(hits(&tracer), expected);
    assert_eq!(hits(tracer), expected);
    let boxed: Box<dyn Tracer<Error = LengthMismatch>> = Box::new(octree.view());
    assert_eq!((hits(&boxed), hits(boxed)), (expected, expected));
    assert_eq!(hits(Arc::new(CpuTracer::new(octree))), expected);
}

#[test]
fn all_types_are_for_many_threads() {
    assert_send_and_sync!(
        Aabb,
        CanonicalRay,
        Frame,
        Header,
        Hit,
        HitF64,
        Parts<'static>,
        Ray,
        RayF64,
        Section,
        Stats,
        Work
    );
    assert_send_and_sync!(
        BruteForce,
        Builder,
        Mesh,
        Mesh<f64>,
        MeshRef<'static>,
        Octree<Vec<u32>>,
        Octree<&[u32]>,
        Progress,
        Verified
    );
    assert_send_and_sync!(CpuTracer<Vec<u32>>, CpuTracer<&[u32]>);
    assert_send_and_sync!(BuildError, DecodeError, FileError, LengthMismatch, RecordFault, VerifyError);
}

#[test]
#[cfg(feature = "mesh-files")]
fn types_of_mesh_files_are_for_many_threads() {
    use leafwalk::mesh_file::{AnyMesh, Limits, Material, MeshError, MeshFile};
    assert_send_and_sync!(AnyMesh, Limits, Material, MeshError, MeshFile);
}

#[test]
#[cfg(feature = "gpu")]
fn types_of_gpus_are_for_many_threads() {
    use leafwalk::gpu::{
        Adapter, AdapterChoice, DeviceHits, DeviceOcclusions, DeviceRays, Flavour, Gpu, GpuError, GpuTracer,
        RayGenerator, SelfTest,
    };
    assert_send_and_sync!(Adapter, DeviceHits, DeviceOcclusions, DeviceRays, Flavour, Gpu, GpuError, GpuTracer);
    assert_send_and_sync!(AdapterChoice, RayGenerator, SelfTest);
}
