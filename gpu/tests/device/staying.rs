//! Rays and answers that stay on the device.

use leafwalk::{Hit, Ray};
use leafwalk_gpu::ray::DeviceRay;
use leafwalk_gpu::{Flavour, Gpu, GpuError, Pinhole};
use leafwalk_testing::meshes;

use crate::Test;
use crate::answers::hits;
use crate::scenes::{self, Scene, differing};

pub(crate) const TESTS: &[Test] = &[
    ("camera rays made on the device are the CPU's", cameras),
    ("rays and hits stay on the device until they are read", staying),
    ("more rays than a buffer holds stay on the device", many),
    ("cameras without pixels, and with too many", extremes),
];

/// Cameras around a unit sphere, whose root cube is 4 wide.
fn pinholes() -> Vec<Pinhole> {
    let near = Pinhole {
        eye: [0.3, -0.2, 3.1],
        corner: [-0.61, 0.45, -1.0],
        right: [0.0131, 0.0, 0.001],
        down: [0.0, -0.0107, 0.0003],
        width: 100,
        height: 83,
    };
    vec![
        near,
        // Directions of any length, components that vanish, a pixel whose direction is zero.
        Pinhole { corner: near.corner.map(|c| c * 1e-9), right: near.right.map(|c| c * 1e-9), ..near },
        Pinhole { corner: [-40.0, 40.0, 0.0], right: [1.0, 0.0, 0.0], down: [0.0, -1.0, 0.0], ..near },
        Pinhole { corner: [-40.0, 1e-14, 1.0], right: [1.0, 0.0, 0.0], down: [0.0, 0.0, -1e-14], ..near },
        // The CPU's: far outside, and numbers that f32 loses.
        Pinhole { eye: [20.0, 30.0, 4000.0], corner: [-0.02, -0.02, -1.0], right: [1e-4, 0.0, 0.0], ..near },
        Pinhole { corner: [-1e-30, 1e-38, -1e-36], ..near },
    ]
}

/// The rays of a camera in the device's order.
fn rays_of(camera: &Pinhole) -> Vec<Option<Ray>> {
    (0..camera.rays()).map(|number| camera.pixel(number).map(|(x, y)| camera.ray(x, y))).collect()
}

fn cameras(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(3));
    let tracer = gpu.tracer(&scene.octree, Flavour::Exact).expect("room");
    let frame = scene.octree.parts().frame;
    for camera in pinholes() {
        let rays = rays_of(&camera);
        let mut pixels: Vec<_> = (0..camera.rays()).filter_map(|number| camera.pixel(number)).collect();
        pixels.sort_unstable();
        pixels.dedup();
        assert_eq!(pixels.len(), (camera.width * camera.height) as usize, "every pixel once");

        let found = tracer.camera_rays(&camera).expect("room").read(gpu).expect("a working device");
        let expected = rays.iter().map(|ray| {
            let canonical = ray.and_then(|ray| frame.canonical(&ray));
            canonical.map_or(DeviceRay::NEVER, |ray| DeviceRay::new(&ray))
        });
        assert_eq!(found.len(), rays.len());
        for (number, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert_eq!(found, &expected, "ray {number} of {camera:?}");
        }
    }
}

fn staying(gpu: &Gpu) {
    let scene = Scene::new("bumpy sphere", meshes::bumpy_sphere(4, 1));
    let tracer = gpu.tracer(&scene.octree, Flavour::Exact).expect("room");
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

    for camera in pinholes() {
        let on_device = tracer.camera_rays(&camera).expect("room");
        let found = tracer.submit(&on_device).expect("room").read().expect("a working device");
        let expect = |ray: Option<Ray>| ray.and_then(|ray| scene.octree.closest_hit(&ray)).unwrap_or(Hit::MISS);
        let expected: Vec<Hit> = rays_of(&camera).into_iter().map(expect).collect();
        assert_eq!(differing(&found, &expected), 0, "{camera:?}");
    }
    let none = tracer.upload(&[]).expect("no room is needed");
    assert!(none.is_empty());
    assert_eq!(tracer.submit(&none).and_then(|hits| hits.read()), Ok(vec![]));
}

fn many(gpu: &Gpu) {
    // A dispatch's workgroups along an axis, and their rays.
    const BUFFER_RAYS: usize = 65535 * 64;
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = gpu.tracer(&scene.octree, Flavour::Exact).expect("room");
    let near = pinholes()[0];
    let camera = Pinhole {
        right: near.right.map(|c| c / 20.0),
        down: near.down.map(|c| c / 50.0),
        width: 2056,
        height: 2048,
        ..near
    };
    let rays = rays_of(&camera);
    assert!(rays.len() > BUFFER_RAYS);
    // Some of all, and all about where the second buffer begins.
    let is_checked = |number: &usize| number.is_multiple_of(1009) || number.abs_diff(BUFFER_RAYS) < 5000;
    let checked: Vec<usize> = (0..rays.len()).filter(is_checked).collect();
    let expect = |number: &usize| rays[*number].and_then(|ray| scene.octree.closest_hit(&ray)).unwrap_or(Hit::MISS);
    let expected: Vec<Hit> = checked.iter().map(expect).collect();
    assert!(expected.iter().filter(|hit| !hit.is_miss()).count() > 1000);

    let found = tracer.camera_rays(&camera).and_then(|rays| tracer.submit(&rays)?.read()).expect("a working device");
    assert_eq!(found.len(), rays.len());
    assert_eq!(differing(&checked.iter().map(|number| found[*number]).collect::<Vec<_>>(), &expected), 0);

    let uploaded: Vec<Ray> = rays.into_iter().flatten().collect();
    let uploaded = tracer.upload(&uploaded).expect("room");
    let occluded = tracer.submit_occlusions(&uploaded).and_then(|answers| answers.read()).expect("a working device");
    assert!(checked.iter().zip(&expected).all(|(number, hit)| occluded[*number] != hit.is_miss()));
}

fn extremes(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = gpu.tracer(&scene.octree, Flavour::Exact).expect("room");
    let of = |width, height| Pinhole { width, height, ..pinholes()[0] };
    assert!(tracer.camera_rays(&of(0, 7)).expect("no room is needed").is_empty());
    assert_eq!((of(0, 7).pixel(0), of(9, 7).pixel(usize::MAX)), (None, None));
    let side = u32::MAX;
    let error = tracer.camera_rays(&of(side, side)).map(|_| ());
    assert_eq!(error, Err(GpuError::CameraTooLarge { width: side, height: side }));
}
