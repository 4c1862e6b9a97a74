//! Spheres and planes, each met by the formula of textbooks and by one that rounds less: where methods begin to fail is
//! seen best on what has but few numbers.

pub mod plane;
pub mod sphere;
