//! The settings of `raymarch`.

use super::table::with_preset;
use super::within;
use crate::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where rays start round the circle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Noise {
    /// An integer hash of pixel and frame: independent, blotchy.
    White,
    /// The project's spatio-temporal blue-noise texture: the same error, pushed to high
    /// frequencies in space and time, where eyes and blurs remove it.
    #[default]
    Blue,
    /// A low-discrepancy lattice over pixel and frame (the golden ratio and its sister in two
    /// dimensions, Roberts 2018).
    Golden,
}

/// From one ray to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Spacing {
    /// `2π/rays` apart: the least error for a given number.
    #[default]
    Even,
    /// The golden angle apart (seed 1): any prefix is spread well.
    Golden,
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hit {
    /// Exactly at the edge of a solid cell, with fog and glass on the way: converges to the truth.
    #[default]
    Edge,
    /// Where the distance field falls under `hit_distance`, as the seeds do: any occupied cell ends
    /// the ray, corners come out round.
    Distance,
}

/// How a raymarched bounce is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BounceBy {
    /// All bounces inside one frame.
    #[default]
    Frame,
    /// One more bounce each frame, from the light of the frame before (the seeds' way): `bounces`
    /// is then only on or off.
    Feedback,
}

/// The settings of `raymarch`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(transform = with_preset(Self::PRESETS))]
pub struct Raymarch {
    /// Rays a pixel, 1 to 65536. Time grows with it; noise falls between 1/√rays and 1/rays.
    #[schemars(range(min = 1, max = 65_536))]
    pub rays: u32,
    /// Most steps a ray makes, 1 to 65536 (a leap by the distance field or one cell is a step). Low
    /// values are faster and darken what lies far or behind fog.
    #[schemars(range(min = 1, max = 65_536))]
    pub steps: u32,
    /// Where a ray ends.
    pub hit: Hit,
    /// With `hit = "distance"`: px from a surface at which a ray has arrived, 0.01 to 4. Higher:
    /// rounder and fatter shapes.
    #[schemars(range(min = 0.01, max = 4.0))]
    pub hit_distance: f32,
    /// With `hit = "distance"`: the least px that a ray advances, 0.1 to 8. Higher is faster and
    /// misses corners (never whole cells).
    #[schemars(range(min = 0.1, max = 8.0))]
    pub least_step: f32,
    /// Where rays start round the circle.
    pub noise: Noise,
    /// From one ray to the next.
    pub spacing: Spacing,
    /// Multiplies all emission, 0 to 1000 (seed 1: 1, its demo 1.5).
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub emission_multiplier: f32,
    /// Fade emission with distance d by `max(1 − (d/range)², 0)^dropoff` (seed 1). Not physical,
    /// so off by default; adds nothing to the cost.
    pub attenuation: bool,
    /// Range of the attenuation in heights of the grid, 0.001 to 1000.
    #[schemars(range(min = 0.001, max = 1000.0))]
    pub emission_range: f32,
    /// Exponent of the attenuation, 0 to 16.
    #[schemars(range(min = 0.0, max = 16.0))]
    pub emission_dropoff: f32,
    /// Opacity above which a cell is occupied in the seed map, 0 to 0.999. With `hit = "edge"`
    /// cells at or under it are passed as if empty.
    #[schemars(range(min = 0.0, max = 0.999))]
    pub threshold: f32,
    /// How a bounce is made.
    pub bounce: BounceBy,
}

impl Default for Raymarch {
    fn default() -> Self {
        Self {
            rays: 32,
            steps: 4096,
            hit: Hit::Edge,
            hit_distance: 0.5,
            least_step: 1.0,
            noise: Noise::Blue,
            spacing: Spacing::Even,
            emission_multiplier: 1.0,
            attenuation: false,
            emission_range: 2.0,
            emission_dropoff: 2.0,
            threshold: 0.0,
            bounce: BounceBy::Frame,
        }
    }
}

impl Raymarch {
    /// Names of the presets.
    pub const PRESETS: &'static [&'static str] = &["default", "godot", "unity"];

    /// A preset by name: `default`; `godot`, seed 1's demo settings (Bigos 2020: 32 rays a golden
    /// angle apart, 128 steps, white noise, feedback bounce); `unity`, seed 2's (16 rays evenly
    /// apart, 16 steps, hit at 0.8 px).
    pub fn preset(name: &str) -> Option<Self> {
        let seed1 = Self {
            steps: 128,
            hit: Hit::Distance,
            noise: Noise::White,
            spacing: Spacing::Golden,
            bounce: BounceBy::Feedback,
            ..Self::default()
        };
        match name {
            "default" => Some(Self::default()),
            "godot" => Some(seed1),
            "unity" => Some(Self {
                rays: 16,
                steps: 16,
                hit_distance: 0.8,
                spacing: Spacing::Even,
                ..seed1
            }),
            _ => None,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        within("raymarch.rays", self.rays, 1..=65_536)?;
        within("raymarch.steps", self.steps, 1..=65_536)?;
        within("raymarch.hit_distance", self.hit_distance, 0.01..=4.0)?;
        within("raymarch.least_step", self.least_step, 0.1..=8.0)?;
        within("raymarch.emission_multiplier", self.emission_multiplier, 0.0..=1000.0)?;
        within("raymarch.emission_range", self.emission_range, 0.001..=1000.0)?;
        within("raymarch.emission_dropoff", self.emission_dropoff, 0.0..=16.0)?;
        within("raymarch.threshold", self.threshold, 0.0..=0.999)
    }
}
