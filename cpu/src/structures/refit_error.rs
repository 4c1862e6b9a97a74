//! Why a structure cannot follow a mesh.

use core::fmt;

use crate::BuildError;

/// What stopped a refit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RefitError {
    /// The mesh can't be built.
    Build(BuildError),
    /// The mesh has another number of triangles that can be hit.
    OtherTriangles {
        /// How many it has.
        found: usize,
        /// How many the structure was built over.
        expected: usize,
    },
}

impl fmt::Display for RefitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Build(error) => write!(f, "{error}"),
            Self::OtherTriangles { found, expected } => {
                write!(f, "{found} triangles where the structure was built over {expected}: build it anew")
            }
        }
    }
}

impl core::error::Error for RefitError {}
