//! Rays that a ray generation shader makes on the device.

use leafwalk::{Hit, Ray};
use leafwalk_gpu::testing::rays_on_device;
use leafwalk_gpu::{DeviceRay, Flavour, Gpu, GpuError, GpuTracer};
use leafwalk_testing::meshes;
use leafwalk_testing::tally::differing;

use crate::Test;
use crate::pinhole::Pinhole;
use crate::scenes::Scene;

pub(crate) const TESTS: &[Test] = &[
    ("camera rays made on the device are the CPU's, and so are their hits", cameras),
    ("more rays than a buffer holds are made on the device", many),
    ("cameras without pixels, and more rays than 32 bits number", extremes),
    ("a ray generation shader that does not compile is refused", refused),
    ("parameters are as long as they are", parameters),
    ("rays of random bits end, and hit triangles that there are", random_bits),
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
        // Only the CPU can make their rays: far outside, and numbers that f32 loses.
        Pinhole { eye: [20.0, 30.0, 4000.0], corner: [-0.02, -0.02, -1.0], right: [1e-4, 0.0, 0.0], ..near },
        Pinhole { corner: [-1e-30, 1e-38, -1e-36], ..near },
    ]
}

fn cameras(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(3));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let frame = scene.octree.parts().frame;
    let made = pinholes().iter().filter(|camera| camera.to_device(&frame).is_some()).count();
    assert_eq!(made, 4, "the first four are made on the device");
    for camera in pinholes() {
        let rays = camera.numbered_rays();
        let mut pixels: Vec<_> = (0..camera.rays()).filter_map(|number| camera.pixel(number)).collect();
        pixels.sort_unstable();
        pixels.dedup();
        assert_eq!(pixels.len(), (camera.width * camera.height) as usize, "every pixel once");

        let on_device = camera.on_device(&tracer, &frame).expect("room");
        let found = rays_on_device(&on_device).expect("a working device");
        assert_eq!(found.len(), rays.len());
        for (number, (found, ray)) in found.iter().zip(&rays).enumerate() {
            let expected = ray.map_or(DeviceRay::NEVER, |ray| DeviceRay::new(&frame, &ray));
            assert_eq!(found, &expected, "ray {number} of {camera:?}");
        }

        let found = tracer.submit(&on_device).and_then(|hits| hits.read()).expect("a working device");
        let expect = |ray: Option<Ray>| Hit::from(ray.and_then(|ray| scene.octree.closest_hit(&ray)));
        let expected: Vec<Hit> = rays.into_iter().map(expect).collect();
        assert_eq!(differing(&found, &expected), 0, "{camera:?}");
    }
}

fn many(gpu: &Gpu) {
    // A dispatch's workgroups along an axis, and their rays.
    const BUFFER_RAYS: usize = 65535 * 64;
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let near = pinholes()[0];
    let camera = Pinhole {
        right: near.right.map(|c| c / 20.0),
        down: near.down.map(|c| c / 50.0),
        width: 2056,
        height: 2048,
        ..near
    };
    let rays = camera.numbered_rays();
    assert!(rays.len() > BUFFER_RAYS);
    // Some of all, and all about where the second buffer begins.
    let is_checked = |number: &usize| number.is_multiple_of(1009) || number.abs_diff(BUFFER_RAYS) < 5000;
    let checked: Vec<usize> = (0..rays.len()).filter(is_checked).collect();
    let expect = |number: &usize| Hit::from(rays[*number].and_then(|ray| scene.octree.closest_hit(&ray)));
    let expected: Vec<Hit> = checked.iter().map(expect).collect();
    assert!(expected.iter().filter(|hit| !hit.is_miss()).count() > 1000);

    let frame = scene.octree.parts().frame;
    let found = camera.on_device(&tracer, &frame).and_then(|rays| tracer.submit(&rays)?.read());
    let found = found.expect("a working device");
    assert_eq!(found.len(), rays.len());
    assert_eq!(differing(&checked.iter().map(|number| found[*number]).collect::<Vec<_>>(), &expected), 0);

    let uploaded: Vec<Ray> = rays.into_iter().flatten().collect();
    let uploaded = tracer.upload(&uploaded).expect("room");
    let occluded = tracer.submit_occlusions(&uploaded).and_then(|answers| answers.read()).expect("a working device");
    assert!(checked.iter().zip(&expected).all(|(number, hit)| occluded[*number] != hit.is_miss()));
}

/// A shader that makes no ray, whatever its parameters are.
const NO_RAYS: &str = "fn generate_ray(number: u32) -> CanonicalRay { return no_ray(); }";

fn extremes(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let of = |width, height| Pinhole { width, height, ..pinholes()[0] };
    let none = of(0, 7).on_device(&tracer, &scene.octree.parts().frame).expect("no room is needed");
    assert!(none.is_empty());
    assert_eq!((of(0, 7).pixel(0), of(9, 7).pixel(usize::MAX)), (None, None));
    let rays = 1 << 32;
    let error = tracer.ray_generator(NO_RAYS).and_then(|generator| generator.generate(rays, &[], |_| None));
    assert_eq!(error.map(|_| ()), Err(GpuError::TooManyRays { rays }));
}

fn refused(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    for source in ["", "fn generate_ray(number: u32) -> CanonicalRay { return ray_of_nobody; }"] {
        let error = tracer.ray_generator(source).map(|_| ());
        assert!(matches!(error, Err(GpuError::RayShader { .. })), "{error:?}");
    }
    // The device still works.
    assert!(tracer.ray_generator(NO_RAYS).is_ok());
}

/// Parameters of no and of odd lengths reach the shader, filled up to whole words with zeros.
fn parameters(gpu: &Gpu) {
    let scene = Scene::new("sphere", meshes::icosphere(1));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    // The last word and the number of words, as a ray's limits.
    let source = "@group(1) @binding(0) var<storage, read> parameters: array<u32>;
        fn generate_ray(number: u32) -> CanonicalRay {
            let words = arrayLength(&parameters);
            return CanonicalRay(vec3<f32>(0.0), f32(parameters[words - 1u]), vec3<f32>(1.0), f32(words));
        }";
    let generator = tracer.ray_generator(source).expect("a text that compiles");
    for (bytes, expected) in [(&[][..], (0.0, 1.0)), (&[7, 0, 0, 0], (7.0, 1.0)), (&[0, 0, 0, 0, 5], (5.0, 2.0))] {
        let rays = generator.generate(3, bytes, |_| None).expect("room");
        for ray in rays_on_device(&rays).expect("a working device") {
            assert_eq!((ray.t_min, ray.t_max), expected, "{bytes:?}");
        }
    }
}

/// The values that a shader writes are not checked: whatever they are, every walk ends and reads what there is.
fn random_bits(gpu: &Gpu) {
    const RAYS: usize = 1 << 14;
    let scene = Scene::new("soup", meshes::soup(1500, 4));
    let tracer = GpuTracer::on(gpu, &scene.octree, Flavour::Exact).expect("room");
    let source = "
        fn mixed(seed: u32) -> u32 {
            let a = (seed ^ (seed >> 16u)) * 0x85ebca6bu;
            let b = (a ^ (a >> 13u)) * 0xc2b2ae35u;
            return b ^ (b >> 16u);
        }
        // Every sixteenth component has random bits, NaN, infinities and subnormals among them; the others lie in -1..1.
        fn component(seed: u32) -> f32 {
            let bits = mixed(seed);
            let moderate = f32(bitcast<i32>(bits)) / 2147483648.0;
            return select(moderate, bitcast<f32>(bits), (mixed(seed ^ 0x9e3779b9u) & 15u) == 0u);
        }
        fn generate_ray(number: u32) -> CanonicalRay {
            let at = 8u * number;
            let origin = vec3<f32>(component(at), component(at + 1u), component(at + 2u));
            let direction = vec3<f32>(component(at + 3u), component(at + 4u), component(at + 5u));
            return CanonicalRay(origin, -abs(component(at + 6u)), direction, abs(component(at + 7u)));
        }";
    let generator = tracer.ray_generator(source).expect("a text that compiles");
    let rays = generator.generate(RAYS, &[], |_| None).expect("room");
    let hits = tracer.submit(&rays).and_then(|hits| hits.read()).expect("walks that end");
    let walked = hits.iter().filter(|hit| !hit.is_miss()).count();
    println!("{}: {walked} of {RAYS} rays of random bits hit", gpu.adapter());
    assert!(walked > RAYS / 100, "only {walked} rays of random bits hit");
    let triangles = scene.mesh.triangles.len();
    assert!(hits.iter().all(|hit| hit.is_miss() || (hit.primitive as usize) < triangles));
}
