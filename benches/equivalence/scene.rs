//! Scenes with their rays, and what the scalar walk answers.

use std::path::PathBuf;

use leafwalk::{Builder, Hit, Mesh, Octree, Ray, Walk};
use leafwalk_testing::random::Random;
use leafwalk_testing::rays::{self, Shared};
use leafwalk_testing::scenes;
use leafwalk_testing::workloads::{self, Workload};

use crate::fail;

/// Seeds of the rays that are aimed.
const HARD: u64 = 1;
const COHERENT: u64 = 2;

/// A mesh with its octrees.
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) mesh: Mesh,
    pub(crate) octree: Octree<Vec<u32>>,
    pub(crate) compact: Octree<Vec<u32>>,
    /// Seen from inside, as a room is.
    inside: bool,
    /// Made of healthy triangles only.
    #[cfg_attr(not(feature = "gpu"), allow(dead_code, reason = "only what GPUs promise depends on it"))]
    pub(crate) is_ordinary: bool,
}

impl Scene {
    fn new(name: &str, mesh: Mesh, inside: bool) -> Self {
        let build = |builder: Builder| builder.build(&mesh).unwrap_or_else(|error| fail(&format!("{name}: {error}")));
        let (octree, compact) = (build(Builder::new()), build(Builder::new().compact()));
        Self { name: name.to_owned(), is_ordinary: name == scenes::ORDINARY, mesh, octree, compact, inside }
    }

    /// The scenes of these mesh files, each loaded when its turn comes; without files, the scenes made in code.
    pub(crate) fn all(outside: &[PathBuf], inside: &[PathBuf]) -> Box<dyn Iterator<Item = Self>> {
        if outside.is_empty() && inside.is_empty() {
            return Box::new(scenes::made().into_iter().map(|(name, mesh)| Self::new(name, mesh, false)));
        }
        let outside = outside.iter().map(|path| (path.clone(), false));
        let files: Vec<_> = outside.chain(inside.iter().map(|path| (path.clone(), true))).collect();
        Box::new(files.into_iter().map(|(path, inside)| {
            let loaded = leafwalk::load_mesh(&path);
            let mesh = loaded.unwrap_or_else(|error| fail(&format!("{}: {error}", path.display()))).mesh.into_f32();
            Self::new(&scenes::name_of(&path), mesh, inside)
        }))
    }

    /// The rays that benches measure with, P, S, D and R; and those aimed at vertices and edges, from everywhere (H) and in
    /// runs that make tiles (T). Kinds without a ray are left out: a scene may be too small to be seen.
    pub(crate) fn workloads(&self, side: u32) -> Vec<Workload> {
        let Self { octree, mesh, inside, .. } = self;
        let (count, (centre, size)) = (u64::from(side).pow(2), rays::extent(mesh));
        let coherent = |i: u64| {
            let shares = Shared::ALL[(i / rays::RUN) as usize % Shared::ALL.len()];
            rays::coherent(shares, mesh, centre, size, &mut Random::new(COHERENT, i))
        };
        let hard = rays::hard_and_cut(octree, mesh, count, HARD);
        let mut workloads = workloads::all(octree, mesh, *inside, side);
        workloads.push(Workload { name: "H", rays: hard, is_occlusion: false });
        workloads.push(Workload { name: "T", rays: (0..count).map(coherent).collect(), is_occlusion: false });
        workloads.retain(|workload| !workload.rays.is_empty());
        workloads
    }
}

/// What the scalar walk answers to rays, and the cells that it visits.
pub(crate) struct Expected {
    pub(crate) hits: Vec<Hit>,
    pub(crate) cells: Vec<u32>,
}

impl Expected {
    pub(crate) fn new(octree: &Octree<Vec<u32>>, rays: &[Ray]) -> Self {
        let parts = octree.parts();
        let walked = rays.iter().map(|ray| Walk::new(&parts).closest_hit_with_work(ray));
        let (hits, cells) = walked.map(|(hit, work)| (Hit::from(hit), work.cells)).unzip();
        Self { hits, cells }
    }
}
