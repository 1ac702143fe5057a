//! What a body is made of.

use crate::components::{BRIGHTEST, Matter2d};
use bevy::color::LinearRgba;
use bytemuck::{Pod, Zeroable};

/// A [`Matter2d`] that is right whatever was written there; `Substance` of shaders/pieces.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Substance {
    pub emission: [f32; 3],
    /// Lost in a world unit.
    pub opacity: f32,
    /// Of a world unit.
    pub tint: [f32; 3],
    /// Radiance that is seen on the screen where it lies.
    pub glow: f32,
    pub albedo: [f32; 3],
    pub unused: f32,
}

impl Substance {
    /// What is neither a number nor in range becomes the nearest that is.
    pub fn of(matter: &Matter2d) -> Self {
        let within = |v: f32, most: f32| if v > 0.0 { v.min(most) } else { 0.0 };
        let rgb =
            |color: LinearRgba, most| [color.red, color.green, color.blue].map(|v| within(v, most));
        Self {
            emission: rgb(matter.emission, BRIGHTEST),
            opacity: within(matter.opacity, 1.0),
            tint: rgb(matter.tint, 1.0),
            glow: 1.0,
            albedo: rgb(matter.albedo, 1.0),
            unused: 0.0,
        }
    }

    /// A lamp's disc.
    pub fn lamp(emission: [f32; 3]) -> Self {
        Self {
            emission,
            opacity: 1.0,
            tint: [1.0; 3],
            // Half of the directions from a place at its edge see it: so bright is the air beside it.
            glow: 0.5,
            albedo: [0.0; 3],
            unused: 0.0,
        }
    }

    /// Share of light lost in a cell of so many world units, and its tint.
    pub fn over(&self, cell: f32) -> (f32, [f32; 3]) {
        (1.0 - (1.0 - self.opacity).powf(cell), self.tint.map(|v| v.powf(cell)))
    }

    /// Whether it shows on the screen by itself.
    pub fn glows(&self) -> bool {
        self.emission != [0.0; 3]
    }
}
