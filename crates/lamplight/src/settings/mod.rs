//! Every knob, with its default, its range and what higher and lower values cost.
//!
//! Settings come in layers: the defaults, what a scene file says under `[light]`, what flags say.
//! A layer is a [`SettingsTable`]; [`SettingsTable::resolve`] expands presets, refuses what is
//! unknown or out of range, and gives typed [`Settings`].

mod bounces;
mod cascades;
mod flood;
mod holographic;
mod polar;
mod raymarch;
mod table;

pub use bounces::Bounces;
pub use cascades::{Cascades, Merge};
pub use flood::{Fade, Flood, Sweeps};
pub use holographic::{Holographic, Variant};
pub use polar::{Blend, Edges, Polar, Walk};
pub use raymarch::{BounceBy, Hit, Noise, Raymarch, Spacing};
pub use table::SettingsTable;

use crate::{Cells, Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// How light is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Jump flood, distance field, rays from every pixel (Bigos 2020).
    Raymarch,
    /// Rays drawn into a grid of energy, a bounce, many blurs; energy is kept between frames
    /// (tmpvar 2019). A look, not physics.
    Flood,
    /// A fan of rays from every lamp, then every pixel looks its ray up (Griffis). Lamps only.
    Polar,
    /// Probes near with few rays, far with many (radiance cascades, Sannikov 2023).
    Cascades,
    /// Rays made from shorter rays (Freeman, Sannikov and Margel 2025).
    #[default]
    Holographic,
}

impl Method {
    /// Every method, in the order in which lists show them.
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

    /// Names of the method's presets, for its key `preset`; the first is its default.
    pub fn presets(self) -> &'static [&'static str] {
        match self {
            Self::Raymarch => Raymarch::PRESETS,
            Self::Flood => Flood::PRESETS,
            Self::Polar => Polar::PRESETS,
            Self::Cascades => Cascades::PRESETS,
            Self::Holographic => Holographic::PRESETS,
        }
    }

    /// Whether it lights lamps by rule, with range, falloff and cone; the others draw them as
    /// glowing discs.
    pub fn lights_lamps(self) -> bool {
        matches!(self, Self::Flood | Self::Polar)
    }

    /// Whether one frame's light is the next one's where nothing changed: neither noise nor frames before
    /// have a say.
    pub fn repeats(self) -> bool {
        matches!(self, Self::Polar | Self::Cascades | Self::Holographic)
    }

    /// Refuses a scene that the method cannot light: `polar` needs a lamp.
    pub fn suits(self, cells: &Cells) -> Result<()> {
        if self != Self::Polar || !cells.lamps().is_empty() {
            return Ok(());
        }
        let problem = "lights lamps only, and this scene has none; add a [[lamp]], or choose another \
                       method";
        Err(Error::Unsuited { method: self.name(), problem })
    }
}

/// Everything a solver can be told.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How light is found.
    pub method: Method,
    /// How often light is sent on by walls and fog, 0 to 256 or `"converged"`. Each bounce costs
    /// one more gather over the surfaces that reflect. `polar` makes none, `flood` has its own
    /// (`flood.bounce_rays`).
    pub bounces: Bounces,
    /// px that light sinks into solid walls, 0 to 64, so that they are seen and not black; 0
    /// lights only the cells that touch open space. Costs next to nothing.
    #[schemars(range(min = 0.0, max = 64.0))]
    pub wall_depth: f32,
    /// Seed of everything random. The same seed gives the same bytes.
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

/// Mean over frames, with history dropped where what a pixel sees has changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Temporal {
    /// Most frames that the mean looks back, 0 to 4096; 0 or 1 is off. Higher: less noise on a
    /// still picture (about 1/√frames). Costs two copies of the light, no time to speak of.
    #[schemars(range(min = 0, max = 4096))]
    pub frames: u32,
    /// Drop history where emission, opacity, tint or albedo changed in what a pixel sees. Off: old
    /// light fades over `frames` frames and leaves trails.
    pub reject: bool,
}

impl Default for Temporal {
    fn default() -> Self {
        Self { frames: 0, reject: true }
    }
}

/// À-trous wavelet blur guided by opacity and distance; never crosses a wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Denoise {
    /// Passes, 0 to 6; each doubles the reach (3 reach 14 px, 5 reach 62). 0 is off. Higher:
    /// smoother with very few rays, blurrier shadows, a few ms a pass at 320×180. 3 suit 32 rays.
    #[schemars(range(min = 0, max = 6))]
    pub passes: u32,
    /// How large a difference in light, against the noise, still counts as noise, 0 to 16. Higher:
    /// smoother; lower: keeps fine shadows and more noise. 1 has about the least error.
    #[schemars(range(min = 0.0, max = 16.0))]
    pub strength: f32,
}

impl Default for Denoise {
    fn default() -> Self {
        Self { passes: 0, strength: 1.0 }
    }
}

impl Settings {
    /// The cheapest settings that have the same seed map, Voronoi map and distance field.
    #[must_use]
    pub fn fields_only(&self) -> Self {
        // Of all settings they depend on this one; a ray is the least that a frame can have.
        let threshold = self.raymarch.threshold;
        let raymarch = Raymarch { rays: 1, threshold, ..Raymarch::default() };
        Self { method: Method::Raymarch, raymarch, ..Self::default() }
    }

    /// Lays a preset of the method at hand ([`Method::presets`]) over its settings; the method's default
    /// where there is none of this name.
    pub fn lay_preset(&mut self, name: &str) {
        match self.method {
            Method::Raymarch => self.raymarch = Raymarch::preset(name).unwrap_or_default(),
            Method::Flood => self.flood = Flood::preset(name).unwrap_or_default(),
            Method::Polar => self.polar = Polar::preset(name).unwrap_or_default(),
            Method::Cascades => self.cascades = Cascades::preset(name).unwrap_or_default(),
            Method::Holographic => self.holographic = Holographic::preset(name).unwrap_or_default(),
        }
    }

    /// Refuses values out of their range.
    pub fn check(&self) -> Result<()> {
        within("bounces", self.bounces.limit(), 0..=Bounces::MAX)?;
        within("wall_depth", self.wall_depth, 0.0..=64.0)?;
        within("temporal.frames", self.temporal.frames, 0..=4096)?;
        within("denoise.passes", self.denoise.passes, 0..=6)?;
        within("denoise.strength", self.denoise.strength, 0.0..=16.0)?;
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
