//! What must not change when the input changes in a way that means nothing.

use leafwalk::{Builder, Hit, Mesh, Octree, Ray};
use leafwalk_testing::differences::hard;
use leafwalk_testing::meshes;
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::hex;
use leafwalk_testing::tally::{bits, scaled, tally};

const RAYS: u64 = 20_000;

fn build(mesh: &Mesh) -> Octree<Vec<u32>> {
    Builder::new().build(mesh).expect("a mesh that builds")
}

/// The original is packed, so that nothing may depend on this either.
fn build_compact(mesh: &Mesh) -> Octree<Vec<u32>> {
    Builder::new().compact().build(mesh).expect("a mesh that builds")
}

/// Checks an answer, given a mesh's octree, a ray and its hit, on hard rays at the mesh.
fn on_hard_rays(name: &str, mesh: &Mesh, seed: u64, fault: impl Fn(&Ray, Option<Hit>) -> Option<String> + Sync) {
    let octree = build(mesh);
    let source = hard(mesh);
    tally(scaled(RAYS), |indices, tally| {
        for index in indices {
            let ray = source(&mut Random::new(seed, index));
            let hit = octree.closest_hit(&ray);
            tally.hit(hit.is_some());
            if let Some(what) = fault(&ray, hit) {
                tally.fault(index, || format!("{what}, where the original gives {hit:?}\n{}", hex(&ray)));
            }
        }
    })
    .passes(name, 0.05);
}

fn differs(found: Option<Hit>, expected: Option<Hit>) -> Option<String> {
    let [found_bits, expected_bits] = [found, expected].map(|hit| bits(&Hit::from(hit)));
    (found_bits != expected_bits).then(|| format!("{found:?}"))
}

#[test]
fn a_scene_scaled_by_a_power_of_two_gives_the_same_bits() {
    let mesh = meshes::soup(500, 111);
    for exponent in [-20, -1, 3, 20] {
        let scale = 2f32.powi(exponent);
        let larger = build_compact(&meshes::placed(&mesh, scale, 0.0));
        // Subnormal numbers lose bits by scaling.
        let is_exact = |x: &f32| *x == 0.0 || (x * scale).is_normal() && x.is_normal();
        on_hard_rays(&format!("scene x 2^{exponent}"), &mesh, 111, |ray, hit| {
            if !ray.origin.iter().chain(&ray.direction).all(is_exact) {
                return None;
            }
            // Ray and scene: t stays. The scene alone: t is scaled.
            let origin = ray.origin.map(|c| c * scale);
            let along = Ray { origin, direction: ray.direction.map(|c| c * scale), ..*ray };
            let across = Ray { origin, t_min: ray.t_min * scale, t_max: ray.t_max * scale, ..*ray };
            let scaled = hit.map(|hit| Hit { t: hit.t * scale, ..hit });
            differs(larger.closest_hit(&along), hit).or(differs(larger.closest_hit(&across), scaled))
        });
    }
}

#[test]
fn triangles_in_another_order_give_the_same_point() {
    let mesh = meshes::soup(500, 112);
    let count = mesh.triangles.len();
    // A permutation: new place -> old place.
    let mut old: Vec<usize> = (0..count).collect();
    let mut random = Random::new(112, 0);
    (1..count).for_each(|i| old.swap(i, random.below(i + 1)));
    let shuffled = Mesh::new(mesh.positions.clone(), old.iter().map(|&i| mesh.triangles[i]).collect());
    let octree = build_compact(&shuffled);
    let alone: Vec<Octree<Vec<u32>>> = (0..count).map(|i| framed(&mesh, &[i])).collect();
    on_hard_rays("triangles in another order", &mesh, 112, |ray, hit| {
        let found = octree.closest_hit(ray);
        let mapped = found.map(|hit| Hit { primitive: old[hit.primitive as usize] as u32, ..hit });
        let what = differs(mapped, hit)?;
        // Of triangles at the same distance another one may come first now.
        let (Some(mapped), Some(hit)) = (mapped, hit) else { return Some(what) };
        let same = |hit: Hit| alone[hit.primitive as usize].closest_hit(ray).map(|alone| alone.t);
        let is_tie = same(mapped).is_some() && same(mapped) == same(hit);
        let first = found.is_some_and(|found| found.primitive < position(&old, hit.primitive));
        (!is_tie || !first).then_some(what)
    });
}

fn position(old: &[usize], primitive: u32) -> u32 {
    old.iter().position(|&i| i as u32 == primitive).map_or(u32::MAX, |i| i as u32)
}

/// Some of the triangles of a mesh, as primitives 0, 1 and so on, in the frame of all.
fn framed(mesh: &Mesh, primitives: &[usize]) -> Octree<Vec<u32>> {
    let used = || mesh.triangles.iter().flatten().map(|i| mesh.positions[*i as usize]);
    let reach = |pick: fn(f32, f32) -> f32| {
        used().reduce(|a, b| core::array::from_fn(|k| pick(a[k], b[k]))).expect("triangles")
    };
    let (lower, upper) = (reach(f32::min), reach(f32::max));
    let next = mesh.positions.len() as u32;
    let mut part = Mesh::new(mesh.positions.clone(), primitives.iter().map(|&i| mesh.triangles[i]).collect());
    // Two corners are equal: the triangle is dropped, but extends the frame.
    part.positions.extend([lower, upper]);
    part.triangles.push([next, next + 1, next]);
    build(&part)
}

#[test]
fn the_first_of_equal_triangles_is_hit() {
    let mesh = meshes::soup(300, 113);
    let repeat = |i: &[u32; 3]| [*i; 3];
    let tripled = build_compact(&Mesh::new(mesh.positions.clone(), mesh.triangles.iter().flat_map(repeat).collect()));
    on_hard_rays("every triangle three times", &mesh, 113, |ray, hit| {
        let first = hit.map(|hit| Hit { primitive: 3 * hit.primitive, ..hit });
        differs(tripled.closest_hit(ray), first)
    });
}

#[test]
fn a_scene_in_two_parts_gives_the_nearer_of_two_hits() {
    let mesh = meshes::soup(500, 114);
    let half = mesh.triangles.len() / 2;
    let (low, high): (Vec<usize>, Vec<usize>) = (0..mesh.triangles.len()).partition(|i| *i < half);
    let (low, high) = (framed(&mesh, &low), framed(&mesh, &high));
    on_hard_rays("a scene in two parts", &mesh, 114, |ray, hit| {
        let a = low.closest_hit(ray);
        let b = high.closest_hit(ray).map(|hit| Hit { primitive: hit.primitive + half as u32, ..hit });
        // The reported t of a ray from afar may be the same for hits of different t'.
        let is_candidate = [a, b].into_iter().any(|part| differs(part, hit).is_none());
        let nearest = [a, b].into_iter().flatten().map(|hit| hit.t).reduce(f32::min);
        (!is_candidate || nearest != hit.map(|hit| hit.t)).then(|| format!("{a:?} and {b:?}"))
    });
}

#[test]
fn geometry_far_from_a_ray_changes_nothing() {
    let mesh = meshes::soup(500, 115);
    let (lower, upper) = (-4.0, 4.0);
    // In a frame that already reaches that far, specks behind all rays.
    let mut framing = mesh.clone();
    let next = framing.positions.len() as u32;
    framing.positions.extend([[lower; 3], [upper; 3]]);
    framing.triangles.push([next, next + 1, next]);
    let mut crowded = framing.clone();
    for i in 0..500 {
        let mut random = Random::new(116, i);
        let corner = |random: &mut Random| [3.5 + 0.4 * random.unit(), 4.0 * random.signed(), 4.0 * random.signed()];
        let next = crowded.positions.len() as u32;
        crowded.positions.extend([corner(&mut random), corner(&mut random), corner(&mut random)]);
        crowded.triangles.push([next, next + 1, next + 2]);
    }
    let crowded = build_compact(&crowded);
    let mut hits = 0;
    let octree = build(&framing);
    for index in 0..RAYS {
        let mut random = Random::new(117, index);
        let mut direction = random.direction();
        direction[0] = -direction[0].abs();
        let ray = Ray::new(random.vector(), direction);
        let hit = octree.closest_hit(&ray);
        hits += u32::from(hit.is_some());
        assert_eq!(differs(crowded.closest_hit(&ray), hit), None, "{hit:?}\n{}", hex(&ray));
    }
    assert!(hits > 1000, "{hits} hits test too little");
}
