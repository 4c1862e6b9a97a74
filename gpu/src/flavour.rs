//! Which promise a shader makes.

use core::fmt;
use core::str::FromStr;

/// The two texts that one template gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Flavour {
    /// All bits equal to the CPU's: no driver can fuse, regroup or approximate what is computed.
    #[default]
    Exact,
    /// Left to the driver: a few hits differ, which [`crate::SelfTest`] and comparisons count.
    Fast,
    /// `Exact` without its guards, for tests: it shows that they matter.
    #[doc(hidden)]
    Unguarded,
}

impl Flavour {
    /// As it is written on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Fast => "fast",
            Self::Unguarded => "unguarded",
        }
    }
}

impl fmt::Display for Flavour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Flavour {
    type Err = UnknownFlavour;

    fn from_str(name: &str) -> Result<Self, UnknownFlavour> {
        [Self::Exact, Self::Fast].into_iter().find(|flavour| flavour.name() == name).ok_or(UnknownFlavour)
    }
}

/// The name of no flavour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownFlavour;

impl fmt::Display for UnknownFlavour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "choose '{}' or '{}'", Flavour::Exact, Flavour::Fast)
    }
}

impl core::error::Error for UnknownFlavour {}
