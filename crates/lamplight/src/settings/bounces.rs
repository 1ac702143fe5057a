//! The maximum number of bounces.

use crate::{Error, Result};
use schemars::JsonSchema;
use serde::de::{Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// The maximum number of bounces of light off walls and fog: a number, or `"converged"`; 2 unless set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Bounces {
    /// At most this many; 0 is direct light only.
    Count(#[schemars(range(min = 0, max = Bounces::MAX))] u32),
    /// Until the largest change is under 0.1 % of the mean.
    #[serde(serialize_with = "converged::serialize")]
    #[schemars(with = "converged::Word")]
    Converged,
}

impl Bounces {
    /// The limit of `Converged`, so that even scenes whose walls absorb nothing end.
    pub const MAX: u32 = 256;

    /// Returns the maximum number of bounces.
    pub fn limit(self) -> u32 {
        match self {
            Self::Count(k) => k,
            Self::Converged => Self::MAX,
        }
    }
}

impl std::str::FromStr for Bounces {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text.parse() {
            Ok(k) if k <= Self::MAX => Ok(Self::Count(k)),
            _ if text == "converged" => Ok(Self::Converged),
            _ => Err(Error::value("bounces", text, "a whole number from 0 to 256, or `converged`")),
        }
    }
}

impl Default for Bounces {
    fn default() -> Self {
        Self::Count(2)
    }
}

mod converged {
    use super::*;

    #[derive(Serialize, JsonSchema)]
    #[serde(rename_all = "lowercase")]
    pub enum Word {
        Converged,
    }

    pub fn serialize<S: Serializer>(to: S) -> Result<S::Ok, S::Error> {
        Word::Converged.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Bounces {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Either;

        impl Visitor<'_> for Either {
            type Value = Bounces;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a whole number from 0 to 256, or \"converged\"")
            }

            fn visit_u64<E: serde::de::Error>(self, k: u64) -> Result<Bounces, E> {
                match u32::try_from(k) {
                    Ok(k) if k <= Bounces::MAX => Ok(Bounces::Count(k)),
                    _ => Err(E::invalid_value(Unexpected::Unsigned(k), &self)),
                }
            }

            fn visit_i64<E: serde::de::Error>(self, k: i64) -> Result<Bounces, E> {
                match u64::try_from(k) {
                    Ok(k) => self.visit_u64(k),
                    Err(_) => Err(E::invalid_value(Unexpected::Signed(k), &self)),
                }
            }

            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<Bounces, E> {
                match word {
                    "converged" => Ok(Bounces::Converged),
                    _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
                }
            }
        }

        from.deserialize_any(Either)
    }
}
