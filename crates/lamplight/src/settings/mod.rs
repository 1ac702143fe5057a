//! Every setting, with its default, its range, and the cost of higher and lower values.
//!
//! Settings come in layers: the defaults, the scene file's `[light]`, the flags. A layer is a
//! [`SettingsTable`]; [`SettingsTable::resolve`] expands presets, rejects unknown keys and values out
//! of range, and returns typed [`Settings`].

mod bounces;
mod cascades;
mod declare;
mod filters;
mod flood;
mod holographic;
mod polar;
mod quality;
mod raymarch;
mod table;

pub use bounces::Bounces;
pub use cascades::{Cascades, Merge};
pub use filters::{Denoise, Temporal};
pub use flood::{Fade, Flood, Sweeps};
pub use holographic::{Holographic, Variant};
pub use polar::{Blend, Edges, Polar, Walk};
pub use quality::Quality;
pub use raymarch::{BounceBy, Hit, Noise, Raymarch, Spacing};
pub use table::SettingsTable;

use crate::{Cells, Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// A method of computing light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Method {
    /// Rays from every pixel, by jump flood and distance field or from cell to cell (Bigos 2020).
    Raymarch,
    /// Rays drawn into a grid of energy, a bounce, and many blurs; the energy persists between frames
    /// (tmpvar 2019). A look, not physics.
    Flood,
    /// A polar shadow map per lamp, in which every pixel looks up its ray (Griffis). Lamps only.
    Polar,
    /// Radiance cascades: near probes with few rays, far ones with many (Sannikov 2023).
    Cascades,
    /// Holographic radiance cascades: long rays composed of shorter ones (Freeman, Sannikov and
    /// Margel 2025).
    #[default]
    Holographic,
}

impl Method {
    /// All methods, in the order of lists and tables.
    pub const ALL: &'static [Self] =
        &[Self::Raymarch, Self::Flood, Self::Polar, Self::Cascades, Self::Holographic];

    /// The name in files, flags and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Raymarch => "raymarch",
            Self::Flood => "flood",
            Self::Polar => "polar",
            Self::Cascades => "cascades",
            Self::Holographic => "holographic",
        }
    }

    /// Names of the method's presets, for its key `preset`; the first is the default.
    pub fn presets(self) -> &'static [&'static str] {
        match self {
            Self::Raymarch => Raymarch::PRESETS,
            Self::Flood => Flood::PRESETS,
            Self::Polar => Polar::PRESETS,
            Self::Cascades => Cascades::PRESETS,
            Self::Holographic => Holographic::PRESETS,
        }
    }

    /// Returns whether the method evaluates lamps analytically, with range, falloff and cone. The
    /// others draw them as glowing discs.
    pub fn lights_lamps(self) -> bool {
        matches!(self, Self::Flood | Self::Polar)
    }

    /// Returns whether a static scene yields identical frames (no noise, no history).
    pub fn repeats(self) -> bool {
        matches!(self, Self::Polar | Self::Cascades | Self::Holographic)
    }

    /// Rejects a scene that the method cannot light: `polar` needs a lamp.
    pub fn suits(self, cells: &Cells) -> Result<()> {
        if self != Self::Polar || !cells.lamps().is_empty() {
            return Ok(());
        }
        let problem = "lights lamps only, and this scene has none; add a [[lamp]], or choose another \
                       method";
        Err(Error::Unsuited { method: self.name(), problem })
    }
}

/// The settings of a solver.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// Maximum number of bounces of light off walls and fog, 0 to 256, or `"converged"`. Each bounce
    /// costs one more gather over the surfaces that reflect. `polar` makes none, `flood` has its own
    /// (`flood.bounce_rays`).
    pub bounces: Bounces,
    /// Depth in px, 0 to 64, to which light penetrates solid walls, so that they are visible; with 0
    /// only the cells that touch open space are lit. Costs next to nothing.
    #[schemars(range(min = 0.0, max = 64.0))]
    pub wall_depth: f32,
    /// Seed of all random numbers. The same seed gives the same bytes.
    pub seed: u64,
    /// Accumulation over frames.
    pub temporal: Temporal,
    /// The edge-aware blur after the rays.
    pub denoise: Denoise,
    /// The settings of `raymarch`.
    pub raymarch: Raymarch,
    /// The settings of `flood`.
    pub flood: Flood,
    /// The settings of `polar`.
    pub polar: Polar,
    /// The settings of `cascades`.
    pub cascades: Cascades,
    /// The settings of `holographic`.
    pub holographic: Holographic,
}

impl Settings {
    /// Returns the cheapest settings that have the same seed map, Voronoi map and distance field.
    #[must_use]
    pub fn fields_only(&self) -> Self {
        // Of all settings they depend on this one; a ray is the least that a frame can have.
        let threshold = self.raymarch.threshold;
        let raymarch = Raymarch { rays: 1, threshold, ..Raymarch::default() };
        Self { method: Method::Raymarch, raymarch, ..Self::default() }
    }

    /// Replaces the settings of the current method by one of its presets ([`Method::presets`]).
    ///
    /// # Errors
    /// Fails, and changes nothing, if the method has no preset of this name.
    pub fn set_preset(&mut self, name: &str) -> Result<()> {
        let found = match self.method {
            Method::Raymarch => Raymarch::preset(name).map(|preset| self.raymarch = preset),
            Method::Flood => Flood::preset(name).map(|preset| self.flood = preset),
            Method::Polar => Polar::preset(name).map(|preset| self.polar = preset),
            Method::Cascades => Cascades::preset(name).map(|preset| self.cascades = preset),
            Method::Holographic => {
                Holographic::preset(name).map(|preset| self.holographic = preset)
            }
        };
        found.ok_or_else(|| table::no_preset(self.method.name(), name, self.method.presets()))
    }

    /// Replaces the settings of the current method by its preset at a quality level.
    pub fn set_quality(&mut self, quality: Quality) -> Result<()> {
        self.set_preset(quality.preset(self.method))
    }

    /// Rejects values out of their range.
    pub fn check(&self) -> Result<()> {
        within("bounces", self.bounces.limit(), 0..=Bounces::MAX)?;
        within("wall_depth", self.wall_depth, 0.0..=64.0)?;
        self.temporal.check()?;
        self.denoise.check()?;
        self.raymarch.check()?;
        self.flood.check()?;
        self.polar.check()?;
        self.cascades.check()?;
        self.holographic.check()
    }
}

fn within<T: PartialOrd + Display>(key: &str, value: T, range: RangeInclusive<T>) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(Error::value(key, value, format!("from {} to {}", range.start(), range.end())))
}
