//! `Every`: no structure at all.

use super::line::Line;
use super::scene::Scene;
use super::structure::{Search, Structure};

/// Leads each ray past every triangle, in the order of the mesh.
#[derive(Clone, Debug)]
pub struct Every {
    listed: Vec<u32>,
}

impl Structure for Every {
    type Settings = ();
    const COPIES: bool = true;

    fn build(scene: &Scene, (): &()) -> Self {
        Self { listed: (0..scene.len() as u32).collect() }
    }

    fn listed(&self) -> &[u32] {
        &self.listed
    }

    fn visit(&self, _: &Line, search: &mut impl Search) {
        search.test(0..self.listed.len());
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.listed[..])
    }
}
