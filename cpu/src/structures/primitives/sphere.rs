//! A ray and a sphere.

use glam::Vec3;

/// Where a line enters and leaves a sphere, by the formula of textbooks.
///
/// ```text
/// f = o - centre    a = d . d    b = 2 f . d    c = f . f - r^2
/// t = (-b -+ sqrt(b^2 - 4 a c)) / 2 a
/// ```
///
/// `b^2` and `4 a c` are nearly the same where the sphere is small for its distance: at a few thousand radii nothing of
/// their difference is right. And where the line starts near the surface, `f . f` and `r^2` are, so that it is not known
/// on which side.
pub fn naive(origin: Vec3, direction: Vec3, centre: Vec3, radius: f32) -> Option<[f32; 2]> {
    let from_centre = origin - centre;
    let a = direction.dot(direction);
    let b = 2.0 * from_centre.dot(direction);
    let c = from_centre.dot(from_centre) - radius * radius;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let root = discriminant.sqrt();
    Some([(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)])
}

/// Where a line enters and leaves a sphere, without the two cancellations (E. Haines, J. Günther and T. Akenine-Möller,
/// "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, chapter 7, 2019).
///
/// ```text
/// f = o - centre    a = d . d    b = -f . d    c = f . f - r^2
/// l = f + (b / a) d                        from the centre to the line: what it is short for, it does not cancel
/// q = b + sign(b) sqrt(a (r^2 - l . l))    two numbers of one sign
/// t = c / q and q / a
/// ```
///
/// One thing is added: the article computes `c` in f32, where a line that starts near the surface does as badly as before;
/// here that one number is computed in f64.
pub fn stable(origin: Vec3, direction: Vec3, centre: Vec3, radius: f32) -> Option<[f32; 2]> {
    let from_centre = origin - centre;
    let a = direction.dot(direction);
    let b = -from_centre.dot(direction);
    let to_line = from_centre + (b / a) * direction;
    let squared_half_chord = radius * radius - to_line.dot(to_line);
    if squared_half_chord < 0.0 || squared_half_chord.is_nan() {
        return None;
    }
    let squared_distance = (origin.as_dvec3() - centre.as_dvec3()).length_squared();
    let c = (squared_distance - f64::from(radius) * f64::from(radius)) as f32;
    let q = b + (a * squared_half_chord).sqrt().copysign(b);
    // Only a line that touches the sphere where it starts has a q of 0.
    let [first, second] = if q == 0.0 { [0.0; 2] } else { [c / q, q / a] };
    Some([first.min(second), first.max(second)])
}
