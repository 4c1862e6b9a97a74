//! `Input`: what a mesh gives to a structure and to a triangle test.

use glam::Vec3;
use leafwalk_core::Frame;
use leafwalk_core::contract::BOX_MARGIN;

use super::scene::Scene;
use crate::{BruteForce, BuildError, MeshRef, testing};

/// A mesh in one of the two ways of handling rounding.
pub(super) struct Input {
    pub(super) scene: Scene,
    /// What rays are brought into, if that is the lattice.
    pub(super) frame: Option<Frame>,
    /// The corners that the triangle test gets, and the primitives, in the order of the scene.
    pub(super) corners: Vec<[[f32; 3]; 3]>,
    pub(super) primitives: Vec<u32>,
}

impl Input {
    /// On the lattice, with margins.
    pub(super) fn conservative(mesh: MeshRef<'_>) -> Result<Self, BuildError> {
        let oracle = BruteForce::new(mesh)?;
        let (frame, triangles) = (*testing::frame(&oracle), testing::triangles(&oracle));
        let corners: Vec<_> = triangles.iter().map(|triangle| triangle.corners).collect();
        let within = corners.iter().map(|corners| corners.map(|corner| frame.to_root(corner).into())).collect();
        Ok(Self {
            scene: Scene { corners: within, margin: BOX_MARGIN },
            frame: Some(frame),
            corners,
            primitives: triangles.iter().map(|triangle| triangle.primitive).collect(),
        })
    }

    /// In the caller's numbers, rounded to f32, without margins.
    pub(super) fn as_published(mesh: MeshRef<'_>) -> Result<Self, BuildError> {
        let oracle = BruteForce::new(mesh)?;
        let primitives: Vec<u32> = testing::triangles(&oracle).iter().map(|triangle| triangle.primitive).collect();
        let corners_of = |primitive: &u32| mesh.corners(*primitive as usize).map(|corner| corner.map(|c| c as f32));
        let corners: Vec<[[f32; 3]; 3]> = primitives.iter().map(corners_of).collect();
        let within = corners.iter().map(|corners| corners.map(Vec3::from)).collect();
        Ok(Self { scene: Scene { corners: within, margin: 0.0 }, frame: None, corners, primitives })
    }
}
