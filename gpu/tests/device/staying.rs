//! Rays and answers that stay on the device.

use leafwalk_gpu::{Flavour, Gpu, GpuError, GpuTracer};
use leafwalk_testing::meshes;
use leafwalk_testing::tally::differing;

use crate::Test;
use crate::answers::hits;
use crate::scenes::{self, Scene};

pub(crate) const TESTS: &[Test] = &[
    ("rays and hits stay on the device until they are read", staying),
    ("rays for another octree or device are refused", foreign),
];

fn staying(gpu: &Gpu) {
    let scene = Scene::new("bumpy sphere", meshes::bumpy_sphere(4, 1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let rays = scenes::hard(&scene, 5000, 1);
    let on_device = tracer.upload(&rays).expect("room");
    assert_eq!(on_device.len(), rays.len());
    let expected = hits(&scene.octree, &rays);
    for _ in 0..2 {
        let submitted = tracer.submit(&on_device).expect("room");
        assert_eq!(differing(&submitted.read().expect("a working device"), &expected), 0);
        let time = submitted.device_time().expect("a working device");
        assert_eq!(time.is_some(), gpu.adapter().has_timestamps);
        println!("{}: {} rays took {time:?}", gpu.adapter(), rays.len());
    }
    let occluded = tracer.submit_occlusions(&on_device).expect("room").read().expect("a working device");
    assert!(occluded.iter().zip(&expected).all(|(occluded, hit)| *occluded != hit.is_miss()));

    let none = tracer.upload(&[]).expect("no room is needed");
    assert!(none.is_empty());
    assert_eq!(tracer.submit(&none).and_then(|hits| hits.read()), Ok(vec![]));
}

fn foreign(gpu: &Gpu) {
    let tracer = |gpu: &Gpu, scene: &Scene| GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let scene = Scene::new("soup", meshes::soup(300, 1));
    let own = tracer(gpu, &scene);
    let rays = scenes::chords(&scene, 100, 2);

    let placed = Scene::new("placed soup", meshes::placed(&scene.mesh, 100.0, 1e4));
    let of_another_frame = tracer(gpu, &placed).upload(&rays).expect("room");
    assert_eq!(own.submit(&of_another_frame).map(|_| ()), Err(GpuError::ForeignRays));
    assert_eq!(own.submit_occlusions(&of_another_frame).map(|_| ()), Err(GpuError::ForeignRays));

    let other_gpu = crate::open_again(gpu);
    let on_another_device = tracer(&other_gpu, &scene).upload(&rays).expect("room");
    assert_eq!(own.submit(&on_another_device).map(|_| ()), Err(GpuError::ForeignRays));

    // Another octree in the same frame, on the same device.
    let finer = Scene::built_by(&leafwalk::Builder::new().step_cost(16.0), "finer soup", scene.mesh.clone());
    let of_same_frame = tracer(gpu, &finer).upload(&rays).expect("room");
    let found = own.submit(&of_same_frame).and_then(|hits| hits.read()).expect("a working device");
    assert_eq!(differing(&found, &hits(&scene.octree, &rays)), 0);
}
