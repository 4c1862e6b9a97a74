//! The two flavours of the shader, which differ in what they promise about the bits of a hit.

use core::fmt;
use core::str::FromStr;

/// What the shader promises about the bits of its hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Flavour {
    /// Every hit has the bits that the CPU computes: the text keeps the driver from fusing, regrouping or approximating
    /// any operation that a hit depends on.
    #[default]
    Exact,
    /// The driver may fuse, regroup and approximate. Faster on some devices; a few hits differ from the CPU's.
    Fast,
}

impl Flavour {
    const ALL: [Self; 2] = [Self::Exact, Self::Fast];

    /// The flavour's name, in small letters, as the command line takes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Fast => "fast",
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
        let found = Self::ALL.into_iter().find(|flavour| flavour.name() == name);
        found.ok_or_else(|| UnknownFlavour { name: name.to_owned() })
    }
}

/// The error of parsing a [`Flavour`] from a name that no flavour has.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct UnknownFlavour {
    /// The name that was given.
    pub name: String,
}

impl fmt::Display for UnknownFlavour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no flavour is called '{}': choose '{}' or '{}'", self.name, Flavour::Exact, Flavour::Fast)
    }
}

impl core::error::Error for UnknownFlavour {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_parse_and_others_are_refused() {
        for flavour in Flavour::ALL {
            assert_eq!(flavour.name().parse(), Ok(flavour));
        }
        let error = "quick".parse::<Flavour>().map_err(|error| error.to_string());
        assert_eq!(error, Err("no flavour is called 'quick': choose 'exact' or 'fast'".to_owned()));
    }
}
