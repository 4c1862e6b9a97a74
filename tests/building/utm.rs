//! Meshes of f64: a wall in UTM coordinates, of which f32 keeps half metres.

use leafwalk::{
    BruteForce, BuildError, Builder, CpuTracer, Hit, HitF64, Mesh, Octree, Ray, RayF64, Tracer, VerifyError,
    verify_against,
};
use leafwalk_core::contract::ROUNDOFF;
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;
use leafwalk_testing::utm::{SIDE, at_wall, wall};

const RAYS: u64 = 4_000;

fn ray(index: u64) -> RayF64 {
    at_wall(&mut Random::new(82, index))
}

fn build(mesh: &Mesh<f64>) -> Octree<Vec<u32>> {
    Builder::new().build(mesh).expect("a mesh that builds")
}

/// What all tracers of f64 answer.
fn answers(mesh: &Mesh<f64>, rays: &[RayF64]) -> Vec<HitF64> {
    let octree = build(mesh);
    let oracle = BruteForce::new(mesh).expect("a mesh that builds");
    let compact = Builder::for_walks().compact().build(mesh).expect("a mesh that builds");
    let tracers = [CpuTracer::new(octree.view()), CpuTracer::new(compact.view())];
    let expected: Vec<_> = rays.iter().map(|ray| HitF64::from(oracle.closest_hit_f64(ray))).collect();
    for tracer in &tracers {
        let (mut hits, mut occluded) = (vec![HitF64::MISS; rays.len()], vec![false; rays.len()]);
        tracer.closest_hits_f64(rays, &mut hits).expect("equal lengths");
        tracer.occlusions_f64(rays, &mut occluded).expect("equal lengths");
        for (i, ray) in rays.iter().enumerate() {
            let octree = tracer.octree();
            let found = [hits[i].ok(), tracer.closest_hit_f64(ray), octree.closest_hit_f64(ray)];
            assert_eq!(found, [expected[i].ok(); 3], "{ray:?}");
            let is_hit = !expected[i].is_miss();
            assert_eq!([occluded[i], tracer.occluded_f64(ray), octree.occluded_f64(ray)], [is_hit; 3], "{ray:?}");
        }
    }
    expected
}

#[test]
fn every_way_gives_one_answer() {
    let rays: Vec<_> = (0..RAYS).map(ray).collect();
    let hits = answers(&wall(0.05), &rays).iter().filter(|hit| !hit.is_miss()).count();
    assert!((1_500..3_500).contains(&hits), "{hits} hits");
}

#[test]
fn limits_hold_in_f64() {
    let mesh = wall(0.05);
    let octree = build(&mesh);
    let mut hits = 0;
    for ray in (0..200).map(ray) {
        let Some(hit) = octree.closest_hit_f64(&ray) else { continue };
        hits += 1;
        let between = |t_min: f64, t_max: f64| octree.closest_hit_f64(&RayF64 { t_min, t_max, ..ray });
        assert_eq!(between(hit.t.next_down(), hit.t.next_up()), Some(hit));
        assert_eq!(between(0.0, hit.t), None);
        assert!(between(hit.t, f64::INFINITY).is_none_or(|next| next.t > hit.t));
    }
    assert!(hits > 50, "{hits} hits");
}

/// Rays of f32 at such a mesh, whether the frame's anchor is a number of f32 or not.
#[test]
fn rays_of_f32_find_the_same_whoever_traces_them() {
    let near = 1e6 + 3e-5;
    let corners = [[near, near, near], [near + 1e-5, near, near + 1e-5], [near, near + 1e-5, near + 1e-5]];
    let speck = Mesh::new_f64(corners.to_vec(), vec![[0, 1, 2]]);
    let at_speck = |index: u64| {
        let mut random = Random::new(83, index);
        let slope = |x: f32| 3e-5 + 1e-5 * x;
        Ray::new([999_999.0, 1e6, 1e6], [1.0, slope(random.unit()), slope(random.unit())])
    };
    let at_wall = |index: u64| {
        let RayF64 { origin, direction, .. } = ray(index);
        Ray::new(origin.map(|c| c as f32), direction.map(|c| c as f32))
    };
    let cases: [(_, bool, &dyn Fn(u64) -> Ray); 3] =
        [(wall(0.05), false, &at_wall), (wall(1.0), true, &at_wall), (speck, false, &at_speck)];
    for (mesh, is_f32, ray) in cases {
        let octree = build(&mesh);
        let anchor = octree.frame().anchor;
        assert_eq!(anchor.iter().all(|c| f64::from(*c as f32) == *c), is_f32, "{anchor:?}");
        let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
        let tracer = CpuTracer::new(octree.view());
        let rays: Vec<_> = (0..500).map(ray).collect();
        let mut hits = [Hit::MISS; 500];
        tracer.closest_hits(&rays, &mut hits).expect("equal lengths");
        for (ray, hit) in rays.iter().zip(hits) {
            let expected = oracle.closest_hit(ray);
            assert_eq!([hit.ok(), tracer.closest_hit(ray), octree.closest_hit(ray)], [expected; 3], "{ray:?}");
            let wide = octree.closest_hit_f64(&(*ray).into());
            assert_eq!(wide.map(Hit::from), expected, "{ray:?}");
        }
        let hits = hits.iter().filter(|hit| !hit.is_miss()).count();
        assert!(hits > 50, "{hits} hits");
    }
}

#[test]
fn vertices_of_f64_are_rounded_once_and_the_header_says_how_far() {
    let mesh = wall(0.05);
    let octree = build(&mesh);
    let header = octree.parts().header;
    let moved = f64::from(header.rounding) * octree.frame().scale() / 65536.0;
    assert!(moved > 0.0 && moved <= f64::from(ROUNDOFF) * SIDE, "{moved} m");
    assert_eq!(header.collapsed, 0);
    verify_against(&octree, &mesh).expect("an octree of this mesh");

    let rounded = mesh.positions.iter().map(|position| position.map(|c| c as f32)).collect();
    let rounded = Mesh::new(rounded, mesh.triangles.clone());
    let error = verify_against(&octree, &rounded).expect_err("another mesh");
    assert!(matches!(error, VerifyError::OtherMesh { .. }), "{error}");
    let mut nudged = mesh;
    nudged.positions[700][1] += 1e-5;
    let error = verify_against(&octree, &nudged).expect_err("another mesh");
    assert!(matches!(error, VerifyError::OtherMesh { what: "corners", .. }), "{error}");
}

#[test]
fn a_mesh_of_f64_that_f32_holds_builds_the_same_octree() {
    let wide = |mesh: &Mesh| Mesh {
        positions: mesh.positions.iter().map(|position| position.map(f64::from)).collect(),
        triangles: mesh.triangles.clone(),
        material_ids: mesh.material_ids.clone(),
    };
    let soup = meshes::soup(300, 84);
    for mesh in [meshes::placed(&soup, 1e-3, 1e6), meshes::placed(&soup, 1e-40, 0.0), soup] {
        let expected = Builder::new().build(&mesh).expect("a mesh that builds");
        assert!(build(&wide(&mesh)).as_words() == expected.as_words());
        verify_against(&expected, &wide(&mesh)).expect("an octree of this mesh");
    }
}

#[test]
fn vertices_of_f64_must_be_within_the_range_of_f32() {
    for value in [f64::NAN, f64::NEG_INFINITY, 1e300, -f64::from(f32::MAX).next_up()] {
        let mut mesh = wall(0.05);
        mesh.positions[7][2] = value;
        let error = Builder::new().build(&mesh).expect_err("a mesh that does not build");
        let BuildError::NonFiniteVertex { vertex: 7, position } = error else { panic!("{error}") };
        assert_eq!(position[2].to_bits(), value.to_bits());
        let octree = Builder::new().lenient().build(&mesh).expect("a mesh that builds");
        assert!((1..=6).contains(&octree.stats().dropped));
        verify_against(&octree, &mesh).expect("an octree of this mesh");
    }
}
