//! The settings of `cascades`.

use super::table::with_preset;
use super::within;
use crate::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the light of one cascade is handed to the next nearer one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Merge {
    /// One ray, then the mean of the four probes around by bilinear weights. Fast; shadows ring and
    /// light leaks through thin walls, as a ray does not end where the next one starts.
    Plain,
    /// A ray to each of the four probes, exactly to where its own rays start, so that every path
    /// is unbroken: nothing leaks. Four times the rays.
    #[default]
    BilinearFix,
}

/// The settings of `cascades`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(transform = with_preset(Self::PRESETS))]
pub struct Cascades {
    /// How cascades are merged.
    pub merge: Merge,
    /// Rays of the nearest cascade, 4, 16 or 64; each further one has four times as many. Time
    /// grows with it; more rays see smaller lights. 0 is 4 with `merge = "plain"`, else 16.
    #[schemars(extend("enum" = [0, 4, 16, 64]))]
    pub rays: u32,
    /// px that the rays of the nearest cascade reach, 0.25 to 64; each further one reaches four
    /// times as far. Higher: softer steps from one cascade to the next, but lights may fall between
    /// two rays. 0 is what has the least error: 1.5, 3 and 8 with 4, 16 and 64 rays.
    #[schemars(range(min = 0.0, max = 64.0))]
    pub interval: f32,
    /// Probes of the c-th further cascade stand `spacing·2^c` px apart, 0.5 to 8 (the nearest one
    /// has a probe at every px). Lower: sharper penumbrae; time and memory grow as 1/spacing².
    #[schemars(range(min = 0.5, max = 8.0))]
    pub spacing: f32,
    /// Share of its length by which each interval reaches into the next, 0 to 1. Higher: with
    /// `merge = "plain"` less light leaks, contact shadows get darker, and fog counts twice.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub overlap: f32,
}

impl Default for Cascades {
    fn default() -> Self {
        Self { merge: Merge::default(), rays: 0, interval: 0.0, spacing: 1.0, overlap: 0.0 }
    }
}

impl Cascades {
    /// Names of the presets.
    pub const PRESETS: &'static [&'static str] = &["default", "plain", "quality"];

    /// A preset by name: `default`, the bilinear fix with 16 rays; `plain`, cascades as first
    /// published, with 4 rays (Sannikov 2023); `quality`, the bilinear fix with 64 rays.
    pub fn preset(name: &str) -> Option<Self> {
        match name {
            "default" => Some(Self::default()),
            "plain" => Some(Self { merge: Merge::Plain, ..Self::default() }),
            "quality" => Some(Self { rays: 64, ..Self::default() }),
            _ => None,
        }
    }

    /// Rays of the nearest cascade, with 0 made out.
    pub fn nearest_rays(&self) -> u32 {
        match (self.rays, self.merge) {
            (0, Merge::Plain) => 4,
            (0, Merge::BilinearFix) => 16,
            (rays, _) => rays,
        }
    }

    /// px that they reach, with 0 made out.
    pub fn nearest_interval(&self) -> f32 {
        match (self.interval, self.nearest_rays()) {
            (0.0, 4) => 1.5,
            (0.0, 16) => 3.0,
            (0.0, _) => 8.0,
            (interval, _) => interval,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        if ![0, 4, 16, 64].contains(&self.rays) {
            return Err(Error::value("cascades.rays", self.rays, "0, 4, 16 or 64"));
        }
        if self.interval != 0.0 {
            within("cascades.interval", self.interval, 0.25..=64.0)?;
        }
        within("cascades.spacing", self.spacing, 0.5..=8.0)?;
        within("cascades.overlap", self.overlap, 0.0..=1.0)
    }
}
