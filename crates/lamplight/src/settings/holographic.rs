//! The settings of `holographic`.

use super::table::with_preset;
use super::within;
use crate::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which holographic cascades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Variant {
    /// Beams in dense directions, and a last hop that pixels trace: a third of the paper's error.
    #[default]
    Beams,
    /// As published, for comparison. The other settings are without effect; walls show, and send
    /// on, the fluence in front of them.
    Paper,
}

/// The settings of `holographic`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(transform = with_preset(Self::PRESETS))]
pub struct Holographic {
    /// Which holographic cascades.
    pub variant: Variant,
    /// Planes that pixels look at are 2^hop px apart, 1 to 4; a pixel sends 16·2^hop rays to them.
    /// Higher: fewer stars and stripes round small lights; time and memory of the last hop grow by
    /// 3 to 4 a step.
    #[schemars(range(min = 1, max = 4))]
    pub hop: u32,
    /// The last hop is at least this many px long, 1 to 16, and less than 2^hop longer; more than
    /// 2^hop counts as that. Higher: fewer stars round small lights, and time of the hop in
    /// proportion.
    #[schemars(range(min = 1, max = 16))]
    pub least: u32,
    /// Rays through each cone of the last hop where something glows, 1 to 16; elsewhere it is one.
    /// Higher: smoother light right beside small lights, for time where there are some.
    #[schemars(range(min = 1, max = 16))]
    pub rays: u32,
    /// Parallel rays of a beam, of which the traced rays of the lattice are the mean, 1 to 16.
    /// Higher: fewer stripes far from small lights, for a little time where there is matter.
    #[schemars(range(min = 1, max = 16))]
    pub beams: u32,
}

impl Default for Holographic {
    fn default() -> Self {
        Self { variant: Variant::Beams, hop: 2, least: 2, rays: 2, beams: 8 }
    }
}

impl Holographic {
    /// Names of the presets; the first is the default.
    pub const PRESETS: &'static [&'static str] = &["default", "fast", "quality", "paper"];

    /// A preset by name.
    pub fn preset(name: &str) -> Option<Self> {
        let default = Self::default();
        match name {
            "default" => Some(default),
            "fast" => Some(Self { hop: 1, least: 1, rays: 1, beams: 4, ..default }),
            "quality" => Some(Self { hop: 4, least: 6, beams: 12, ..default }),
            "paper" => Some(Self { variant: Variant::Paper, ..default }),
            _ => None,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        within("holographic.hop", self.hop, 1..=4)?;
        within("holographic.least", self.least, 1..=16)?;
        within("holographic.rays", self.rays, 1..=16)?;
        within("holographic.beams", self.beams, 1..=16)
    }
}
