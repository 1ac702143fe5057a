//! The settings of `polar`.

use super::table::with_preset;
use super::within;
use crate::{Falloff, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a ray finds its way out from the lamp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Walk {
    /// From cell edge to cell edge: lengths are exact, no cell is stepped over.
    #[default]
    Edge,
    /// A px at a time (the seed): up to 1 px too long, and clipped corners of cells are missed.
    Step,
    /// In leaps by the distance field, a px at a time near matter: as `step`; the field costs some
    /// ms a frame and pays for few large lamps in the open.
    Distance,
}

/// What the edge of a shadow looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Edges {
    /// As wide as the lamp's `size` makes it, and at least a ray. Costs about a third more.
    #[default]
    Soft,
    /// Linear between two rays: crisp, without stairs.
    Linear,
    /// By the nearest ray (the seed): stairs a px high at the lamp's range.
    Nearest,
}

/// How the light of several lamps comes together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Blend {
    /// The sum, as light does.
    #[default]
    Add,
    /// The brightest lamp, channel by channel: overlaps do not brighten.
    Max,
    /// `1 − Π(1 − light)`, each lamp's light cut off at 1: overlaps brighten and never pass 1.
    Screen,
}

/// The settings of `polar`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(transform = with_preset(Self::PRESETS))]
pub struct Polar {
    /// Rays a px of the circle that a lamp reaches, 0.25 to 8: a lamp of range R has `⌈2πR·density⌉`.
    /// Higher: finer shadows of thin things; walking costs grow with it, lighting pixels does not.
    #[schemars(range(min = 0.25, max = 8.0))]
    pub density: f32,
    /// How a ray finds its way.
    pub walk: Walk,
    /// What the edge of a shadow looks like.
    pub edges: Edges,
    /// Fog and glass darken and tint what passes. Off: all that is not empty ends a ray (the seed).
    pub translucent: bool,
    /// How lamps come together.
    pub blend: Blend,
    /// The curve by which all lamps fade; left out, each fades by its own `falloff`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub falloff: Option<Falloff>,
}

impl Default for Polar {
    fn default() -> Self {
        Self {
            density: 1.0,
            walk: Walk::Edge,
            edges: Edges::Soft,
            translucent: true,
            blend: Blend::Add,
            falloff: None,
        }
    }
}

impl Polar {
    /// Names of the presets.
    pub const PRESETS: &'static [&'static str] = &["default", "gamemaker", "disc"];

    /// A preset by name: `default`; `gamemaker`, as the seed does it (Griffis: 2πR rays, a px at a
    /// time, the nearest ray, whatever is there ends a ray, lamps add up); `disc`, in which
    /// lamps give as much light as the glowing discs that other methods draw.
    pub fn preset(name: &str) -> Option<Self> {
        match name {
            "default" => Some(Self::default()),
            "gamemaker" => Some(Self {
                walk: Walk::Step,
                edges: Edges::Nearest,
                translucent: false,
                ..Self::default()
            }),
            "disc" => Some(Self { falloff: Some(Falloff::Inverse), ..Self::default() }),
            _ => None,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        within("polar.density", self.density, 0.25..=8.0)
    }
}
