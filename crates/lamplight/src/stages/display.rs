//! From linear light to a picture: exposure, tone map, sRGB.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How light without bound is brought into 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ToneMap {
    /// Cut off at 1.
    None,
    /// `x / (1 + x)` (Reinhard et al. 2002).
    Reinhard,
    /// A film-like curve (Narkowicz 2015), with highlights that turn white (seed 2).
    #[default]
    Aces,
    /// AgX (Sobotka 2022), in the polynomial form of Wrensch (2023).
    Agx,
}

/// How the final picture is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Display {
    /// The tone map.
    pub tonemap: ToneMap,
    /// Exposure in stops: +1 doubles the light.
    pub exposure: f32,
}
