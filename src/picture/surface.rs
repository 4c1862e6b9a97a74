//! The surface at a hit: its normal and material, and the point where rays that leave it start.

use glam::{DVec3, Vec3};
use leafwalk::layout::Triangle;
use leafwalk::{Frame, Hit, Octree};

use super::vector::unit;
use crate::scene::Material;

/// The corners and materials of all primitives, in the caller's units.
#[derive(Debug)]
pub(crate) struct Surfaces {
    corners: Vec<[Vec3; 3]>,
    material_ids: Vec<u32>,
    materials: Vec<Material>,
    /// How large the octree is decides how far points are lifted.
    frame: Frame,
}

/// A point where a ray met a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// The point where rays that leave the surface start: a little off it, on the side that the ray came from.
    pub(crate) lifted: DVec3,
    /// The unit normal of the triangle on the side that the ray came from.
    pub(crate) normal: DVec3,
    /// Whether that side is the triangle's front, from which its corners stand counter-clockwise.
    pub(crate) is_front: bool,
    pub(crate) material: Material,
}

/// The point of a triangle, lifted off it to the side of its unit normal, as far as [`Hit::spawn`] lifts the origins of
/// rays.
pub(crate) fn lift(point: DVec3, normal: DVec3, corners: &[Vec3; 3], frame: &Frame) -> DVec3 {
    point + normal * frame.clearance(&corners.map(|corner| corner.to_array()), point.to_array())
}

impl Surfaces {
    /// The surfaces of the primitives that an octree lists. An octree knows no colours: its material ids are indices
    /// into `materials`, and a primitive that has no id, or one beyond them, is neutral.
    pub(crate) fn new<W: AsRef<[u32]>>(octree: &Octree<W>, materials: Vec<Material>) -> Self {
        let parts = octree.parts();
        let mut corners = vec![[Vec3::ZERO; 3]; parts.header.primitives as usize];
        for Triangle { primitive, corners: lattice } in parts.triangles() {
            if let Some(corners) = corners.get_mut(primitive as usize) {
                *corners = lattice.map(|corner| DVec3::from(parts.frame.to_caller(corner)).as_vec3());
            }
        }
        Self { corners, material_ids: parts.materials.to_vec(), materials, frame: parts.frame }
    }

    pub(crate) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The surface at a hit of a ray of this direction; `None` for a miss.
    pub(crate) fn at(&self, hit: &Hit, direction: [f32; 3]) -> Option<Surface> {
        let corners = self.corners.get(hit.primitive as usize)?;
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let direction = Vec3::from(direction).as_dvec3();
        // A triangle without area is seen edge-on, so any normal towards the viewer serves.
        let normal = unit(ab.cross(ac)).or_else(|| unit(-direction))?;
        let is_front = normal.dot(direction) <= 0.0;
        let normal = if is_front { normal } else { -normal };
        // The point is made of the weights, not of t, so that it lies in the triangle's plane however far from the eye.
        let point = a + (ab * f64::from(hit.u) + ac * f64::from(hit.v));
        let material = self.material_ids.get(hit.primitive as usize).and_then(|id| self.materials.get(*id as usize));
        Some(Surface {
            lifted: lift(point, normal, corners, &self.frame),
            normal,
            is_front,
            material: material.copied().unwrap_or(Material::NEUTRAL),
        })
    }
}

#[cfg(test)]
mod tests {
    use leafwalk::{Builder, Mesh};

    use super::*;

    #[test]
    fn surfaces_face_the_viewer_and_know_their_material() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 5.0]];
        let mut mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 1, 3]]);
        mesh.material_ids = vec![1, 7];
        let octree = Builder::new().build(&mesh).expect("a finite mesh");
        let red = Material::matt(1.0, 0.0, 0.0);
        let surfaces = Surfaces::new(&octree, vec![Material::NEUTRAL, red]);
        let hit = Hit { t: 1.0, u: 0.25, v: 0.5, primitive: 0 };
        for (z, is_front) in [(-1.0, true), (1.0, false)] {
            let surface = surfaces.at(&hit, [0.0, 0.0, z]).expect("a hit");
            assert_eq!(surface.normal, DVec3::new(0.0, 0.0, -f64::from(z)));
            assert_eq!((surface.is_front, surface.material), (is_front, red));
            let offset = surface.lifted - DVec3::new(0.25, 0.5, 0.0);
            assert!(offset.dot(surface.normal) > 0.0 && offset.length() < 1e-4, "lifted by {offset:?}");
        }
        let unknown = surfaces.at(&Hit { primitive: 1, ..hit }, [0.0, 1.0, 0.0]).expect("a hit");
        assert_eq!(unknown.material, Material::NEUTRAL);
        assert!(surfaces.at(&Hit::MISS, [0.0, 0.0, 1.0]).is_none());
    }
}
