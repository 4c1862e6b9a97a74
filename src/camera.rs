//! The pinhole camera: the size of its picture, its view, and its rays. Without a given view it frames the whole mesh.

use core::fmt;

use glam::{DVec3, Vec3};
use leafwalk::{Aabb, Ray};

use crate::picture::vector::unit;

/// How many pixels a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Size {
    /// The most pixels a side may have: the largest picture then takes 0.8 GB, and its pixels can be numbered in 32
    /// bits.
    pub(crate) const MOST: u32 = 16384;
    /// The size of pictures unless told otherwise.
    pub(crate) const DEFAULT: Self = Self { width: 960, height: 720 };

    /// # Errors
    /// When a side is 0 or above [`Size::MOST`].
    pub(crate) fn new(width: u32, height: u32) -> Result<Self, CameraError> {
        let sides = 1..=Self::MOST;
        let fits = sides.contains(&width) && sides.contains(&height);
        if fits { Ok(Self { width, height }) } else { Err(CameraError::Size { width, height }) }
    }

    pub(crate) fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Width over height.
    pub(crate) fn aspect(self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}

/// Where a camera stands and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    /// The pinhole, in the mesh's units.
    pub(crate) eye: DVec3,
    /// The point that is seen in the middle of the picture.
    pub(crate) at: DVec3,
    /// The direction that is up in the picture, of any length, not along the line of sight.
    pub(crate) up: DVec3,
    /// Vertical angle of view in degrees, in 0..180.
    pub(crate) fov: f64,
}

impl View {
    /// A moderate angle: little distortion, some depth.
    pub(crate) const FOV: f64 = 35.0;
    pub(crate) const UP: DVec3 = DVec3::Y;
    /// The direction from which a mesh is framed: from the right, the front and above, so that three sides of a box
    /// show.
    const THREE_QUARTER: DVec3 = DVec3::new(0.5, 0.36, 1.0);
    /// How much larger than the framed box the picture is, so that some room is left around it.
    const BORDER: f64 = 1.06;

    /// # Errors
    /// When an angle of view in degrees is not between 0 and 180.
    pub(crate) fn check_fov(degrees: f64) -> Result<(), CameraError> {
        if degrees > 0.0 && degrees < 180.0 { Ok(()) } else { Err(CameraError::FieldOfView { degrees }) }
    }

    /// A three-quarter view of a box that has all eight corners in the picture, close to its border.
    pub(crate) fn framing(bounds: &Aabb, fov: f64, aspect: f64) -> Self {
        let is_empty = (0..3).any(|k| bounds.lower[k] > bounds.upper[k]);
        let (lower, upper) = if is_empty { ([-0.5; 3], [0.5; 3]) } else { (bounds.lower, bounds.upper) };
        let (lower, upper) = (DVec3::from(lower), DVec3::from(upper));
        let at = (lower + upper) * 0.5;
        // The eye stands at the same point until its distance is known.
        let view = Self { eye: at, at, up: Self::UP, fov };
        let Some([right, up, back]) = basis(Self::THREE_QUARTER, Self::UP) else { return view };

        let tangent = view.tangent();
        let distance = (0..8)
            .map(|corner| {
                let corner = [0, 1, 2].map(|k| if corner >> k & 1 == 1 { upper[k] } else { lower[k] });
                let offset = DVec3::from(corner) - at;
                let needed = (offset.dot(right).abs() / aspect).max(offset.dot(up).abs()) / tangent;
                offset.dot(back) + Self::BORDER * needed
            })
            .fold(0.0, f64::max);
        // A mesh that is a single point has no size to frame: any distance shows the same.
        let distance = if distance > 0.0 { distance } else { 1.0 };
        Self { eye: at + back * distance, ..view }
    }

    /// Half the height of the picture at distance 1.
    fn tangent(&self) -> f64 {
        (0.5 * self.fov.to_radians()).tan()
    }
}

/// The unit vectors to the right, up and back of a camera that looks along `-back`. `None` where `back` or `up` has no
/// direction, or both have the same.
fn basis(back: DVec3, up: DVec3) -> Option<[DVec3; 3]> {
    let back = unit(back)?;
    let sideways = unit(up)?.cross(back);
    let is_parallel = sideways.length() < PARALLEL;
    let right = unit(sideways).filter(|_| !is_parallel)?;
    Some([right, back.cross(right), back])
}

/// The sine of the angle to the line of sight below which an up vector counts as parallel to it.
///
/// An error of the up vector turns the picture by that error divided by this sine. Up vectors come as f32, so the
/// picture turns by at most 2^-24 / 2^-10 = 2^-14, which moves no pixel of the largest picture by more than about its
/// edge: half the diagonal is 2^13.5 pixels long.
const PARALLEL: f64 = 1.0 / (1 << 10) as f64;

/// A camera that can take pictures: makes the primary rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    size: Size,
    eye: Vec3,
    /// Unit vectors to the right, up and back.
    basis: [DVec3; 3],
    /// The edge of a pixel at distance 1.
    pixel: f64,
}

impl Camera {
    /// # Errors
    /// [`CameraError`], when the view shows nothing that can be drawn.
    pub(crate) fn new(view: &View, size: Size) -> Result<Self, CameraError> {
        for (what, point) in [("eye", view.eye), ("at", view.at), ("up", view.up)] {
            // Ray origins are f32.
            if !point.as_vec3().is_finite() {
                return Err(CameraError::NonFinite { what, point });
            }
        }
        View::check_fov(view.fov)?;
        if view.eye == view.at {
            return Err(CameraError::NoDirection { eye: view.eye });
        }
        let Some(basis) = basis(view.eye - view.at, view.up) else {
            return Err(CameraError::UpAlongView { up: view.up });
        };
        let pixel = 2.0 * view.tangent() / f64::from(size.height);
        Ok(Self { size, eye: view.eye.as_vec3(), basis, pixel })
    }

    pub(crate) fn size(&self) -> Size {
        self.size
    }

    /// Unit vectors to the right, up and back.
    pub(crate) fn basis(&self) -> [DVec3; 3] {
        self.basis
    }

    /// The ray through a point of the picture, in pixels from its upper left corner; its direction has length 1.
    pub(crate) fn ray(&self, x: f64, y: f64) -> Ray {
        let [right, up, back] = self.basis;
        let across = self.pixel * (x - 0.5 * f64::from(self.size.width));
        let upwards = self.pixel * (0.5 * f64::from(self.size.height) - y);
        let direction = right * across + up * upwards - back;
        Ray::new(self.eye, unit(direction).unwrap_or(direction).as_vec3())
    }
}

/// Why a camera cannot take a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub(crate) enum CameraError {
    /// No pixels, or too many.
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The angle of view is not between 0 and 180 degrees.
    FieldOfView {
        /// The angle.
        degrees: f64,
    },
    /// A coordinate is NaN, infinite, or beyond f32.
    NonFinite {
        /// Which point or vector.
        what: &'static str,
        /// Its value.
        point: DVec3,
    },
    /// The eye is the point that it looks at.
    NoDirection {
        /// The point.
        eye: DVec3,
    },
    /// Up is zero, or the camera looks along it.
    UpAlongView {
        /// The vector.
        up: DVec3,
    },
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Size { width, height } => {
                write!(f, "a picture of {width} x {height} pixels: choose sides from 1 to {}", Size::MOST)
            }
            Self::FieldOfView { degrees } => {
                write!(f, "a field of view of {degrees} degrees: choose one above 0 and below 180")
            }
            Self::NonFinite { what, point: DVec3 { x, y, z } } => {
                write!(f, "the camera's {what} is ({x}, {y}, {z}): give finite numbers within the range of f32")
            }
            Self::NoDirection { eye: DVec3 { x, y, z } } => {
                write!(f, "the camera at ({x}, {y}, {z}) looks at its own place: move eye or at")
            }
            Self::UpAlongView { up: DVec3 { x, y, z } } => {
                write!(f, "up ({x}, {y}, {z}) is zero or lies along the line of sight: choose another up")
            }
        }
    }
}

impl core::error::Error for CameraError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(camera: &Camera, x: f64, y: f64) -> DVec3 {
        Vec3::from(camera.ray(x, y).direction).as_dvec3()
    }

    #[test]
    fn rays_go_through_their_pixels() {
        let view = View { eye: DVec3::new(1.0, 2.0, 3.0), at: DVec3::new(1.0, 2.0, -7.0), up: View::UP, fov: 90.0 };
        let camera = Camera::new(&view, Size { width: 200, height: 100 }).expect("a camera");
        assert_eq!(camera.ray(0.0, 0.0).origin, [1.0, 2.0, 3.0]);
        assert_eq!(direction(&camera, 100.0, 50.0), DVec3::NEG_Z);
        let [upper, right] = [direction(&camera, 100.0, 0.0), direction(&camera, 200.0, 50.0)];
        let expected = [[0.0, 0.5f64.sqrt(), -0.5f64.sqrt()], [2.0 / 5f64.sqrt(), 0.0, -1.0 / 5f64.sqrt()]];
        for (ray, expected) in [upper, right].into_iter().zip(expected.map(DVec3::from)) {
            assert!(ray.distance(expected) < 1e-6, "{ray:?}, not {expected:?}");
        }
    }

    #[test]
    fn a_framed_box_is_whole_and_large_in_the_picture() {
        let boxes = [
            Aabb { lower: [-1.0; 3], upper: [1.0; 3] },
            Aabb { lower: [1e5, 0.0, 0.0], upper: [1e5 + 1.0, 20.0, 1.0] },
            Aabb { lower: [-3e-6, -1e-6, -1e-7], upper: [3e-6, 1e-6, 1e-7] },
            Aabb { lower: [0.0; 3], upper: [1e20, 1.0, 1e20] },
        ];
        for (bounds, size) in boxes.iter().zip([(960, 720), (100, 1000), (1000, 100), (64, 64)]) {
            let size = Size { width: size.0, height: size.1 };
            let view = View::framing(bounds, View::FOV, size.aspect());
            let camera = Camera::new(&view, size).expect("a camera");
            let [right, up, back] = camera.basis();
            let place = |corner: u32| {
                let at = |k: usize| if corner >> k & 1 == 1 { bounds.upper[k] } else { bounds.lower[k] };
                let from_eye = DVec3::from([0, 1, 2].map(at)) - view.eye;
                let depth = -from_eye.dot(back) * view.tangent();
                assert!(depth > 0.0, "{bounds:?}: corner {corner} is behind the camera");
                (from_eye.dot(right).abs() / depth / size.aspect()).max(from_eye.dot(up).abs() / depth)
            };
            let outermost = (0..8).map(place).fold(0.0, f64::max);
            assert!((0.9..1.0).contains(&outermost), "{bounds:?}: the outermost corner is at {outermost}");
        }
    }

    #[test]
    fn nothing_and_a_point_can_be_framed() {
        let nothing = Aabb { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3] };
        let point = Aabb { lower: [7.0; 3], upper: [7.0; 3] };
        for bounds in [nothing, point] {
            let view = View::framing(&bounds, View::FOV, 1.0);
            assert!(Camera::new(&view, Size::DEFAULT).is_ok(), "{bounds:?}: {view:?}");
        }
    }

    #[test]
    fn views_that_show_nothing_are_refused() {
        let view = View { eye: DVec3::new(0.0, 0.0, 5.0), at: DVec3::ZERO, up: View::UP, fov: 40.0 };
        let refused = |view: View| Camera::new(&view, Size::DEFAULT).expect_err("no camera");
        assert!(Camera::new(&view, Size::DEFAULT).is_ok());
        for degrees in [0.0, -1.0, 180.0, f64::INFINITY] {
            assert_eq!(refused(View { fov: degrees, ..view }), CameraError::FieldOfView { degrees });
        }
        assert!(matches!(refused(View { fov: f64::NAN, ..view }), CameraError::FieldOfView { .. }));
        assert_eq!(refused(View { at: view.eye, ..view }), CameraError::NoDirection { eye: view.eye });
        for up in [DVec3::ZERO, DVec3::new(0.0, 0.0, -2.0), DVec3::new(0.0, 1e-6, 1.0)] {
            assert_eq!(refused(View { up, ..view }), CameraError::UpAlongView { up });
        }
        let far = DVec3::new(1e39, 0.0, 0.0);
        assert_eq!(refused(View { eye: far, ..view }), CameraError::NonFinite { what: "eye", point: far });
        for (width, height) in [(0, 1), (1, 0), (Size::MOST + 1, 1), (1, u32::MAX)] {
            assert_eq!(Size::new(width, height), Err(CameraError::Size { width, height }));
        }
    }
}
