//! The default scene: a closed room with coloured walls, a square light, and shapes that `shapes` makes.

pub(crate) mod shapes;

use glam::{DVec3, Vec3};
use leafwalk::Mesh;

use crate::camera::View;
use crate::picture::vector::{mix, unit};
use shapes::{Shape, bumpy_sphere};

/// How a surface reflects and shines, in linear red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Material {
    /// Diffuse reflectance, 0 to 1.
    pub(crate) diffuse: Vec3,
    /// Emitted radiance.
    pub(crate) emission: Vec3,
}

impl Material {
    /// The material of a surface that was given none.
    pub(crate) const NEUTRAL: Self = Self::matt(0.6, 0.6, 0.6);

    /// A surface that reflects in all directions alike and does not shine.
    pub(crate) const fn matt(red: f32, green: f32, blue: f32) -> Self {
        Self { diffuse: Vec3::new(red, green, blue), emission: Vec3::ZERO }
    }
}

/// A parallelogram that shines to the side of its normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    pub(crate) corner: DVec3,
    pub(crate) edges: [DVec3; 2],
    /// Emitted radiance.
    pub(crate) radiance: DVec3,
}

impl Light {
    /// The point at two coordinates along the edges, each from 0 to 1.
    pub(crate) fn point(&self, [a, b]: [f64; 2]) -> DVec3 {
        self.corner + (self.edges[0] * a + self.edges[1] * b)
    }

    /// The unit normal on the side that shines.
    /// Half of it: one of the triangles that it is made of.
    pub(crate) fn triangle(&self) -> [Vec3; 3] {
        [DVec3::ZERO, self.edges[0], self.edges[1]].map(|from_corner| (self.corner + from_corner).as_vec3())
    }

    pub(crate) fn normal(&self) -> DVec3 {
        unit(self.spanned()).unwrap_or_default()
    }

    pub(crate) fn area(&self) -> f64 {
        self.spanned().length()
    }

    /// The share of its radiance, from 0 to 1, that a white matt surface reflects when nothing is in between: the form
    /// factor of a polygon, by Lambert's formula (J. H. Lambert, Photometria, 1760).
    pub(crate) fn form_factor(&self, point: DVec3, normal: DVec3) -> f64 {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|place| self.point(place) - point);
        if self.normal().dot(corners[0]) >= 0.0 {
            return 0.0;
        }
        let height = corners.map(|corner| normal.dot(corner));
        // The corners above the surface's horizon, and the points where edges cross it.
        let above = (0..4).flat_map(|k| {
            let next = (k + 1) % 4;
            let crosses = (height[k] > 0.0) != (height[next] > 0.0);
            let crossing = crosses.then(|| mix(corners[k], corners[next], height[k] / (height[k] - height[next])));
            (height[k] > 0.0).then_some(corners[k]).into_iter().chain(crossing)
        });
        let above: Vec<DVec3> = above.filter_map(unit).collect();
        let edges = above.iter().zip(above.iter().cycle().skip(1));
        let sum: f64 = edges
            .map(|(a, b)| {
                let across = a.cross(*b);
                let sine = across.length();
                if sine > 0.0 { sine.atan2(a.dot(*b)) * normal.dot(across) / sine } else { 0.0 }
            })
            .sum();
        sum.abs() / core::f64::consts::TAU
    }

    fn spanned(&self) -> DVec3 {
        self.edges[0].cross(self.edges[1])
    }
}

/// A mesh with its materials, a light that is part of the mesh, and where to look from.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    /// Its material ids are indices into `materials`.
    pub(crate) mesh: Mesh,
    pub(crate) materials: Vec<Material>,
    pub(crate) light: Light,
    pub(crate) view: View,
}

/// How finely the shapes are tessellated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Detail {
    /// Divisions of the bumpy sphere's icosahedron.
    pub(crate) bumpy: u32,
    /// Divisions of the smooth sphere's icosahedron.
    pub(crate) smooth: u32,
    /// Segments along the knot, and sides of its tube.
    pub(crate) knot: [u32; 2],
}

impl Detail {
    /// The facets are about as large as a pixel in a picture of the default size.
    pub(crate) const FULL: Self = Self { bumpy: 6, smooth: 5, knot: [640, 72] };
}

const ROOM: [DVec3; 2] = [DVec3::new(-1.35, 0.0, -1.3), DVec3::new(1.35, 2.0, 2.6)];
/// How far shapes stand above what carries them, so that no surfaces touch.
const GAP: f64 = 1e-3;

const WHITE: Material = Material::matt(0.76, 0.75, 0.72);
const RED: Material = Material::matt(0.66, 0.07, 0.05);
const GREEN: Material = Material::matt(0.13, 0.46, 0.10);
const CLAY: Material = Material::matt(0.80, 0.42, 0.22);
const TEAL: Material = Material::matt(0.08, 0.40, 0.48);
const GOLD: Material = Material::matt(0.85, 0.60, 0.16);
const STONE: Material = Material::matt(0.62, 0.62, 0.66);

impl Scene {
    /// The room and what stands in it.
    pub(crate) fn room(detail: Detail) -> Self {
        let light = Light {
            corner: DVec3::new(-0.42, ROOM[1].y - 5.0 * GAP, -0.6),
            edges: [0.84 * DVec3::X, 0.84 * DVec3::Z],
            radiance: DVec3::new(15.0, 13.2, 10.8),
        };
        let mut scene = Self {
            mesh: Mesh::default(),
            materials: Vec::new(),
            light,
            view: View { eye: DVec3::new(0.0, 1.06, 2.55), at: DVec3::new(0.0, 0.93, 0.0), up: View::UP, fov: 48.0 },
        };
        scene.add_walls();
        let shine = Material { diffuse: Vec3::ZERO, emission: light.radiance.as_vec3() };
        scene.add(Shape::quad(light.corner, light.edges[0], light.edges[1]), shine);

        let (floor, pillar, pillar_at) = (ROOM[0].y + GAP, DVec3::new(0.31, 0.37, 0.31), [-0.64, -0.5]);
        scene.add(Shape::block(pillar).turned(24.0).standing(pillar_at, floor), STONE);
        let ball = Shape::icosphere(detail.smooth).scaled(0.29);
        scene.add(ball.standing(pillar_at, floor + 2.0 * pillar.y + GAP), GOLD);

        let [segments, sides] = detail.knot;
        let knot = Shape::torus_knot(2, 3, 0.42, segments, sides).scaled(0.185);
        scene.add(knot.turned(-28.0).standing([0.70, -0.42], floor), TEAL);

        let bumpy = bumpy_sphere(detail.bumpy, 180, 0.09).scaled(0.27);
        scene.add(bumpy.standing([0.06, 0.28], floor), CLAY);
        scene
    }

    fn add_walls(&mut self) {
        let [lower, upper] = ROOM;
        let [width, height, depth] = DVec3::AXES.map(|axis| axis * (upper - lower));
        self.add(Shape::quad(lower, depth, width), WHITE);
        self.add(Shape::quad(lower.with_y(upper.y), width, depth), WHITE);
        self.add(Shape::quad(lower, width, height), WHITE);
        self.add(Shape::quad(lower.with_z(upper.z), height, width), WHITE);
        self.add(Shape::quad(lower, height, depth), RED);
        self.add(Shape::quad(lower.with_x(upper.x), depth, height), GREEN);
    }

    fn add(&mut self, shape: Shape, material: Material) {
        let id = self.materials.iter().position(|known| *known == material).unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        });
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(shape.positions.iter().map(|position| position.as_vec3().to_array()));
        self.mesh.triangles.extend(shape.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
        self.mesh.material_ids.resize(self.mesh.triangles.len(), id as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lambert's formula for a surface element that faces a rectangle's corner straight on.
    fn corner_form_factor(x: f64, y: f64) -> f64 {
        let part = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
        (part(x, y) + part(y, x)) / core::f64::consts::TAU
    }

    #[test]
    fn the_form_factor_is_that_of_the_part_above_the_horizon() {
        let edges = [2.0 * DVec3::X, 4.0 * DVec3::Z];
        let light = Light { corner: DVec3::new(-1.0, 1.0, -2.0), edges, radiance: DVec3::ONE };
        assert_eq!((light.normal(), light.area()), (DVec3::NEG_Y, 8.0));
        let facing = light.form_factor(DVec3::ZERO, DVec3::Y);
        assert!((facing - 4.0 * corner_form_factor(1.0, 2.0)).abs() < 1e-12, "{facing}");
        assert_eq!(light.form_factor(DVec3::ZERO, DVec3::NEG_Y), 0.0);
        assert_eq!(light.form_factor(1.5 * DVec3::Y, DVec3::NEG_Y), 0.0, "behind the light");

        // The horizon of a tilted surface cuts the light in two; the expected value is summed over small patches.
        let normal = unit(DVec3::new(0.9, 0.2, 0.3)).expect("a direction");
        let steps = 400;
        let patches = (0..steps * steps).map(|patch| {
            let place = [patch % steps, patch / steps].map(|c| (f64::from(c) + 0.5) / f64::from(steps));
            let to_light = light.point(place);
            let cosines = normal.dot(to_light).max(0.0) * to_light.y;
            cosines / (core::f64::consts::PI * to_light.length_squared().powi(2))
        });
        let summed = patches.sum::<f64>() * light.area() / f64::from(steps * steps);
        let exact = light.form_factor(DVec3::ZERO, normal);
        assert!((exact - summed).abs() < 1e-4, "{exact}, summed {summed}");
    }

    #[test]
    fn the_room_is_closed_and_its_shapes_stand_apart() {
        let scene = Scene::room(Detail::FULL);
        let mesh = &scene.mesh;
        assert!((50_000..=200_000).contains(&mesh.triangles.len()), "{} triangles", mesh.triangles.len());
        assert_eq!(mesh.material_ids.len(), mesh.triangles.len());
        assert!(mesh.material_ids.iter().all(|id| (*id as usize) < scene.materials.len()));

        let bounds_of = |material: &Material| {
            let id = scene.materials.iter().position(|known| known == material).expect("a material in use") as u32;
            let primitives = (0..mesh.triangles.len()).filter(|primitive| mesh.material_ids[*primitive] == id);
            let corners = primitives.flat_map(|primitive| mesh.corners(primitive));
            corners.map(Vec3::from).fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), corner| {
                (lower.min(corner), upper.max(corner))
            })
        };
        let shapes = [CLAY, TEAL, GOLD, STONE].map(|material| bounds_of(&material));
        for (k, a) in shapes.iter().enumerate() {
            assert!(a.0.as_dvec3().cmpgt(ROOM[0]).all() && a.1.as_dvec3().cmplt(ROOM[1]).all());
            for b in &shapes[..k] {
                assert!((a.0.cmpgt(b.1) | b.0.cmpgt(a.1)).any(), "{a:?} meets {b:?}");
            }
        }
    }
}
