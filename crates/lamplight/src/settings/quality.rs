//! Quality levels that every method understands.

use super::Method;
use crate::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// A quality level: the preset of a method that trades speed for error.
///
/// In files `quality = "fast"`; on the command line `--quality fast`. Keys of the method that are
/// written beside it win.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    JsonSchema,
)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Quality {
    /// For large pictures on weak GPUs: `holographic` on a lattice of a quarter of the resolution, with softer shadows.
    /// Other methods are as with `fast`.
    Coarse,
    /// The fewest rays with which light still looks right.
    Fast,
    /// For games and previews.
    #[default]
    Default,
    /// For still pictures: less error, several times the time.
    High,
    /// The method as its source published it, for comparison.
    Paper,
}

impl Quality {
    /// All levels.
    pub const ALL: &'static [Self] =
        &[Self::Coarse, Self::Fast, Self::Default, Self::High, Self::Paper];

    /// The name in files and flags.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coarse => "coarse",
            Self::Fast => "fast",
            Self::Default => "default",
            Self::High => "high",
            Self::Paper => "paper",
        }
    }

    /// The preset of a method at this level.
    pub fn preset(self, method: Method) -> &'static str {
        match (self, method) {
            (Self::Paper, Method::Raymarch) => "godot",
            (Self::Paper, Method::Flood) => "seed",
            (Self::Paper, Method::Polar) => "gamemaker",
            (Self::Paper, Method::Cascades) => "plain",
            (Self::Coarse, Method::Raymarch | Method::Flood | Method::Polar | Method::Cascades) => {
                "fast"
            }
            _ => self.name(),
        }
    }
}

impl FromStr for Quality {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let known = Self::ALL.iter().find(|quality| quality.name() == name);
        known.copied().ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|quality| quality.name()).collect();
            Error::value("quality", format!("{name:?}"), format!("one of {}", names.join(", ")))
        })
    }
}
