//! `Arithmetic`: the operations that the shaders compute with, of which a flavour chooses some.

use core::fmt;

use crate::flavour::Flavour;

/// Which operations a text computes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Every operation is guarded, and the error terms of products are made of such operations.
    Exact,
    /// No operation is guarded, and `fma` gives the error terms of products.
    Fast,
    /// `Exact` without its guards: a mutant, by which tests show that the guards matter.
    Unguarded,
}

impl Arithmetic {
    /// The operations' text.
    pub(super) fn text(self) -> String {
        let guard = match self {
            Self::Exact => include_str!("wgsl/guarded.wgsl"),
            Self::Fast | Self::Unguarded => include_str!("wgsl/unguarded.wgsl"),
        };
        let error_terms = match self {
            Self::Exact | Self::Unguarded => include_str!("wgsl/exact.wgsl"),
            Self::Fast => include_str!("wgsl/fast.wgsl"),
        };
        [guard, include_str!("wgsl/operations.wgsl"), error_terms].join("\n")
    }
}

impl From<Flavour> for Arithmetic {
    fn from(flavour: Flavour) -> Self {
        match flavour {
            Flavour::Exact => Self::Exact,
            Flavour::Fast => Self::Fast,
        }
    }
}

impl fmt::Display for Arithmetic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Fast => "fast",
            Self::Unguarded => "unguarded",
        })
    }
}
