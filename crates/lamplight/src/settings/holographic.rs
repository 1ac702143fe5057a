//! The settings of `holographic`.

use super::table::preset_property;
use super::within;
use crate::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of `holographic`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend("properties" = preset_property(Self::PRESETS)))]
pub struct Holographic {
    /// The last hop is up to 2^hop px long, 1 to 5; a pixel sends 16·2^hop·rays rays over it.
    /// Higher: fewer stars and stripes round small lights; the time of the hop grows by 4 a step.
    pub hop: u32,
    /// The last hop is at least this many px long, 1 to 2^hop, and less than 2^hop longer. Higher:
    /// fewer stars round small lights, and time of the hop in proportion.
    pub least: u32,
    /// Rays through each cone of the last hop where something glows, 1 to 16; elsewhere it is one.
    /// Higher: smoother light right beside small lights, for time where there are some.
    pub rays: u32,
    /// Parallel rays of a beam, of which the traced rays of the lattice are the mean, 1 to 16.
    /// Higher: fewer stripes far from small lights, for a little time where there is matter.
    pub beams: u32,
}

impl Default for Holographic {
    fn default() -> Self {
        Self { hop: 3, least: 1, rays: 4, beams: 8 }
    }
}

impl Holographic {
    /// Names of the presets.
    pub const PRESETS: &'static [&'static str] = &["default", "fast", "quality"];

    /// A preset by name.
    pub fn preset(name: &str) -> Option<Self> {
        match name {
            "default" => Some(Self::default()),
            "fast" => Some(Self { hop: 2, least: 1, rays: 2, beams: 4 }),
            "quality" => Some(Self { hop: 4, least: 8, rays: 4, beams: 8 }),
            _ => None,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        within("holographic.hop", self.hop, 1..=5)?;
        within("holographic.least", self.least, 1..=1 << self.hop)?;
        within("holographic.rays", self.rays, 1..=16)?;
        within("holographic.beams", self.beams, 1..=16)
    }
}
