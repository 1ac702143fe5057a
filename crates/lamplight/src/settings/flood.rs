//! The settings of `flood`.

use super::declare::settings;
use super::preset::with_preset;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The attenuation of a lamp's rays with distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Fade {
    /// The lamp's own `falloff` and `range`.
    #[default]
    Lamp,
    /// `1/(1 + ¾·D·d²)` (tmpvar 2019), d in grids of D px, cut off at 0.01; the lamp's `range` only
    /// ends it.
    Seed,
}

/// The order in which neighbours are mixed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Sweeps {
    /// Both directions of an axis at once: symmetric, and energy is conserved.
    #[default]
    Even,
    /// Right to left, left to right, up, down (tmpvar 2019): left and upper sides of walls come out
    /// a little brighter. Twice the passes.
    Seed,
}

settings! {
    /// The settings of `flood`.
    #[schemars(transform = with_preset(Self::PRESETS))]
    pub struct Flood in "flood" {
        /// Rays per lamp. Higher: fewer fingers far from lamps; time grows with rays × lamps. Where rays
        /// are more than 1 px apart, each is as much brighter.
        rays: u32 = 256, in 1..=4096;
        /// Rays per glowing cell, and per border cell under a sky. Time grows with rays × glowing
        /// cells.
        matter_rays: u32 = 16, in 0..=4096;
        /// Rays reflected from the point at which a ray meets a wall; 0 turns the bounce off.
        bounce_rays: u32 = 8, in 0..=64;
        /// Rounds of blur per frame. Light spreads by about √(rounds/2) px per frame round corners
        /// and between rays; time grows with rounds × cells.
        rounds: u32 = 20, in 0..=1024;
        /// The order in which neighbours are mixed.
        sweeps: Sweeps = Sweeps::Even;
        /// Light that every cell loses before each frame. Lower: moving lights leave longer trails,
        /// and light spreads farther.
        decay: f32 = 0.125, in 0.0..=1e6;
        /// The attenuation of lamps with distance.
        fade: Fade = Fade::Lamp;
    }
}

impl Flood {
    /// Names of the presets; the first is the default.
    pub const PRESETS: &'static [&'static str] = &["default", "fast", "high", "seed"];

    /// Returns the preset of a name.
    ///
    /// `fast` and `high` take half and twice the rays. `seed` has the numbers of tmpvar 2019
    /// (16 rays, 8 reflected, 20 rounds in its order, decay 0.125, its attenuation).
    pub fn preset(name: &str) -> Option<Self> {
        let default = Self::default();
        Some(match name {
            "default" => default,
            "fast" => Self { rays: 128, matter_rays: 8, bounce_rays: 4, ..default },
            "high" => Self { rays: 512, matter_rays: 32, bounce_rays: 16, ..default },
            "seed" => Self { rays: 16, sweeps: Sweeps::Seed, fade: Fade::Seed, ..default },
            _ => return None,
        })
    }
}
