//! Settings as files hold them: a table for each method, whichever is chosen.

use super::range::{MAX_WALL_DEPTH, WALL_DEPTH};
use super::{Bounces, Cascades, Denoise, Flood, Holographic, Method, Polar, Raymarch, Temporal};
use crate::{elevation, notation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The keys of `[light]`. Tables of other methods than the chosen one are read and checked, so that a
/// scene can keep settings for several methods.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "Settings")]
pub struct SettingsFile {
    /// The method.
    pub method: Method,
    /// Maximum number of bounces of light off walls and fog, 0 to 256, or `"converged"`: each costs one
    /// more gather over the surfaces that reflect. `"feedback"` adds one per frame to the light of the
    /// frame before, at the price of none; single pictures then need `--frames`. `polar` makes none,
    /// `flood` has its own (`flood.bounce_rays`).
    pub bounces: Bounces,
    /// Depth in px, 0 to 64, to which light penetrates solid walls, so that they are visible; with 0
    /// only the cells that touch open space are lit. Costs next to nothing.
    #[schemars(range(min = 0.0, max = MAX_WALL_DEPTH))]
    pub wall_depth: f32,
    /// Seed of all random numbers. The same seed gives the same bytes.
    pub seed: u64,
    /// True if the first moment of light, its mean direction, is found too. A scene with a layer of normals has it found
    /// in any case. Costs up to a quarter more time.
    #[serde(skip_serializing_if = "is_false")]
    pub moment: bool,
    /// The elevation above the plane at which light arrives at surfaces with normals, radians (or degrees as text,
    /// `"45deg"`), 0.05 to 1.5; lamps with a `height` and suns may have their own. Lower: stronger relief, with darker
    /// slopes.
    #[serde(deserialize_with = "notation::angle", skip_serializing_if = "is_default_elevation")]
    #[schemars(with = "notation::Angle")]
    pub elevation: f32,
    /// Accumulation over frames, after `raymarch`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Temporal")]
    pub temporal: Option<Temporal>,
    /// The edge-aware blur after the rays of `raymarch`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Denoise")]
    pub denoise: Option<Denoise>,
    /// The settings of `raymarch`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Raymarch")]
    pub raymarch: Option<Raymarch>,
    /// The settings of `flood`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Flood")]
    pub flood: Option<Flood>,
    /// The settings of `polar`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Polar")]
    pub polar: Option<Polar>,
    /// The settings of `cascades`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Cascades")]
    pub cascades: Option<Cascades>,
    /// The settings of `holographic`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Holographic")]
    pub holographic: Option<Holographic>,
}

impl Default for SettingsFile {
    fn default() -> Self {
        Self {
            method: Method::default(),
            bounces: Bounces::default(),
            wall_depth: WALL_DEPTH,
            seed: 0,
            moment: false,
            elevation: elevation::DEFAULT,
            temporal: None,
            denoise: None,
            raymarch: None,
            flood: None,
            polar: None,
            cascades: None,
            holographic: None,
        }
    }
}

fn is_default_elevation(value: &f32) -> bool {
    *value == elevation::DEFAULT
}

fn is_false(value: &bool) -> bool {
    !value
}
