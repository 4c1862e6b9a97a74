//! What a hit primitive looks like, and where rays that leave it start.

use leafwalk::{Hit, Octree};

use super::vector::{Vector, add, cross, dot, scale, sub, unit};
use crate::scene::Material;

/// The corners and materials of all primitives, in the caller's units.
#[derive(Debug)]
pub(crate) struct Surfaces {
    corners: Vec<[[f32; 3]; 3]>,
    material_ids: Vec<u32>,
    materials: Vec<Material>,
    /// Edge of the root cube.
    root_edge: f64,
}

/// A point where a ray met a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Off the surface, on the side that the ray came from: where rays that leave it start.
    pub(crate) lifted: Vector,
    /// Unit normal of the triangle, on that side.
    pub(crate) normal: Vector,
    /// Whether that is the side from which the corners stand counter-clockwise.
    pub(crate) is_front: bool,
    pub(crate) material: Material,
}

/// How far, in root edges, a point is lifted off its triangle, so that no ray from there hits that triangle: 64 u with
/// u = 2^-24.
///
/// A triangle is hit where the ray passes it within 6 u on two axes (`e2` of ARCHITECTURE.md, for origins in the root),
/// at a distance that is wrong by 15 u on the largest of three (`ez`). A ray that leads away from its plane, starting
/// at least sqrt(2) 6 u + sqrt(3) 15 u above it, therefore has t' < 0 there. Rounding the corners and the origin to the
/// lattice adds sqrt(3) u each: 38 u in all.
const LIFT_IN_ROOT_EDGES: f64 = 64.0 / (1 << 24) as f64;
/// The same, in magnitudes of the largest coordinate: 4 u.
///
/// The lifted point is rounded to f32 in the caller's units, and so were the corners: sqrt(3) u each, 3.5 u in all.
const LIFT_IN_COORDINATES: f64 = 4.0 / (1 << 24) as f64;

/// The point of a triangle lifted to the side of its unit normal.
pub(crate) fn lift(point: Vector, normal: Vector, root_edge: f64) -> Vector {
    let largest = point.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    add(point, scale(normal, LIFT_IN_ROOT_EDGES * root_edge + LIFT_IN_COORDINATES * largest))
}

impl Surfaces {
    /// Those that an octree lists. It knows no colours: its material ids are indices into `materials`, and where that
    /// leaves a primitive without, it is neutral.
    pub(crate) fn new<W: AsRef<[u32]>>(octree: &Octree<W>, materials: Vec<Material>) -> Self {
        let parts = octree.parts();
        let mut corners = vec![[[0.0; 3]; 3]; parts.header.primitives as usize];
        for (primitive, lattice) in parts.leaves().flat_map(|(_, leaf)| parts.triangles_of(leaf)) {
            if let Some(corners) = corners.get_mut(primitive as usize) {
                *corners = lattice.map(|corner| parts.frame.to_caller(corner).map(|c| c as f32));
            }
        }
        Self { corners, material_ids: parts.materials.to_vec(), materials, root_edge: parts.frame.scale() }
    }

    pub(crate) fn root_edge(&self) -> f64 {
        self.root_edge
    }

    /// Where a ray of this direction hit; `None` for a miss.
    pub(crate) fn at(&self, hit: &Hit, direction: [f32; 3]) -> Option<Surface> {
        let [a, b, c] = self.corners.get(hit.primitive as usize)?.map(|corner| corner.map(f64::from));
        let (ab, ac) = (sub(b, a), sub(c, a));
        let direction = direction.map(f64::from);
        // A triangle without area is seen edge-on: any normal towards the viewer serves.
        let normal = unit(cross(ab, ac)).or_else(|| unit(scale(direction, -1.0)))?;
        let is_front = dot(normal, direction) <= 0.0;
        let normal = if is_front { normal } else { scale(normal, -1.0) };
        // From the weights, not from t: this point lies in the triangle's plane whatever its distance from the eye.
        let point = add(a, add(scale(ab, f64::from(hit.u)), scale(ac, f64::from(hit.v))));
        let material = self.material_ids.get(hit.primitive as usize).and_then(|id| self.materials.get(*id as usize));
        Some(Surface {
            lifted: lift(point, normal, self.root_edge),
            normal,
            is_front,
            material: material.copied().unwrap_or(Material::NEUTRAL),
        })
    }
}
