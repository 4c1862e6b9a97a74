//! The same bytes for any number of threads.

use leafwalk::{Builder, Mesh};
use leafwalk_testing::meshes;

fn words(builder: &Builder, mesh: &Mesh, threads: usize) -> Vec<u32> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
    pool.install(|| builder.build(mesh)).expect("a mesh that builds").into_words()
}

#[test]
fn threads_do_not_change_a_word() {
    let tight = Builder::new().step_cost(0.5).reference_budget(1.5);
    let meshes = [
        ("soup", meshes::soup(6000, 31)),
        ("needle box", meshes::needle_box(40)),
        ("walls", meshes::walls(1500, 32)),
        ("sphere", meshes::icosphere(5)),
    ];
    for (name, mesh) in meshes {
        for builder in [Builder::new(), Builder::new().step_cost(1.0), tight.clone()] {
            let expected = words(&builder, &mesh, 1);
            for threads in [2, 3, 8] {
                assert!(words(&builder, &mesh, threads) == expected, "{name} on {threads} threads");
            }
            assert!(words(&builder, &mesh, 2) == expected, "{name} built again");
        }
    }
}
