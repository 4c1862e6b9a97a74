//! The feature `serde`: what goes through JSON or a binary format comes back with the same bits, infinity, -0 and
//! subnormal numbers included.

use leafwalk::{Aabb, Builder, Hit, HitF64, Mesh, Ray, RayF64, Stats};
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;
use leafwalk_testing::tally::bits;
use serde::Serialize;
use serde::de::DeserializeOwned;

const SUBNORMAL: f32 = f32::from_bits(1);

/// A value after its way through JSON, and after its way through a binary format.
fn round_trips<T: Serialize + DeserializeOwned>(value: &T) -> [T; 2] {
    let json = serde_json::to_string(value).expect("a value that JSON holds");
    let binary = postcard::to_allocvec(value).expect("a value that fits");
    let from_json = serde_json::from_str(&json).unwrap_or_else(|error| panic!("{error} in {json}"));
    [from_json, postcard::from_bytes(&binary).expect("the bytes of a value")]
}

fn check_ray(ray: &Ray) {
    let words = |ray: &Ray| bytemuck::cast::<Ray, [u32; 8]>(*ray);
    for found in round_trips(ray) {
        assert_eq!(words(&found), words(ray), "{found:?} for {ray:?}");
    }
}

fn check_hit(hit: &Hit) {
    for found in round_trips(hit) {
        assert_eq!(bits(&found), bits(hit), "{found:?} for {hit:?}");
    }
}

#[test]
fn rays_and_hits_keep_their_bits() {
    check_ray(&Ray::new([0.1, -0.0, SUBNORMAL], [f32::MIN_POSITIVE, -SUBNORMAL, f32::MAX]));
    check_ray(&Ray::between([f32::NEG_INFINITY, 16_777_217.0, 1e-40], [1.0, 2.0, 3.0], -0.0, f32::INFINITY));
    check_ray(&Ray::between([1.0; 3], [0.0; 3], f32::NEG_INFINITY, -1.5));
    check_hit(&Hit::MISS);
    check_hit(&Hit { t: -0.0, u: SUBNORMAL, v: 1.0 / 3.0, primitive: u32::MAX - 1 });
    for index in 0..20_000 {
        // Any bits but those of NaN, which come back as some NaN.
        let mut random = Random::new(5, index);
        let mut number = || loop {
            let x = f32::from_bits(random.bits());
            if !x.is_nan() {
                return x;
            }
        };
        let [a, b, c, d, e, f, g, h] = core::array::from_fn(|_| number());
        check_ray(&Ray::between([a, b, c], [d, e, f], g, h));
        check_hit(&Hit { t: a, u: b, v: c, primitive: d.to_bits() });
    }
}

#[test]
fn what_is_not_finite_is_a_string_in_json() {
    let ray = Ray::between([f32::NAN, 0.5, -0.0], [1.0, f32::NEG_INFINITY, 0.0], 0.0, f32::INFINITY);
    let json = r#"{"origin":["NaN",0.5,-0.0],"t_min":0.0,"direction":[1.0,"-inf",0.0],"t_max":"inf"}"#;
    assert_eq!(serde_json::to_string(&ray).expect("a value that JSON holds"), json);
    assert!(round_trips(&ray).iter().all(|ray| ray.origin[0].is_nan()));
    let typed = r#"{"origin":[1,-2,3],"t_min":0,"direction":[0,0,1],"t_max":"inf"}"#;
    let ray: Ray = serde_json::from_str(typed).expect("whole numbers");
    assert_eq!(ray, Ray::new([1.0, -2.0, 3.0], [0.0, 0.0, 1.0]));
    let error = serde_json::from_str::<Ray>(&json.replace("\"inf\"", "\"infinite\"")).expect_err("no number");
    assert!(error.to_string().contains(r#"expected a number, "inf", "-inf" or "NaN""#), "{error}");
}

#[test]
fn boxes_statistics_and_meshes_come_back() {
    let mut mesh = meshes::soup(200, 61);
    mesh.material_ids = (0..mesh.triangles.len() as u32).collect();
    mesh.positions.extend([[f32::INFINITY, -0.0, SUBNORMAL], [f32::MAX, f32::NEG_INFINITY, 0.1]]);
    let words = |mesh: &Mesh| -> Vec<u32> { mesh.positions.as_flattened().iter().map(|c| c.to_bits()).collect() };
    for found in round_trips(&mesh) {
        assert_eq!(words(&found), words(&mesh));
        assert_eq!((&found.triangles, &found.material_ids), (&mesh.triangles, &mesh.material_ids));
    }
    let wide = Mesh::new_f64(vec![[4_500_000.001, 5e-324, -0.0], [f64::MAX, f64::NEG_INFINITY, 0.1]], vec![[0, 1, 0]]);
    for found in round_trips(&wide) {
        assert_eq!(found, wide);
        assert!(found.positions[0][2].is_sign_negative());
    }
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let stats: Stats = octree.stats();
    assert_eq!(round_trips(&stats), [stats; 2]);
    let nothing = Aabb { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3] };
    let odd = Aabb { lower: [-0.0, 5e-324, 0.1], upper: [1.0 / 3.0, f64::MAX, 2.225_073_858_507_201e-308] };
    let words = |aabb: &Aabb| [aabb.lower, aabb.upper].map(|corner| corner.map(f64::to_bits));
    for aabb in [octree.bounds(), nothing, odd] {
        for found in round_trips(&aabb) {
            assert_eq!(words(&found), words(&aabb), "{found:?} for {aabb:?}");
        }
    }
}

#[test]
fn rays_and_hits_of_f64_come_back() {
    let ray = RayF64::between([0.1, -0.0, 4_500_000.001], [f64::NEG_INFINITY, 5e-324, 1.0], -1e300, f64::INFINITY);
    let words = |ray: &RayF64| bytemuck::cast::<RayF64, [u64; 8]>(*ray);
    for found in round_trips(&ray) {
        assert_eq!(words(&found), words(&ray));
    }
    for hit in [HitF64::MISS, HitF64 { t: 0.1, u: 0.1, v: 5e-45, primitive: 7 }] {
        assert_eq!(round_trips(&hit), [hit; 2]);
    }
}
