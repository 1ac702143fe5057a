//! The settings of `cascades`.

use super::declare::settings;
use super::preset::with_preset;
use super::range::within;
use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The rule by which the light of one cascade is merged into the next nearer one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Merge {
    /// One ray, then the bilinear mean of the four surrounding probes. Fast; shadows ring and light
    /// leaks through thin walls, because a ray does not end where the next one starts.
    Plain,
    /// One ray to each of the four probes, exactly to where the probe's own rays start, so that
    /// every path is unbroken and nothing leaks. Four times the rays.
    #[default]
    BilinearFix,
}

settings! {
    /// The settings of `cascades`.
    #[schemars(transform = with_preset(Self::PRESETS))]
    pub struct Cascades in "cascades" {
        /// The merging rule.
        merge: Merge = Merge::BilinearFix;
        /// Rays of the nearest cascade: 4, 16 or 64. Each further cascade has four times as many.
        /// Time grows in proportion; more rays resolve smaller lights. 0 chooses 4 with
        /// `merge = "plain"`, else 16.
        #[schemars(extend("enum" = [0, 4, 16, 64]))]
        rays: u32 = 0;
        /// Length in px of the nearest cascade's rays, 0 or from 0.25. Each further cascade reaches
        /// four times as far. Higher: softer steps from one cascade to the next, but lights may
        /// fall between two rays. 0 chooses the length with the least error: 1.5, 3 and 8 for 4, 16
        /// and 64 rays.
        interval: f32 = 0.0, in 0.0..=64.0;
        /// Distance between probes in px: `spacing·2^c` in the c-th further cascade (the nearest one
        /// has a probe in every pixel). Lower: sharper penumbrae; time and memory grow as 1/spacing².
        spacing: f32 = 1.0, in 0.5..=8.0;
        /// Fraction of its length by which each interval extends into the next. Higher: with
        /// `merge = "plain"` less light leaks, contact shadows get darker, and fog counts twice.
        overlap: f32 = 0.0, in 0.0..=1.0;
    }
    check |settings| {
        if ![0, 4, 16, 64].contains(&settings.rays) {
            return Err(Error::value("cascades.rays", settings.rays, "0, 4, 16 or 64"));
        }
        if settings.interval != 0.0 {
            within("cascades.interval", settings.interval, 0.25..=64.0)?;
        }
        Ok(())
    }
}

impl Cascades {
    /// Names of the presets; the first is the default.
    pub const PRESETS: &'static [&'static str] = &["default", "fast", "high", "plain"];

    /// Returns the preset of a name.
    ///
    /// `fast`, `default` and `high` use the bilinear fix with 4, 16 and 64 rays. `plain` is radiance
    /// cascades as first published, with 4 rays (Sannikov 2023).
    pub fn preset(name: &str) -> Option<Self> {
        Some(match name {
            "default" => Self::default(),
            "fast" => Self { rays: 4, ..Self::default() },
            // Files of earlier versions say `quality`.
            "high" | "quality" => Self { rays: 64, ..Self::default() },
            "plain" => Self { merge: Merge::Plain, ..Self::default() },
            _ => return None,
        })
    }

    /// Rays of the nearest cascade, with 0 resolved.
    pub fn nearest_rays(&self) -> u32 {
        match (self.rays, self.merge) {
            (0, Merge::Plain) => 4,
            (0, Merge::BilinearFix) => 16,
            (rays, _) => rays,
        }
    }

    /// Length of the nearest cascade's rays in px, with 0 resolved.
    pub fn nearest_interval(&self) -> f32 {
        match (self.interval, self.nearest_rays()) {
            (0.0, 4) => 1.5,
            (0.0, 16) => 3.0,
            (0.0, _) => 8.0,
            (interval, _) => interval,
        }
    }
}
