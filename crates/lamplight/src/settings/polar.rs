//! The settings of `polar`.

use super::declare::settings;
use super::preset::with_preset;
use crate::Falloff;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The way in which a ray advances from the lamp outwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Traversal {
    /// From cell edge to cell edge: lengths are exact, and no cell is missed.
    #[default]
    Edge,
    /// By one px at a time (Griffis): up to 1 px too long, and clipped corners of cells are missed.
    Step,
    /// By the distance field, one px at a time near matter: the same result as `step`. The field
    /// costs some ms per frame and pays off for few large lamps in the open.
    Distance,
}

/// The filtering of shadow edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ShadowFilter {
    /// As wide as the lamp's `size` makes them, and at least one ray. Costs about a third more.
    #[default]
    Soft,
    /// Linear between two rays: crisp, without stairs.
    Linear,
    /// By the nearest ray (Griffis): stairs 1 px high at the lamp's range.
    Nearest,
}

/// The rule by which the light of several lamps is combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Blend {
    /// The sum, as for real light.
    #[default]
    Add,
    /// The brightest lamp per channel: overlaps do not brighten.
    Max,
    /// `1 − Π(1 − light)`, each lamp's light clamped to 1: overlaps brighten and never exceed 1.
    Screen,
}

settings! {
    /// The settings of `polar`.
    #[schemars(transform = with_preset(Self::PRESETS))]
    pub struct Polar in "polar" {
        /// Rays per px of the circle at a lamp's range: a lamp of range R has `2πR·density` rays.
        /// Higher: finer shadows of thin things. The cost of tracing grows with it, that of lighting
        /// pixels does not.
        density: f32 = 1.0, in 0.25..=8.0;
        /// The way in which a ray advances.
        traversal: Traversal = Traversal::Edge;
        /// The filtering of shadow edges.
        shadow_filter: ShadowFilter = ShadowFilter::Soft;
        /// Fog and glass darken and tint light. Off: everything that is not empty ends a ray
        /// (Griffis).
        translucent: bool = true;
        /// The rule by which lamps are combined.
        blend: Blend = Blend::Add;
        /// The falloff of all lamps. If left out, each lamp has its own `falloff`.
        #[serde(skip_serializing_if = "Option::is_none")]
        falloff: Option<Falloff> = None;
    }
}

impl Polar {
    /// Names of the presets; the first is the default.
    pub const PRESETS: &'static [&'static str] = &["default", "fast", "high", "gamemaker"];

    /// Returns the preset of a name.
    ///
    /// `fast` and `high` have half and twice the rays. `gamemaker` is the method of Griffis (2πR
    /// rays, one px at a time, the nearest ray, everything ends a ray, lamps add up, linear falloff:
    /// for lamps of intensity 1 or so).
    pub fn preset(name: &str) -> Option<Self> {
        Some(match name {
            "default" => Self::default(),
            "fast" => Self { density: 0.5, ..Self::default() },
            "high" => Self { density: 2.0, ..Self::default() },
            "gamemaker" => Self {
                traversal: Traversal::Step,
                shadow_filter: ShadowFilter::Nearest,
                translucent: false,
                falloff: Some(Falloff::Linear),
                ..Self::default()
            },
            _ => return None,
        })
    }
}
