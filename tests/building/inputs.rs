//! Every bad or strange mesh: a typed error, or an octree that verifies and answers as brute force does.

use leafwalk::{BruteForce, BuildError, Builder, Mesh, MeshRef, Octree, Ray, verify_against};
use leafwalk_testing::meshes;
use leafwalk_testing::properties::trace::check_ray;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays;

/// Builds, verifies, and traces hard rays against brute force; returns the octree and how many rays hit.
fn sound(mesh: &Mesh, count: u64) -> (Octree<Vec<u32>>, usize) {
    let octree = Builder::new().step_cost(1.0).build(mesh).expect("a mesh that builds");
    verify_against(&octree, mesh).expect("an octree that verifies");
    let oracle = BruteForce::new(mesh).expect("a mesh that builds");
    let (centre, size) = rays::extent(mesh);
    let mut hits = 0;
    for index in 0..count {
        let ray = rays::hard(mesh, centre, size.max(f32::MIN_POSITIVE), &mut Random::new(41, index));
        check_ray(&octree, &oracle, &ray);
        hits += usize::from(oracle.closest_hit(&ray).is_some());
    }
    (octree, hits)
}

#[test]
fn a_borrowed_mesh_builds_the_same_octree() {
    let mut mesh = meshes::soup(100, 43);
    mesh.material_ids = (0..mesh.triangles.len() as u32).collect();
    let indices: Vec<u32> = mesh.triangles.as_flattened().to_vec();
    let coordinates: Vec<f32> = mesh.positions.as_flattened().to_vec();
    let borrowed = MeshRef::new(bytemuck::cast_slice(&coordinates), bytemuck::cast_slice(&indices))
        .with_material_ids(&mesh.material_ids);
    let octree = Builder::new().build(borrowed).expect("a mesh that builds");
    assert!(octree.as_words() == Builder::new().build(&mesh).expect("a mesh that builds").as_words());
    verify_against(&octree, borrowed).expect("an octree of this mesh");
    assert_eq!(borrowed, MeshRef::from(&mesh));
    let oracle = BruteForce::new(borrowed).expect("a mesh that builds");
    let (centre, size) = rays::extent(&mesh);
    for index in 0..100 {
        check_ray(&octree, &oracle, &rays::hard(&mesh, centre, size, &mut Random::new(44, index)));
    }
}

fn soup_with(edit: impl FnOnce(&mut Mesh)) -> Mesh {
    let mut mesh = meshes::soup(100, 42);
    edit(&mut mesh);
    mesh
}

#[test]
fn vertices_must_be_finite() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let vertex = meshes::soup(100, 42).triangles[50][1];
        let mesh = soup_with(|mesh| mesh.positions[vertex as usize][2] = value);
        let error = Builder::new().build(&mesh).expect_err("a mesh that does not build");
        let BuildError::NonFiniteVertex { vertex: found, position } = error else { panic!("{error}") };
        assert_eq!((found, position[2].to_bits()), (vertex, f64::from(value).to_bits()));

        let octree = Builder::new().lenient().build(&mesh).expect("a mesh that builds");
        let corners = (0..mesh.triangles.len()).map(|i| mesh.corners(i));
        let is_left_out = |[a, b, c]: &[[f32; 3]; 3]| {
            let finite = [a, b, c].into_iter().flatten().all(|c| c.is_finite());
            !finite || a == b || b == c || c == a
        };
        let left_out = corners.filter(is_left_out).count();
        assert!(left_out > 0);
        assert_eq!(octree.stats().dropped as usize, left_out);
        assert_eq!(octree.stats().collapsed, 0);
        verify_against(&octree, &mesh).expect("an octree that verifies");
    }
    // A vertex that no triangle uses may be anything.
    let mesh = soup_with(|mesh| mesh.positions.push([f32::NAN; 3]));
    assert_eq!(
        Builder::new().build(&mesh).expect("a mesh that builds").as_words(),
        Builder::new().build(&soup_with(|_| ())).expect("a mesh that builds").as_words()
    );
}

#[test]
fn indices_must_be_in_range() {
    let vertices = meshes::soup(100, 42).positions.len();
    for index in [vertices as u32, u32::MAX] {
        let mesh = soup_with(|mesh| {
            mesh.triangles[70][2] = index;
            mesh.triangles[80][0] = u32::MAX;
        });
        let expected = BuildError::IndexOutOfRange { triangle: 70, index, vertices };
        assert_eq!(Builder::new().build(&mesh).expect_err("a mesh that does not build"), expected);
        assert_eq!(Builder::new().lenient().build(&mesh).expect_err("a mesh that does not build"), expected);
        assert_eq!(BruteForce::new(&mesh).expect_err("a mesh that does not build"), expected);
    }
}

#[test]
fn material_ids_are_none_or_one_a_triangle() {
    for materials in [1, 99, 101] {
        let mesh = soup_with(|mesh| mesh.material_ids = vec![3; materials]);
        let triangles = mesh.triangles.len();
        if materials != triangles {
            assert_eq!(
                Builder::new().build(&mesh).expect_err("a mesh that does not build"),
                BuildError::MaterialCount { materials, triangles }
            );
        }
    }
    let mesh = soup_with(|mesh| mesh.material_ids = (0..mesh.triangles.len() as u32).rev().collect());
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    assert_eq!(octree.parts().materials, mesh.material_ids);
}

#[test]
fn nothing_to_list_is_an_octree_that_every_ray_misses() {
    let point = [0.5, -2.0, 7.0];
    let meshes = [
        Mesh::default(),
        Mesh::new(vec![point; 5], Vec::new()),
        Mesh::new(vec![point], vec![[0; 3]; 20]),
        Mesh::new(vec![point, [1.0; 3]], vec![[0, 0, 1], [1, 0, 1]]),
    ];
    for mesh in meshes {
        let octree = Builder::new().build(&mesh).expect("a mesh that builds");
        let stats = octree.stats();
        assert_eq!((stats.dropped as usize, stats.blocks), (mesh.triangles.len(), 0));
        assert_eq!(stats.collapsed, 0);
        verify_against(&octree, &mesh).expect("an octree that verifies");
        for index in 0..200 {
            let mut random = Random::new(43, index);
            assert_eq!(octree.closest_hit(&Ray::new(random.vector(), random.direction())), None);
        }
    }
}

#[test]
fn one_triangle_is_one_leaf() {
    let mesh = Mesh::new(vec![[1.0, 2.0, 3.0], [4.0, 2.0, 3.5], [1.0, 6.0, 3.0]], vec![[0, 1, 2]]);
    let (octree, hits) = sound(&mesh, 2000);
    let stats = octree.stats();
    assert_eq!((stats.leaves, stats.blocks), (1, 1));
    assert!(hits > 300, "{hits}");
}

#[test]
fn of_duplicates_the_smallest_primitive_is_hit() {
    let sphere = meshes::icosphere(1);
    let mut mesh = sphere.clone();
    for _ in 0..250 {
        mesh.triangles.extend_from_slice(&sphere.triangles);
    }
    assert!(mesh.triangles.len() > 20_000);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    verify_against(&octree, &mesh).expect("an octree that verifies");
    let single = Builder::new().build(&sphere).expect("a mesh that builds");
    for index in 0..2000 {
        let mut random = Random::new(44, index);
        let ray = Ray::new([0.0; 3], random.direction());
        let hit = octree.closest_hit(&ray).expect("the sphere is closed");
        assert_eq!(Some(hit), single.closest_hit(&ray));
        assert!((hit.primitive as usize) < sphere.triangles.len());
    }
}

#[test]
fn identical_triangles_at_a_point_make_one_fat_leaf() {
    // A far corner makes the rest a point of the scene: some 2^-15 of its extent.
    let mut mesh = Mesh::new(vec![[0.1; 3], [0.100_01, 0.1, 0.1], [0.1, 0.100_01, 0.1]], vec![[0, 1, 2]; 100_000]);
    mesh.positions.extend([[-0.5, -0.5, -0.5], [0.5, -0.5, -0.5], [-0.5, 0.5, 0.5]]);
    mesh.triangles.push([3, 4, 5]);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let stats = octree.stats();
    // A cell that they fit into does not split any further, and few cells lie on the way there.
    assert!(stats.blocks == 12_501 && stats.leaves < 1000, "{stats:?}");
    verify_against(&octree, &mesh).expect("an octree that verifies");
    let hit = octree.closest_hit(&Ray::new([0.100_002, 0.100_002, 1.0], [0.0, 0.0, -1.0])).expect("a hit");
    assert_eq!(hit.primitive, 0);
}

#[test]
fn flat_and_collinear_meshes_are_normal() {
    let flat = |k: usize| {
        let mut mesh = meshes::soup(300, 45);
        mesh.positions.iter_mut().for_each(|p| p[k] = 0.25);
        mesh
    };
    for k in 0..3 {
        let (octree, hits) = sound(&flat(k), 1500);
        assert!(octree.stats().blocks > 0 && hits > 50, "axis {k}: {hits} hits");
    }
    // All corners on one line: every triangle stays, and none is ever hit on its own line.
    for direction in [[1.0, 0.0, 0.0], [1.0, 2.0, -0.5]] {
        let positions: Vec<[f32; 3]> = (0..40).map(|i| direction.map(|c| c * i as f32 / 8.0)).collect();
        let mesh = Mesh::new(positions, (0..38).map(|i| [i, i + 1, i + 2]).collect());
        let (octree, _) = sound(&mesh, 1500);
        assert_eq!(octree.stats().dropped, 0);
    }
}

#[test]
fn huge_and_tiny_extents_only_change_the_scale() {
    for scale in [1.5e38, 1e30, 1e-20, 1e-30, 1e-38] {
        let mesh = meshes::placed(&meshes::soup(200, 46), scale, 0.0);
        assert!(mesh.positions.as_flattened().iter().all(|c| c.is_finite()), "{scale}");
        let octree = Builder::new().step_cost(1.0).build(&mesh).expect("a mesh that builds");
        verify_against(&octree, &mesh).expect("an octree that verifies");
        let oracle = BruteForce::new(&mesh).expect("a mesh that builds");
        let mut hits = 0;
        for index in 0..1500 {
            let mut random = Random::new(47, index);
            let origin = random.vector().map(|c| c * scale);
            let ray = Ray::new(origin, random.direction());
            check_ray(&octree, &oracle, &ray);
            hits += usize::from(octree.closest_hit(&ray).is_some());
        }
        assert!(hits > 50, "scale {scale}: {hits} hits");
    }
    // The largest there is.
    let corner = |x: f32, y: f32, z: f32| [x * f32::MAX, y * f32::MAX, z * f32::MAX];
    let mesh = Mesh::new(vec![corner(-1.0, -1.0, 0.0), corner(1.0, -1.0, 0.0), corner(0.0, 1.0, 0.0)], vec![[0, 1, 2]]);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let hit = octree.closest_hit(&Ray::new([0.0, 0.0, -f32::MAX], [0.0, 0.0, 1.0])).expect("a hit");
    assert_eq!((hit.t, hit.primitive), (f32::MAX, 0));
}

#[test]
fn subnormals_are_numbers() {
    let tiny = f32::from_bits(1);
    let at = |x: f32, y: f32, z: f32| [x * tiny, y * tiny, z * tiny];
    let positions = vec![at(0.0, 0.0, 0.0), at(9e3, 0.0, 50.0), at(-0.0, 9e3, 0.0), at(9e3, 9e3, 9e3)];
    let (octree, hits) = sound(&Mesh::new(positions, vec![[0, 1, 2], [1, 3, 2]]), 1500);
    assert_eq!(octree.stats().dropped, 0);
    assert!(hits > 100, "{hits}");
    // Beside a vertex of ordinary size they are too close to the anchor, and what spans them only collapses.
    let mesh = Mesh::new(
        vec![at(0.0, 0.0, 0.0), at(5.0, 0.0, 0.0), at(0.0, 5.0, 0.0), [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        vec![[0, 1, 2], [0, 3, 4]],
    );
    let (octree, _) = sound(&mesh, 500);
    assert_eq!((octree.stats().dropped, octree.stats().collapsed), (1, 1));
}

#[test]
fn no_detail_is_lost_to_one_far_vertex() {
    let sphere = meshes::icosphere(3);
    let mut mesh = sphere.clone();
    let far = mesh.positions.len() as u32;
    mesh.positions.push([1e9, 0.0, 0.0]);
    mesh.triangles.push([0, 1, far]);
    let octree = Builder::new().build(&mesh).expect("a mesh that builds");
    let stats = octree.stats();
    assert_eq!((stats.collapsed, stats.dropped, octree.parts().header.rounding), (0, 0, 0.0), "{stats:?}");
    verify_against(&octree, &mesh).expect("an octree that verifies");
    let (alone, mut hits) = (Builder::new().build(&sphere).expect("a mesh that builds"), 0);
    for index in 0..1000 {
        let mut random = Random::new(50, index);
        let ray = Ray::new(random.vector().map(|c| 2.0 * c - 3.0), random.vector().map(|c| 0.5 * c + 1.0));
        let (found, expected) = (octree.closest_hit(&ray), alone.closest_hit(&ray));
        if found.is_some_and(|hit| hit.primitive as usize == sphere.triangles.len()) {
            continue;
        }
        assert_eq!(found.map(|hit| hit.primitive), expected.map(|hit| hit.primitive), "{ray:?}");
        if let (Some(found), Some(expected)) = (found, expected) {
            approx::assert_relative_eq!(found.t, expected.t, max_relative = 1e-6);
            hits += 1;
        }
    }
    assert!(hits > 100, "{hits}");
}

#[test]
fn huge_triangles_over_small_cells_stay_within_the_budget() {
    let mut mesh = meshes::walls(400, 48);
    // A clump that deepens the octree where all the walls pass.
    let clump = meshes::placed(&meshes::soup(4000, 49), 1e-3, 0.2);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend_from_slice(&clump.positions);
    mesh.triangles.extend(clump.triangles.iter().map(|triangle| triangle.map(|i| i + first)));
    let octree = Builder::new().step_cost(0.5).build(&mesh).expect("a mesh that builds");
    let verified = verify_against(&octree, &mesh).expect("an octree that verifies");
    assert!(verified.references as usize <= 8 * mesh.triangles.len(), "{verified:?}");
}
