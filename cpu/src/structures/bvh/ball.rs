//! Spheres as bounding volumes.

use glam::Vec3;

use super::volume::Volume;
use crate::structures::bounds::Bounds;
use crate::structures::line::Line;

/// A sphere: J. Ritter, "An Efficient Bounding Sphere", Graphics Gems, 1990, or the one around the middle of the points' box,
/// whichever is smaller.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    centre: Vec3,
    radius: f32,
}

/// A line, and the square of its direction's length.
#[derive(Clone, Copy)]
pub struct Probe {
    origin: Vec3,
    direction: Vec3,
    square: f32,
}

/// How much a radius grows for the roundings of the distances that it was taken from, each of which is off by two and a half
/// roundoffs of itself at most.
const DISTANCE_ERROR: f32 = 4.0 * (f32::EPSILON / 2.0);

impl Ball {
    /// The smallest around some points with this centre.
    fn centred(centre: Vec3, points: &[Vec3]) -> Self {
        let radius = points.iter().map(|point| point.distance(centre)).fold(0.0, f32::max);
        Self { centre, radius: radius + DISTANCE_ERROR * radius }
    }

    /// Ritter's: around the ends of a long chord, then grown by each point that is outside.
    fn grown(points: &[Vec3]) -> Self {
        let farthest = |from: Vec3| {
            let farther = |a: Vec3, b: &Vec3| if b.distance_squared(from) > a.distance_squared(from) { *b } else { a };
            points.iter().fold(points[0], farther)
        };
        let one = farthest(points[0]);
        let other = farthest(one);
        let mut ball = Self { centre: 0.5 * one + 0.5 * other, radius: 0.5 * one.distance(other) };
        for point in points {
            let distance = point.distance(ball.centre);
            if distance > ball.radius {
                let radius = 0.5 * ball.radius + 0.5 * distance;
                ball.centre += (point - ball.centre) * ((distance - radius) / distance);
                ball.radius = radius;
            }
        }
        // What rounding moved is made good here.
        Self::centred(ball.centre, points)
    }
}

impl Volume for Ball {
    const EMPTY: Self = Self { centre: Vec3::ZERO, radius: -1.0 };
    /// The point of the line that is nearest to the centre is off by at most 10 roundoffs of the origin's distance: 1 from the
    /// difference of origin and centre, 7 from the quotient of two sums of three products, 1 each from the product and the
    /// difference behind it. That distance is below 3.5 root edges, so this and the roundings of the squares stay below
    /// 50 roundoffs of the root's edge, where a margin is 120. Since the sphere is larger by more than what the line may be
    /// off, the chord is longer than the true one, too, and its start is no later.
    const MARGINS: f32 = 2.0;
    type Probe = Probe;

    fn around(points: &[Vec3], margin: f32) -> Self {
        let (grown, centred) = (Self::grown(points), Self::centred(Bounds::around(points).centre(), points));
        let ball = if grown.radius < centred.radius { grown } else { centred };
        Self { radius: ball.radius + margin, ..ball }
    }

    fn join(&self, _: &Self) -> Option<Self> {
        None
    }

    fn probe(line: &Line) -> Probe {
        Probe { origin: line.origin, direction: line.direction, square: line.direction.length_squared() }
    }

    #[inline]
    fn entry(&self, probe: &Probe, first: f32, last: f32) -> Option<f32> {
        let to_centre = self.centre - probe.origin;
        let nearest = to_centre.dot(probe.direction) / probe.square;
        let aside = to_centre - nearest * probe.direction;
        let left = self.radius * self.radius - aside.length_squared();
        if left < 0.0 {
            return None;
        }
        let half_chord = (left / probe.square).sqrt();
        let entry = first.max(nearest - half_chord);
        (entry <= last.min(nearest + half_chord)).then_some(entry)
    }
}
