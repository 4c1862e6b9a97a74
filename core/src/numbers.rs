//! Numbers for serde, the feature `serde`: formats for humans, such as JSON, have no infinity.
//!
//! In such a format a number that is not finite is one of the strings `"inf"`, `"-inf"` and `"NaN"`; a NaN loses its
//! payload. All other numbers, and all numbers in other formats, are what serde makes of them: zeros keep their sign, and
//! subnormal numbers all their bits. `serde_json` reads f64 exactly only with its feature `float_roundtrip`.
//!
//! A struct of one's own that holds such numbers names [`number`] or [`triple`]:
//! ```
//! #[derive(serde::Serialize, serde::Deserialize)]
//! struct Range {
//!     #[serde(with = "leafwalk_core::numbers::number")]
//!     t_max: f32,
//! }
//! ```

use core::fmt;
use core::marker::PhantomData;

use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The string that stands for positive infinity.
const INFINITE: &str = "inf";
/// The string that stands for negative infinity.
const NEGATIVE: &str = "-inf";
/// The string that stands for every NaN.
const NAN: &str = "NaN";

/// An f32 or f64 that every format can hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number<T>(pub T);

/// The floating-point types that a [`Number`] may hold: f32 and f64.
pub trait Float: Copy + Into<f64> + Serialize + for<'de> Deserialize<'de> {
    /// The nearest number of this type.
    fn nearest(x: f64) -> Self;
}

impl Float for f32 {
    fn nearest(x: f64) -> Self {
        x as f32
    }
}

impl Float for f64 {
    fn nearest(x: f64) -> Self {
        x
    }
}

impl<T: Float> Serialize for Number<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let x: f64 = self.0.into();
        match serializer.is_human_readable() {
            true if x.is_nan() => serializer.serialize_str(NAN),
            true if x == f64::INFINITY => serializer.serialize_str(INFINITE),
            true if x == f64::NEG_INFINITY => serializer.serialize_str(NEGATIVE),
            _ => self.0.serialize(serializer),
        }
    }
}

impl<'de, T: Float> Deserialize<'de> for Number<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_any(Reader(PhantomData))
        } else {
            T::deserialize(deserializer).map(Self)
        }
    }
}

/// Reads a number, or a string that stands for one.
struct Reader<T>(PhantomData<T>);

impl<T: Float> Visitor<'_> for Reader<T> {
    type Value = Number<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number, \"{INFINITE}\", \"{NEGATIVE}\" or \"{NAN}\"")
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<Self::Value, E> {
        Ok(Number(T::nearest(x)))
    }

    fn visit_u64<E: Error>(self, x: u64) -> Result<Self::Value, E> {
        self.visit_f64(x as f64)
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<Self::Value, E> {
        self.visit_f64(x as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        match text {
            INFINITE => self.visit_f64(f64::INFINITY),
            NEGATIVE => self.visit_f64(f64::NEG_INFINITY),
            NAN => self.visit_f64(f64::NAN),
            _ => Err(E::invalid_value(Unexpected::Str(text), &self)),
        }
    }
}

/// One number, for `#[serde(with = "leafwalk_core::numbers::number")]`.
pub mod number {
    use super::{Deserialize, Deserializer, Float, Number, Serialize, Serializer};

    /// Writes a number, or the string that stands for it.
    ///
    /// # Errors
    /// When the format cannot write a number or a string.
    pub fn serialize<T: Float, S: Serializer>(x: &T, serializer: S) -> Result<S::Ok, S::Error> {
        Number(*x).serialize(serializer)
    }

    /// Reads a number, or a string that stands for one.
    ///
    /// # Errors
    /// When the input breaks the rules of its format, or is neither a number nor one of the three strings.
    pub fn deserialize<'de, T: Float, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        Number::deserialize(deserializer).map(|Number(x)| x)
    }
}

/// Three numbers, for `#[serde(with = "leafwalk_core::numbers::triple")]`.
pub mod triple {
    use super::{Deserialize, Deserializer, Float, Number, Serialize, Serializer};

    /// Writes three numbers, each of them as [`super::number`] does.
    ///
    /// # Errors
    /// When the format cannot write a number or a string.
    pub fn serialize<T: Float, S: Serializer>(triple: &[T; 3], serializer: S) -> Result<S::Ok, S::Error> {
        triple.map(Number).serialize(serializer)
    }

    /// Reads three numbers, each of them as [`super::number`] does.
    ///
    /// # Errors
    /// When the input breaks the rules of its format, or is not made of three numbers.
    pub fn deserialize<'de, T: Float, D: Deserializer<'de>>(deserializer: D) -> Result<[T; 3], D::Error> {
        <[Number<T>; 3]>::deserialize(deserializer).map(|triple| triple.map(|Number(x)| x))
    }
}
