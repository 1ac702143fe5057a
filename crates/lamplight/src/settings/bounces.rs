//! The bounces of light: how many, and whether within one frame or over many.

use crate::{Error, Result};
use schemars::JsonSchema;
use serde::de::{Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::fmt;

/// The bounces of light off walls and fog: at most a number of them, `"converged"`, or `"feedback"`; 2 unless set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Bounces {
    /// At most this many; 0 is direct light only.
    Count(#[schemars(range(min = 0, max = Bounces::MAX))] u32),
    /// Until the largest change is under 0.1 % of the mean.
    #[serde(serialize_with = "converged::serialize")]
    #[schemars(with = "converged::Word")]
    Converged,
    /// One more each frame, from the light of the frame before (Bigos 2020). The first frame has the fewest, and over
    /// frames light grows to that of `Converged`. A frame costs about as much as one without bounces; where lamps or
    /// walls move, the light that they reflect follows a frame or a few later.
    #[serde(serialize_with = "feedback::serialize")]
    #[schemars(with = "feedback::Word")]
    Feedback,
}

impl Bounces {
    /// The limit of `Converged` and `Feedback`, so that even scenes whose walls absorb nothing end.
    pub const MAX: u32 = 256;

    /// Returns the maximum number of bounces.
    pub fn limit(self) -> u32 {
        match self {
            Self::Count(k) => k,
            Self::Converged | Self::Feedback => Self::MAX,
        }
    }

    /// Returns the bounces that files and flags hold as a word.
    fn of_word(word: &str) -> Option<Self> {
        match word {
            "converged" => Some(Self::Converged),
            "feedback" => Some(Self::Feedback),
            _ => None,
        }
    }

    /// Returns bounces within a single frame that lead to the same light.
    #[must_use]
    pub fn within_a_frame(self) -> Self {
        if self == Self::Feedback { Self::Converged } else { self }
    }
}

impl std::str::FromStr for Bounces {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let count = text.parse().ok().filter(|&k| k <= Self::MAX).map(Self::Count);
        count.or_else(|| Self::of_word(text)).ok_or_else(|| {
            let expected = "a whole number from 0 to 256, `converged` or `feedback`";
            Error::value("bounces", text, expected)
        })
    }
}

impl From<Bounces> for Value {
    /// The value in files.
    fn from(bounces: Bounces) -> Self {
        match bounces {
            Bounces::Count(k) => k.into(),
            Bounces::Converged => "converged".into(),
            Bounces::Feedback => "feedback".into(),
        }
    }
}

impl Default for Bounces {
    fn default() -> Self {
        Self::Count(2)
    }
}

/// A module for a variant that files hold as a word.
macro_rules! word {
    ($module:ident, $word:ident) => {
        mod $module {
            use super::*;

            #[derive(Serialize, JsonSchema)]
            #[serde(rename_all = "lowercase")]
            pub enum Word {
                $word,
            }

            pub fn serialize<S: Serializer>(to: S) -> Result<S::Ok, S::Error> {
                Word::$word.serialize(to)
            }
        }
    };
}

word!(converged, Converged);
word!(feedback, Feedback);

impl<'de> Deserialize<'de> for Bounces {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Either;

        impl Visitor<'_> for Either {
            type Value = Bounces;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a whole number from 0 to 256, \"converged\" or \"feedback\"")
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
                Bounces::of_word(word).ok_or_else(|| E::invalid_value(Unexpected::Str(word), &self))
            }
        }

        from.deserialize_any(Either)
    }
}
