//! `Axis`: what is made harder.

use core::fmt;

use glam::Vec3;
use leafwalk_core::Ray;
use leafwalk_cpu::Mesh;

use crate::random::Random;
use crate::rays::{Target, extent, point_on, towards};
use crate::scenes::{in_sky_box, placed, stretched};

/// What is made harder, step by step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// How far away rays start, in sizes of the mesh.
    Distance,
    /// How large the mesh is.
    Scale,
    /// How far from the origin of coordinates it lies, in sizes.
    Place,
    /// How large the cube is that it stands in, in sizes.
    Extent,
    /// How much longer than wide its triangles are.
    Slivers,
    /// How near surfaces rays start, in sizes: the inverse.
    Nearness,
    /// How nearly rays run along an axis: the inverse of their slope.
    Alignment,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Distance, Self::Scale, Self::Place, Self::Extent, Self::Slivers, Self::Nearness, Self::Alignment];

    /// The steps, from the easiest; scales go both ways from 1.
    pub fn steps(self) -> Vec<f64> {
        let powers = |from: i32, to: i32| (from..=to).map(|power| 10f64.powi(power));
        match self {
            Self::Distance | Self::Extent => powers(0, 8).collect(),
            Self::Scale => powers(-5, 5).map(|scale| scale.powi(3)).collect(),
            Self::Place => powers(0, 7).collect(),
            Self::Slivers => powers(0, 6).collect(),
            Self::Nearness => powers(0, 7).collect(),
            Self::Alignment => powers(0, 10).collect(),
        }
    }

    /// The mesh at a step.
    pub(super) fn scene(self, mesh: &Mesh, step: f64) -> Mesh {
        let (_, size) = extent(mesh);
        let step = step as f32;
        match self {
            Self::Scale => placed(mesh, step, 0.0),
            // The first step is where the mesh is.
            Self::Place => placed(mesh, 1.0, if step > 1.0 { step * size } else { 0.0 }),
            Self::Extent => in_sky_box(mesh, 1.5 * step * size, 0.3),
            Self::Slivers => stretched(mesh, step),
            Self::Distance | Self::Nearness | Self::Alignment => mesh.clone(),
        }
    }

    /// A ray at a step, aimed at the inside, an edge or a vertex of some triangle of the mesh, which lies in the scene of that
    /// step as `scene` gives it, before all that surrounds it.
    pub(super) fn ray(self, scene: &Mesh, mesh: &Mesh, step: f64, random: &mut Random) -> Ray {
        let own = Mesh { triangles: scene.triangles[..mesh.triangles.len()].to_vec(), ..scene.clone() };
        let (centre, size) = extent(&own);
        let (centre, step) = (Vec3::from(centre), step as f32);
        let target = point_on(&own, [Target::Inside, Target::Edge, Target::Vertex][random.below(3)], random);
        let out = Vec3::from(random.direction()).normalize();
        match self {
            Self::Distance => towards((centre + (0.5 + step) * size * out).into(), target),
            Self::Nearness => towards((Vec3::from(target) + size / step * out).into(), target),
            Self::Alignment => {
                let mut direction = out / step;
                direction[random.below(3)] = 1.0;
                let origin = Vec3::from(target) - 2.0 * size * direction;
                Ray::new(origin, direction)
            }
            // From around it, and within.
            _ => towards((centre + 1.2 * random.unit() * size * out).into(), target),
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Distance => "distance of the origin, in sizes",
            Self::Scale => "size",
            Self::Place => "distance from 0, in sizes",
            Self::Extent => "surroundings, in sizes",
            Self::Slivers => "length of triangles, in widths",
            Self::Nearness => "1 / distance of the start, in sizes",
            Self::Alignment => "1 / slope to an axis",
        })
    }
}
