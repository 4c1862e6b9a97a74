//! Batches: none, one, more than a chunk; invalid rays; slices of unequal length.

use leafwalk::{Hit, LengthMismatch, Ray, Tracer, Work};
use leafwalk_gpu::{DeviceError, Flavour, Gpu, GpuError, GpuTracer, testing};
use leafwalk_testing::meshes;
use leafwalk_testing::tally::differing;

use crate::Test;
use crate::answers::hits;
use crate::scenes::{self, Scene};

pub(crate) const TESTS: &[Test] = &[
    ("batches of any size", sizes),
    ("a batch of several chunks", chunks),
    ("invalid rays miss and visit nothing", invalid),
    ("an empty mesh has no hits", nothing),
    ("a lost device is an error, again and again", lost),
];

fn sizes(gpu: &Gpu) {
    let scene = Scene::new("soup", meshes::soup(300, 1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let rays = scenes::chords(&scene, 9000, 2);
    for size in [0, 1, 63, 64, 65, 4097, 9000, 3] {
        let rays = &rays[..size];
        assert_eq!(differing(&hits(&tracer, rays), &hits(&scene.octree, rays)), 0, "{size} rays");
    }
    let lengths = LengthMismatch { rays: 3, answers: 2 };
    assert_eq!(tracer.closest_hits(&rays[..3], &mut [Hit::MISS; 2]), Err(GpuError::Lengths(lengths)));
    assert_eq!(tracer.occlusions(&rays[..3], &mut [false; 2]), Err(GpuError::Lengths(lengths)));
}

fn chunks(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    // Three chunks of 2^20 rays and a bit: both slots are used again. The same few rays over and over, shifted.
    let some = scenes::chords(&scene, 4099, 3);
    let rays: Vec<Ray> = some.iter().copied().cycle().take(3 * (1 << 20) + 5).collect();
    let expected = hits(&scene.octree, &some);
    for (at, found) in hits(&tracer, &rays).chunks(some.len()).enumerate() {
        assert_eq!(differing(found, &expected), 0, "from ray {}", at * some.len());
    }
}

fn invalid(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    let rays = [
        Ray::new([0.0; 3], [0.0; 3]),
        Ray::new([nan, 0.0, 0.0], [1.0; 3]),
        Ray::new([0.0; 3], [1.0, inf, 0.0]),
        Ray::between([0.0; 3], [1.0; 3], -inf, inf),
        Ray::between([0.0; 3], [1.0; 3], 0.0, nan),
        Ray::new([100.0, 100.0, 0.0], [0.0, 0.0, 1.0]),
    ];
    let mut answers = [(Hit::MISS, Work { cells: 1, blocks: 1 }); 6];
    tracer.closest_hits_with_work(&rays, &mut answers).expect("a working device");
    assert_eq!(answers, [(Hit::MISS, Work::default()); 6]);
    assert_eq!(hits(&tracer, &rays), [Hit::MISS; 6]);
}

fn nothing(gpu: &Gpu) {
    let scene = Scene::new("nothing", leafwalk::Mesh::new(vec![], vec![]));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let rays = [Ray::new([0.5; 3], [1.0, 0.0, 0.0])];
    assert_eq!(hits(&tracer, &rays), [Hit::MISS]);
}

fn lost(gpu: &Gpu) {
    let scene = Scene::new("soup", meshes::soup(300, 1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let rays = scenes::chords(&scene, 100, 2);
    let on_device = tracer.upload(&rays).expect("room");
    let submitted = tracer.submit(&on_device).expect("room");
    testing::lose(gpu);
    for _ in 0..2 {
        let errors = [
            tracer.closest_hits(&rays, &mut [Hit::MISS; 100]).err(),
            tracer.upload(&rays).err(),
            tracer.submit(&on_device).and_then(|hits| hits.read()).err(),
            submitted.read().err(),
            GpuTracer::on(gpu, &scene.octree, Flavour::Exact).err(),
        ];
        assert!(
            errors.iter().all(|error| matches!(error, Some(GpuError::Device(DeviceError::Lost { .. })))),
            "{errors:?}"
        );
    }
}
