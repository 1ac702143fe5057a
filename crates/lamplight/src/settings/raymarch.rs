//! The settings of `raymarch`.

use super::declare::settings;
use super::filters::{Denoise, Temporal};
use super::preset::with_preset;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The angle at which each pixel's first ray starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Noise {
    /// An integer hash of pixel and frame: independent, blotchy.
    White,
    /// The project's spatio-temporal blue-noise texture: the same error, pushed to high
    /// frequencies in space and time, where eyes and blurs remove it.
    #[default]
    Blue,
    /// A low-discrepancy lattice over pixel and frame (Roberts 2018, R2 sequence).
    Golden,
}

/// The angle between consecutive rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Spacing {
    /// `2π/rays`: the least error for a given number of rays.
    #[default]
    Even,
    /// The golden angle (Bigos 2020): any prefix of the rays is well distributed.
    Golden,
}

/// The rule by which a ray ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Hit {
    /// Exactly at the edge of a solid cell, with fog and glass on the way: converges to the truth.
    #[default]
    Edge,
    /// At the point where the distance field falls below `hit_distance`, as in the source documents.
    /// Any occupied cell ends the ray, and corners are rounded.
    Distance,
}

settings! {
    /// The settings of `raymarch`.
    #[schemars(transform = with_preset(Self::PRESETS))]
    pub struct Raymarch in "raymarch" {
        /// Rays per pixel. Time grows in proportion; noise falls between 1/√rays and 1/rays.
        rays: u32 = 32, in 1..=65_536;
        /// Maximum number of steps of a ray. A step is one cell or one skip over empty space. Low
        /// values are faster and darken distant places and those behind fog.
        steps: u32 = 4096, in 1..=65_536;
        /// The rule by which a ray ends.
        hit: Hit = Hit::Edge;
        /// Distance in px from a surface at which a ray has arrived, with `hit = "distance"`.
        /// Higher: rounder and fatter shapes.
        hit_distance: f32 = 0.5, in 0.01..=4.0;
        /// Shortest step of a ray in px, with `hit = "distance"`. Higher values are faster and miss
        /// corners (never whole cells).
        least_step: f32 = 1.0, in 0.1..=8.0;
        /// The angle at which each pixel's first ray starts.
        noise: Noise = Noise::Blue;
        /// The angle between consecutive rays.
        spacing: Spacing = Spacing::Even;
        /// Factor on all emission (Bigos 2020 uses 1, the demo 1.5).
        emission_multiplier: f32 = 1.0, in 0.0..=1000.0;
        /// Fade emission with distance d by `max(1 − (d/range)², 0)^dropoff` (Bigos 2020). Not
        /// physical, and therefore off by default; adds nothing to the cost.
        attenuation: bool = false;
        /// Range of the attenuation, in heights of the grid.
        emission_range: f32 = 2.0, in 0.001..=1000.0;
        /// Exponent of the attenuation.
        emission_dropoff: f32 = 2.0, in 0.0..=16.0;
        /// Opacity above which a cell is occupied in the seed map. With `hit = "edge"`, rays pass
        /// cells at or below it as if they were empty.
        threshold: f32 = 0.0, in 0.0..=0.999;
        /// Accumulation over frames. In files it is a table of its own, `temporal`.
        #[serde(skip)]
        temporal: Temporal = Temporal::default();
        /// The edge-aware blur after the rays. In files it is a table of its own, `denoise`.
        #[serde(skip)]
        denoise: Denoise = Denoise::default();
    }
    check |settings| {
        settings.temporal.check()?;
        settings.denoise.check()
    }
}

impl Raymarch {
    /// Names of the presets; the first is the default.
    pub const PRESETS: &'static [&'static str] = &["default", "fast", "high", "godot", "unity"];

    /// Returns the preset of a name.
    ///
    /// `fast` and `high` take 16 and 128 rays. `godot` follows Bigos 2020 (32 rays a golden
    /// angle apart, 128 steps, white noise), and `unity` its port with tone mapping (16 rays, evenly spaced, 16 steps,
    /// hit at 0.8 px); both without the blur. The sources bounce light by [`crate::Bounces::Feedback`].
    pub fn preset(name: &str) -> Option<Self> {
        let godot = Self {
            steps: 128,
            hit: Hit::Distance,
            noise: Noise::White,
            spacing: Spacing::Golden,
            denoise: Denoise { passes: 0, ..Denoise::default() },
            ..Self::default()
        };
        Some(match name {
            "default" => Self::default(),
            "fast" => Self { rays: 16, ..Self::default() },
            "high" => Self { rays: 128, ..Self::default() },
            "godot" => godot,
            "unity" => {
                Self { rays: 16, steps: 16, hit_distance: 0.8, spacing: Spacing::Even, ..godot }
            }
            _ => return None,
        })
    }
}
