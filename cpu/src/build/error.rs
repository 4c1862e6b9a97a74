//! Why a mesh cannot be built.

use core::fmt;

/// What stopped a build.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// A vertex that a triangle uses is NaN, infinite, or larger than any number of f32.
    NonFiniteVertex {
        /// Index of the vertex.
        vertex: u32,
        /// Its position.
        position: [f64; 3],
    },
    /// A triangle uses a vertex that the mesh does not have.
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The index it uses.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// Material ids are neither absent nor one a triangle.
    MaterialCount {
        /// Material ids present.
        materials: usize,
        /// Triangles.
        triangles: usize,
    },
    /// More of something than the format can number.
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How much.
        count: u64,
        /// How much is possible.
        limit: u64,
    },
    /// The build would need more memory than it may use.
    OutOfMemory {
        /// Bytes it would need next, all together.
        needed: u64,
        /// The limit in force.
        limit: u64,
    },
    /// A setting of the builder is out of its range.
    Setting {
        /// What is set.
        setting: &'static str,
        /// What it was set to.
        value: f64,
        /// The least value that is possible.
        least: f64,
        /// The largest value that is possible; [`f32::MAX`] where every finite number is.
        most: f64,
    },
    /// The progress callback asked to stop.
    Cancelled,
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NonFiniteVertex { vertex, position: [x, y, z] } => {
                write!(
                    f,
                    "vertex {vertex} is ({x:?}, {y:?}, {z:?}), which f32 cannot hold: repair it, or build leniently to \
                     leave its triangles out"
                )
            }
            Self::IndexOutOfRange { triangle, index, vertices } => {
                write!(f, "triangle {triangle} uses vertex {index}, but there are only {vertices} vertices")
            }
            Self::MaterialCount { materials, triangles } => {
                write!(f, "{materials} material ids for {triangles} triangles: give one a triangle, or none")
            }
            Self::TooLarge { what, count, limit } => {
                write!(f, "{count} {what}, at most {limit} are possible: split the mesh")
            }
            Self::OutOfMemory { needed, limit } => {
                write!(
                    f,
                    "the build needs {needed} bytes, the limit is {limit}: raise it, or lower the reference budget"
                )
            }
            Self::Setting { setting, value, least, most } if most < f64::from(f32::MAX) => {
                write!(f, "the {setting} is {value}: set it to a number from {least} to {most}")
            }
            Self::Setting { setting, value, least, .. } => {
                write!(f, "the {setting} is {value}: set it to a finite number from {least} on")
            }
            Self::Cancelled => write!(f, "the build was cancelled"),
        }
    }
}

impl core::error::Error for BuildError {}
