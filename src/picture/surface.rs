//! The surface at a hit: its normal and material, and the point where rays that leave it start.

use glam::{DVec3, Vec3};
use leafwalk::layout::Triangle;
use leafwalk::{Hit, Octree};

use super::vector::unit;
use crate::scene::Material;

/// The corners and materials of all primitives, in the caller's units.
#[derive(Debug)]
pub(crate) struct Surfaces {
    corners: Vec<[Vec3; 3]>,
    material_ids: Vec<u32>,
    materials: Vec<Material>,
    /// The edge of the octree's root cube, in the caller's units.
    root_edge: f64,
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

/// How far, in root edges, a point is lifted off its triangle, so that no ray from there hits that triangle: 64 u with
/// u = 2^-24.
///
/// A triangle is hit where the ray passes it within 6 u on two axes (`e2` of docs/contract.md, for origins in the
/// root), at a distance that is wrong by 15 u on the largest of three (`ez`). A ray that leads away from its plane,
/// starting at least sqrt(2) 6 u + sqrt(3) 15 u above it, therefore has t' < 0 there. Rounding the corners and the
/// origin to the lattice adds sqrt(3) u each: 38 u in all.
const LIFT_IN_ROOT_EDGES: f64 = 64.0 / (1 << 24) as f64;
/// How far a point is lifted besides, in magnitudes of its largest coordinate: 4 u.
///
/// The lifted point is rounded to f32 in the caller's units, and so were the corners: sqrt(3) u each, 3.5 u in all.
const LIFT_IN_COORDINATES: f64 = 4.0 / (1 << 24) as f64;

/// The point of a triangle, lifted off it to the side of its unit normal.
pub(crate) fn lift(point: DVec3, normal: DVec3, root_edge: f64) -> DVec3 {
    let largest = point.abs().max_element();
    point + normal * (LIFT_IN_ROOT_EDGES * root_edge + LIFT_IN_COORDINATES * largest)
}

impl Surfaces {
    /// The surfaces of the primitives that an octree lists. An octree knows no colours: its material ids are indices
    /// into `materials`, and a primitive that has no id, or one beyond them, is neutral.
    pub(crate) fn new<W: AsRef<[u32]>>(octree: &Octree<W>, materials: Vec<Material>) -> Self {
        let parts = octree.parts();
        let mut corners = vec![[Vec3::ZERO; 3]; parts.header.primitives as usize];
        for Triangle { primitive, corners: lattice } in parts.leaves().flat_map(|(_, leaf)| parts.triangles_of(leaf)) {
            if let Some(corners) = corners.get_mut(primitive as usize) {
                *corners = lattice.map(|corner| DVec3::from(parts.frame.to_caller(corner)).as_vec3());
            }
        }
        Self { corners, material_ids: parts.materials.to_vec(), materials, root_edge: parts.frame.scale() }
    }

    pub(crate) fn root_edge(&self) -> f64 {
        self.root_edge
    }

    /// The surface at a hit of a ray of this direction; `None` for a miss.
    pub(crate) fn at(&self, hit: &Hit, direction: [f32; 3]) -> Option<Surface> {
        let [a, b, c] = self.corners.get(hit.primitive as usize)?.map(Vec3::as_dvec3);
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
            lifted: lift(point, normal, self.root_edge),
            normal,
            is_front,
            material: material.copied().unwrap_or(Material::NEUTRAL),
        })
    }
}

#[cfg(test)]
mod tests {
    use leafwalk::{Builder, Mesh, Ray};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    use super::*;

    const TRIANGLES: usize = 300;
    const RAYS: usize = 100;

    /// How many rays that leave a triangle hit it again, for triangles of a size, at coordinates of a magnitude, in a
    /// root of an edge.
    fn self_hits(size: f32, coordinates: f32, root_edge: f32) -> usize {
        let mut generator = ChaCha8Rng::seed_from_u64(14);
        let mut uniform = || generator.next_u32() as f32 / 2f32.powi(31) - 1.0;
        let mut hits = 0;
        for _ in 0..TRIANGLES {
            let centre = [(); 3].map(|()| coordinates * uniform());
            let corner = |uniform: &mut dyn FnMut() -> f32| centre.map(|c| c + size * uniform());
            let corners = [(); 3].map(|()| corner(&mut uniform));
            // A small triangle at the far end makes the root as large as is asked.
            let speck = centre.map(|c| c + root_edge);
            let specks = [speck, [speck[0], speck[1], speck[2] + size], [speck[0], speck[1] + size, speck[2]]];
            let mesh = Mesh::new([corners, specks].concat(), vec![[0, 1, 2], [3, 4, 5]]);
            let octree = Builder::new().build(&mesh).expect("a finite mesh");
            let surfaces = Surfaces::new(&octree, Vec::new());
            for ray in 0..RAYS {
                let weights = [uniform(), uniform()].map(|c| 0.5 + 0.5 * c);
                let [u, v] = if weights[0] + weights[1] > 1.0 { weights.map(|c| 1.0 - c) } else { weights };
                let hit = Hit { t: 1.0, u, v, primitive: 0 };
                let from = [(); 3].map(|()| uniform());
                let Some(surface) = surfaces.at(&hit, from) else { continue };
                // Every other ray leaves along the surface.
                let (s, t) = surface.normal.any_orthonormal_pair();
                let rise = if ray % 2 == 0 { 0.0 } else { f64::from(uniform().abs()) };
                let along = s * f64::from(uniform()) + t * f64::from(uniform());
                let direction = surface.normal * rise + along;
                let spawned = Ray::new(surface.lifted.as_vec3(), direction.as_vec3());
                // Rounding may turn a ray along the surface into one that meets its plane, but only farther away than
                // any triangle here is large.
                let is_hit = octree.closest_hit(&spawned).is_some_and(|hit| hit.primitive == 0);
                let leads_away = surface.normal.dot(Vec3::from(spawned.direction).as_dvec3()) >= 0.0;
                hits += usize::from(is_hit && leads_away && direction.length() > 0.0);
            }
        }
        hits
    }

    #[test]
    fn rays_do_not_hit_the_triangle_that_they_leave() {
        for (size, coordinates, root_edge) in [
            (1.0, 0.0, 1.0),
            (1.0, 0.0, 1e3),
            (1e-3, 0.0, 1e3),
            (1e3, 1e3, 1e3),
            (1e-2, 1e3, 1.0),
            (1.0, 1e5, 10.0),
            (1e3, 1e5, 1e5),
            (1e3, 1e6, 1.0),
        ] {
            assert_eq!(self_hits(size, coordinates, root_edge), 0, "size {size} at {coordinates} in {root_edge}");
        }
    }

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
