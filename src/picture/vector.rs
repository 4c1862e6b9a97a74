//! Vectors and colours as arrays: the little algebra that pictures need.

/// A point or direction in the caller's units, or linear red, green and blue.
pub(crate) type Vector = [f64; 3];

pub(crate) fn add(a: Vector, b: Vector) -> Vector {
    core::array::from_fn(|k| a[k] + b[k])
}

pub(crate) fn sub(a: Vector, b: Vector) -> Vector {
    core::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn scale(a: Vector, factor: f64) -> Vector {
    a.map(|c| c * factor)
}

/// Component by component, as light is filtered by a colour.
pub(crate) fn mul(a: Vector, b: Vector) -> Vector {
    core::array::from_fn(|k| a[k] * b[k])
}

pub(crate) fn mix(a: Vector, b: Vector, share_of_b: f64) -> Vector {
    core::array::from_fn(|k| a[k] + (b[k] - a[k]) * share_of_b)
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The vector of length 1 in the same direction, `None` where there is no direction.
pub(crate) fn unit(a: Vector) -> Option<Vector> {
    // Divided by the largest component first, so that squares neither overflow nor vanish.
    let largest = a.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let a = a.map(|c| c / largest);
    (largest > 0.0 && largest.is_finite()).then(|| scale(a, 1.0 / length(a)))
}

/// Two unit vectors that complete a unit normal to a right-handed basis (Duff et al., JCGT 6(1), 2017).
pub(crate) fn tangents(normal: Vector) -> [Vector; 2] {
    let [x, y, z] = normal;
    let sign = 1f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}
