//! The settings of `holographic`.

use super::declare::settings;
use super::preset::with_preset;
use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The variant of holographic radiance cascades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Variant {
    /// Ray bundles in dense directions, and a final gather that pixels trace: about a fifth of
    /// the published variant's error.
    #[default]
    Bundles,
    /// As published, for comparison (Freeman, Sannikov and Margel 2025). The other settings have no
    /// effect; walls show and reflect the mean radiance in front of them.
    Paper,
}

settings! {
    /// The settings of `holographic`.
    #[derive(Eq)]
    #[schemars(transform = with_preset(Self::PRESETS))]
    pub struct Holographic in "holographic" {
        /// The variant.
        variant: Variant = Variant::Bundles;
        /// Distance between neighbouring points of the lattice in px: 1, 2 or 4. Twice as far, the lattice has a quarter of
        /// the points and moves a quarter of the bytes. Pixels still trace every cell to the next plane, and walls let no
        /// light through; shadows and small lights are less sharp.
        #[schemars(extend("enum" = [1, 2, 4]))]
        lattice_spacing: u32 = 1;
        /// Level of the planes at which the final gather ends: they are 2^level px apart, no closer than points of the
        /// lattice, and a pixel sends 16·2^level ÷ `lattice_spacing` rays to them. Higher: fewer stars and stripes round
        /// small lights; time and memory of the final gather grow by 3 to 4 per level.
        gather_level: u32 = 2, in 1..=4;
        /// Minimum length of the final gather in px; its maximum is 2^level − 1 px more. Values above 2^level count as
        /// 2^level, and those that would make it longer than about 30 px as fewer. Higher: fewer stars round small lights;
        /// the gather's time grows in proportion.
        gather_length: u32 = 2, in 1..=15;
        /// Rays per cone of the final gather if something in it glows (with a `lattice_spacing` of 4, in the two cones beside
        /// the axis, if there is any matter); other cones take one. Higher: smoother light right beside small lights, for
        /// time where there are some.
        gather_rays: u32 = 3, in 1..=16;
        /// Parallel rays of a bundle; a traced ray of the lattice is their mean. Higher: fewer
        /// stripes far from small lights, for a little time where there is matter.
        bundle_rays: u32 = 8, in 1..=16;
    }
    check |settings| {
        let spacing = settings.lattice_spacing;
        if ![1, 2, 4].contains(&spacing) {
            return Err(Error::value("holographic.lattice_spacing", spacing, "1, 2 or 4"));
        }
        Ok(())
    }
}

impl Holographic {
    /// Names of the presets; the first is the default.
    pub const PRESETS: &'static [&'static str] = &["default", "fast", "coarse", "high", "paper"];

    /// Returns the preset of a name. `paper` is the method as published.
    pub fn preset(name: &str) -> Option<Self> {
        let default = Self::default();
        Some(match name {
            "default" => default,
            // A longer gather would dot the rows beside walls that light grazes: its cones are wide, and in some
            // columns the ray along the middle of the lowest would end in the wall.
            "fast" => Self { lattice_spacing: 2, gather_length: 1, gather_rays: 2, ..default },
            // Of half as many rays stars and steps around lamps would be seen.
            "coarse" => Self { lattice_spacing: 4, gather_level: 3, ..default },
            // Files of earlier versions say `quality`.
            "high" | "quality" => Self {
                gather_level: 4,
                gather_length: 6,
                gather_rays: 2,
                bundle_rays: 12,
                ..default
            },
            "paper" => Self { variant: Variant::Paper, ..default },
            _ => return None,
        })
    }
}
