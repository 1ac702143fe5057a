//! The settings of `flood`.

use super::table::with_preset;
use super::within;
use crate::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the rays of a lamp fade with distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Fade {
    /// By the lamp's own `falloff` and `range`.
    #[default]
    Lamp,
    /// By the seed's `1/(1 + ¾·D·d²)`, d in grids of D px, cut off at 0.01; the lamp's `range` only
    /// ends it.
    Seed,
}

/// In what order neighbours are mixed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sweeps {
    /// Both directions of an axis at once: symmetric, and energy is only ever passed on.
    #[default]
    Even,
    /// Right to left, left to right, up, down (the seed): left and upper sides of walls come out a
    /// little brighter. Twice the passes.
    Seed,
}

/// The settings of `flood`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(transform = with_preset(Self::PRESETS))]
pub struct Flood {
    /// Rays from each lamp, 1 to 4096. Higher: fewer fingers far from lamps; time grows with rays ×
    /// lamps.
    #[schemars(range(min = 1, max = 4096))]
    pub rays: u32,
    /// Rays from each cell that glows, and from each at the border under a sky, 0 to 4096. Time grows
    /// with it × cells that glow.
    #[schemars(range(min = 0, max = 4096))]
    pub matter_rays: u32,
    /// Rays sent on from where a ray meets a wall, 0 to 64; 0 is no bounce.
    #[schemars(range(min = 0, max = 64))]
    pub bounce_rays: u32,
    /// Rounds of blur a frame, 0 to 1024. Light flows about √(rounds/2) px a frame round corners and
    /// between rays; time grows with rounds × cells.
    #[schemars(range(min = 0, max = 1024))]
    pub rounds: u32,
    /// In what order neighbours are mixed.
    pub sweeps: Sweeps,
    /// Light that every cell loses before each frame, 0 to 1e6. Lower: lights that moved leave
    /// longer trails, and light flows farther.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub decay: f32,
    /// How lamps fade with distance.
    pub fade: Fade,
}

impl Default for Flood {
    fn default() -> Self {
        Self {
            rays: 64,
            matter_rays: 16,
            bounce_rays: 8,
            rounds: 20,
            sweeps: Sweeps::Even,
            decay: 0.125,
            fade: Fade::Lamp,
        }
    }
}

impl Flood {
    /// Names of the presets.
    pub const PRESETS: &'static [&'static str] = &["default", "seed"];

    /// A preset by name: `default`; `seed`, the source's numbers (tmpvar 2019: 16 rays, 8 bounced,
    /// 20 rounds in its order, decay 0.125, its attenuation).
    pub fn preset(name: &str) -> Option<Self> {
        match name {
            "default" => Some(Self::default()),
            "seed" => {
                Some(Self { rays: 16, sweeps: Sweeps::Seed, fade: Fade::Seed, ..Self::default() })
            }
            _ => None,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        within("flood.rays", self.rays, 1..=4096)?;
        within("flood.matter_rays", self.matter_rays, 0..=4096)?;
        within("flood.bounce_rays", self.bounce_rays, 0..=64)?;
        within("flood.rounds", self.rounds, 0..=1024)?;
        within("flood.decay", self.decay, 0.0..=1e6)
    }
}
