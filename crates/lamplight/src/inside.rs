//! What a method keeps to itself, as pictures: ray textures, clear squares, cascades, intervals.
//!
//! They are of the last frame that a [`Solver`] found. Those that a method throws away while it works
//! (cascades and intervals are gone as soon as they are merged) are made again when they are asked for,
//! which costs about a frame.

use crate::frame::Solver;
use crate::settings::{Hit, Variant};
use crate::{Display, Method, views};
use image::RgbImage;

/// A picture of something that a method works with.
#[derive(Clone, Debug)]
pub struct Inside {
    /// Its name in a list.
    pub name: String,
    /// What is to be seen, in a line.
    pub words: &'static str,
    /// The picture; its size is its own.
    pub picture: RgbImage,
}

/// Quadrants of directions, as clear squares are held.
const QUADRANTS: [&str; 4] = ["right and down", "left and down", "right and up", "left and up"];

impl Solver {
    /// Number of pictures of the inside of the last frame: 0 before it, and for the rules that keep
    /// nothing but fields (`hit = "distance"`) or are there for comparison (`variant = "paper"`).
    pub fn insides(&self) -> u32 {
        let settings = self.settings();
        if self.light().pixels().is_empty() {
            return 0;
        }
        match settings.method {
            Method::Raymarch if settings.raymarch.hit == Hit::Distance => 0,
            Method::Raymarch => QUADRANTS.len() as u32,
            Method::Polar | Method::Flood => 1,
            Method::Cascades => self.cascades.further().len() as u32,
            Method::Holographic if settings.holographic.variant == Variant::Paper => 0,
            Method::Holographic => {
                let [first, end] = self.holographic.held(&self.cells, settings);
                end - first
            }
        }
    }

    /// A picture of the inside of the last frame, by its number; light is shown through `display`.
    /// None from [`Self::insides`] on.
    pub fn inside(&mut self, number: u32, display: &Display) -> Option<Inside> {
        if number >= self.insides() {
            return None;
        }
        let (at, width) = (number as usize, self.cells.width());
        Some(match self.settings().method {
            Method::Raymarch => Inside {
                name: format!("leaps {}", QUADRANTS[at]),
                words: "clear squares: how far a ray may leap at once, bright is far",
                picture: views::squares(width, self.raymarch.squares(at)),
            },
            Method::Polar => Inside {
                name: "ray textures".to_owned(),
                words: "a strip a lamp: angle to the right, px from the lamp downwards, as far as rays come",
                picture: self.polar.ray_textures(),
            },
            Method::Flood => {
                let energy: Vec<_> = self.stages().energy.iter().map(|&v| [v; 3]).collect();
                Inside {
                    name: "energy".to_owned(),
                    words: "what rays leave behind, without colour",
                    picture: display.picture(width, self.cells.height(), &energy),
                }
            }
            Method::Cascades => {
                let number = number + 1;
                Inside {
                    name: format!("cascade {number}"),
                    words: "what probes see, a tile for each cone of directions",
                    picture: self.cascades.inside(&self.cells, &self.settings, number, display),
                }
            }
            Method::Holographic => {
                let [first, _] = self.holographic.held(&self.cells, &self.settings);
                let level = first + number;
                Inside {
                    name: format!("intervals of level {level}"),
                    words: "rays to the right: a band a plane, a column a direction, blue where they get through",
                    picture: self.holographic.inside(&self.cells, &self.settings, level, display),
                }
            }
        })
    }
}
