//! Meshes with what traces them; the real ones are loaded once for all tests.

use std::sync::OnceLock;

use leafwalk::{BruteForce, Builder, Mesh, Octree};

/// A mesh's octrees, and its oracle.
pub(crate) struct Scene {
    pub(crate) octree: Octree<Vec<u32>>,
    /// The same, compact.
    pub(crate) compact: Octree<Vec<u32>>,
    pub(crate) brute_force: BruteForce,
}

impl Scene {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let build = |builder: Builder| builder.build(mesh).expect("a mesh that builds");
        let (octree, compact) = (build(Builder::new()), build(Builder::new().compact()));
        Self { octree, compact, brute_force: BruteForce::new(mesh).expect("the same mesh") }
    }
}

type Real = OnceLock<(Mesh, Scene)>;

/// The dragon: 871,414 small triangles, closed.
pub(crate) fn dragon(purpose: &str) -> Option<&'static (Mesh, Scene)> {
    static DRAGON: Real = Real::new();
    load(&DRAGON, "dragon.ply.gz", purpose)
}

/// The conference room: large triangles among small ones.
pub(crate) fn conference(purpose: &str) -> Option<&'static (Mesh, Scene)> {
    static CONFERENCE: Real = Real::new();
    load(&CONFERENCE, "conference.obj.gz", purpose)
}

#[cfg(feature = "mesh-files")]
fn load(cache: &'static Real, file: &str, purpose: &str) -> Option<&'static (Mesh, Scene)> {
    let path = leafwalk_testing::scenes::real(file, purpose)?;
    Some(cache.get_or_init(|| {
        let mesh = leafwalk::load_mesh(&path).expect("a readable scene").mesh.into_f32();
        let scene = Scene::new(&mesh);
        (mesh, scene)
    }))
}

#[cfg(not(feature = "mesh-files"))]
fn load(_: &'static Real, file: &str, purpose: &str) -> Option<&'static (Mesh, Scene)> {
    println!("skipped: {purpose}: {file} takes the feature mesh-files");
    None
}
