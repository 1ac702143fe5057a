//! Lamps: point-like lights with a range, and how they are drawn as glowing discs.

use crate::scene::coverage::{self, Window};
use crate::{Cells, Matter, Result, Rgb, check, exact, lamp_gain};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// How the light of a lamp fades with distance in the methods that light lamps by rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Falloff {
    /// `1 − d/range`.
    #[default]
    Linear,
    /// `(1 − (d/range)²)²`.
    Smooth,
    /// About `1/d`, brought to 0 at the range.
    Inverse,
}

/// A lamp.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// Centre, px.
    #[serde(deserialize_with = "exact::one")]
    pub position: [f32; 2],
    /// Colour, linear RGB.
    #[serde(default = "default_color", deserialize_with = "exact::one")]
    pub color: Rgb,
    /// Multiplies the colour, 0 to 1e6; 0 is off.
    #[serde(default = "default_intensity")]
    pub intensity: f32,
    /// px reached, in the methods that light lamps by rule; 1 to 100 000.
    #[serde(default = "default_range")]
    pub range: f32,
    /// Radius of the glowing disc, px, 0.05 to 512. Its light at a distance grows with it; its
    /// shadows get softer.
    #[serde(default = "default_size")]
    pub size: f32,
    /// How the light fades, in the methods that light lamps by rule.
    #[serde(default)]
    pub falloff: Falloff,
}

fn default_color() -> Rgb {
    Lamp::default().color
}

fn default_intensity() -> f32 {
    Lamp::default().intensity
}

fn default_range() -> f32 {
    Lamp::default().range
}

fn default_size() -> f32 {
    Lamp::default().size
}

impl Default for Lamp {
    fn default() -> Self {
        Self {
            position: [0.0; 2],
            color: [1.0; 3],
            intensity: 1.0,
            range: 128.0,
            size: 2.0,
            falloff: Falloff::Linear,
        }
    }
}

impl Lamp {
    /// Refuses values that no lamp has; `key` names the lamp in the message.
    pub fn check(&self, key: &dyn Display) -> Result<()> {
        check::point(format_args!("{key}.position"), self.position)?;
        check::radiance(format_args!("{key}.color"), self.color)?;
        check::number(format_args!("{key}.intensity"), self.intensity, 0.0..=1e6)?;
        check::number(format_args!("{key}.range"), self.range, 1.0..=1e5)?;
        check::number(format_args!("{key}.size"), self.size, 0.05..=512.0)
    }

    /// Draws the lamp into the matter: a solid disc of radius `size`, by the share of each cell
    /// that it covers, with emission `color·intensity`, times a gain near 1 that makes
    /// up for the grid (`lamp_gain`). A
    /// lamp that is off is not there.
    pub(crate) fn draw(&self, cells: &mut Cells) {
        let center = self.position.map(f64::from);
        let radius = f64::from(self.size);
        let grid = Window::grid(cells.width(), cells.height());
        let disc = Window::around(center.map(|v| v - radius), center.map(|v| v + radius));
        let seen = disc.and(&grid);
        let off = self.intensity == 0.0 || self.color == [0.0; 3];
        if off || seen.x.is_empty() || seen.y.is_empty() {
            return;
        }
        let strength = self.intensity * lamp_gain::gain(center, radius);
        let matter =
            Matter { emission: self.color.map(|c| c * strength), opacity: 1.0, ..Matter::EMPTY };
        coverage::disc_shares(center, radius, &grid, |x, y, share| {
            let i = cells.index(x as u32, y as u32);
            cells.set_matter(i, matter.over(cells.matter(i), share));
        });
    }
}
