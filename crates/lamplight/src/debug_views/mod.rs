//! Debug views: pictures of what a frame works with.
//!
//! The functions of this module show cells and the fields of the stages before the rays.
//! [`Solver::debug_view`] shows the intermediates of a method: empty-space skips, shadow maps,
//! cascades, intervals. They belong to the last solved frame. Those that a method discards while it
//! works (cascades and intervals, as soon as they are merged) are computed again on request, which
//! costs about a frame.

mod fields;

pub(crate) use fields::empty_space;
pub use fields::{albedo, distance, emission, emitted, opacity, seeds, tint, visibility};

use crate::settings::{Hit, MethodSettings, Variant};
use crate::{Display, Solver};
use image::RgbImage;

/// A picture of one intermediate of a method.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct DebugView {
    /// The name, for lists.
    pub name: String,
    /// A description in one line.
    pub description: &'static str,
    /// The picture; its size depends on the intermediate.
    pub picture: RgbImage,
}

impl DebugView {
    fn new(name: impl Into<String>, description: &'static str, picture: RgbImage) -> Self {
        Self { name: name.into(), description, picture }
    }
}

/// Quadrants of directions, in the order in which empty-space skips are stored.
const QUADRANTS: [&str; 4] = ["right and down", "left and down", "right and up", "left and up"];

impl Solver {
    /// Number of debug views of the last frame: 0 before the first one, and for the variants that
    /// keep nothing but fields (`hit = "distance"`) or exist for comparison (`variant = "paper"`).
    pub fn debug_view_count(&self) -> u32 {
        if self.light().pixels().is_empty() {
            return 0;
        }
        match &self.settings().method {
            MethodSettings::Raymarch(settings) if settings.hit == Hit::Distance => 0,
            MethodSettings::Raymarch(_) => QUADRANTS.len() as u32,
            MethodSettings::Polar(_) | MethodSettings::Flood(_) => 1,
            MethodSettings::Cascades(_) => self.cascades.farther().len() as u32,
            MethodSettings::Holographic(settings) if settings.variant == Variant::Paper => 0,
            MethodSettings::Holographic(settings) => {
                let [first, end] = self.holographic.interval_levels(&self.cells, settings);
                end - first
            }
        }
    }

    /// Returns a debug view of the last frame by its number, or `None` from
    /// [`Self::debug_view_count`] on. Light is shown through `display`.
    pub fn debug_view(&mut self, number: u32, display: &Display) -> Option<DebugView> {
        if number >= self.debug_view_count() {
            return None;
        }
        let (at, width) = (number as usize, self.cells.width());
        let method = self.settings().method.clone();
        Some(match &method {
            MethodSettings::Raymarch(_) => DebugView::new(
                format!("empty space {}", QUADRANTS[at]),
                "how far a ray may skip at once; bright is far",
                empty_space(width, self.raymarch.squares(at)),
            ),
            MethodSettings::Polar(_) => DebugView::new(
                "shadow maps",
                "a strip per lamp: angle to the right, px from the lamp downwards, up to the ray's end",
                self.polar.ray_textures(),
            ),
            MethodSettings::Flood(_) => {
                let energy: Vec<_> = self.stages().energy.iter().map(|&v| [v; 3]).collect();
                let picture = display.picture(width, self.cells.height(), &energy);
                DebugView::new("energy", "the energy that rays deposit, without colour", picture)
            }
            MethodSettings::Cascades(settings) => {
                let number = number + 1;
                DebugView::new(
                    format!("cascade {number}"),
                    "the radiance at each probe, a tile per cone of directions",
                    self.cascades.debug_view(&self.cells, settings, number, display),
                )
            }
            MethodSettings::Holographic(settings) => {
                let [first, _] = self.holographic.interval_levels(&self.cells, settings);
                let level = first + number;
                DebugView::new(
                    format!("intervals of level {level}"),
                    "rays to the right: a band per plane, a column per direction, blue where they pass",
                    self.holographic.debug_view(&self.cells, settings, level, display),
                )
            }
        })
    }
}
