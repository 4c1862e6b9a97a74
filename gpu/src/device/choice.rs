//! `AdapterChoice`: which of this machine's adapters to open.

use core::convert::Infallible;
use core::fmt;
use core::str::FromStr;

use super::adapter::{Adapter, AdapterKind};

/// Which adapter to trace on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum AdapterChoice {
    /// The fastest kind of hardware there is; never a software adapter, which is slower than tracing on the CPU.
    #[default]
    Auto,
    /// A software adapter, for tests.
    Software,
    /// The first adapter whose text (its [`fmt::Display`]) contains this, whatever the case.
    Name(String),
}

impl AdapterChoice {
    /// The environment variable that [`AdapterChoice::from_environment`] reads.
    pub const VARIABLE: &str = "LEAFWALK_ADAPTER";

    /// The choice that the variable `LEAFWALK_ADAPTER` states: `auto`, `software` or a part of an adapter's name.
    /// [`AdapterChoice::Auto`] where the variable is unset.
    pub fn from_environment() -> Self {
        std::env::var(Self::VARIABLE).map_or(Self::Auto, |name| name.into())
    }

    /// How much this choice wants an adapter, higher meaning more; `None` where it does not want it at all.
    pub(super) fn rank(&self, adapter: &Adapter) -> Option<u32> {
        let speed = match adapter.kind {
            AdapterKind::Discrete => 3,
            AdapterKind::Integrated => 2,
            AdapterKind::Virtual => 1,
            AdapterKind::Other | AdapterKind::Software => 0,
        };
        match self {
            Self::Auto => (adapter.kind != AdapterKind::Software).then_some(speed),
            Self::Software => (adapter.kind == AdapterKind::Software).then_some(speed),
            Self::Name(name) => adapter.to_string().to_lowercase().contains(&name.to_lowercase()).then_some(0),
        }
    }
}

impl From<String> for AdapterChoice {
    fn from(name: String) -> Self {
        match name.as_str() {
            "auto" => Self::Auto,
            "software" => Self::Software,
            _ => Self::Name(name),
        }
    }
}

impl FromStr for AdapterChoice {
    type Err = Infallible;

    fn from_str(name: &str) -> Result<Self, Infallible> {
        Ok(name.to_owned().into())
    }
}

impl fmt::Display for AdapterChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("hardware"),
            Self::Software => f.write_str("software"),
            Self::Name(name) => write!(f, "called '{name}'"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_takes_the_best_hardware_and_no_software() {
        let rank = |kind| AdapterChoice::Auto.rank(&Adapter::named("x", kind));
        assert!(rank(AdapterKind::Discrete) > rank(AdapterKind::Integrated));
        assert!(rank(AdapterKind::Integrated) > rank(AdapterKind::Virtual));
        assert!(rank(AdapterKind::Virtual) > rank(AdapterKind::Other) && rank(AdapterKind::Other).is_some());
        assert_eq!(rank(AdapterKind::Software), None);
    }

    #[test]
    fn software_and_names_take_what_they_say() {
        let hard = Adapter::named("NVIDIA H200", AdapterKind::Discrete);
        let soft = Adapter::named("llvmpipe", AdapterKind::Software);
        assert!(AdapterChoice::Software.rank(&soft).is_some() && AdapterChoice::Software.rank(&hard).is_none());
        for (name, hits_hard) in [("h200", true), ("LLVM", false), ("llvmpipe by vulkan", false)] {
            let choice = AdapterChoice::from(name.to_owned());
            assert_eq!((choice.rank(&hard).is_some(), choice.rank(&soft).is_some()), (hits_hard, !hits_hard), "{name}");
        }
    }
}
