//! The material of a quad.

use crate::components::{BRIGHTEST, Matter2d};
use bevy::color::LinearRgba;
use bytemuck::{Pod, Zeroable};

/// A [`Matter2d`] with every value brought into its range; `Material` of shaders/quads.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct QuadMaterial {
    /// Emitted radiance.
    pub emission: [f32; 3],
    /// Fraction of light lost per world unit.
    pub opacity: f32,
    /// Transmittance per world unit and channel, opacity aside.
    pub tint: [f32; 3],
    /// Fraction of the emitted radiance that the screen shows at the quad itself.
    pub glow: f32,
    /// Scattering albedo.
    pub albedo: [f32; 3],
    /// Padding to WGSL's alignment.
    pub unused: f32,
}

impl QuadMaterial {
    /// The material of matter. Values out of range, and NaN, become the nearest that is in range.
    pub fn new(matter: &Matter2d) -> Self {
        let within = |v: f32, max: f32| if v > 0.0 { v.min(max) } else { 0.0 };
        let rgb =
            |color: LinearRgba, max| [color.red, color.green, color.blue].map(|v| within(v, max));
        Self {
            emission: rgb(matter.emission, BRIGHTEST),
            opacity: within(matter.opacity, 1.0),
            tint: rgb(matter.tint, 1.0),
            glow: 1.0,
            albedo: rgb(matter.albedo, 1.0),
            unused: 0.0,
        }
    }

    /// The material of a lamp's disc.
    pub fn lamp(emission: [f32; 3]) -> Self {
        Self {
            emission,
            opacity: 1.0,
            tint: [1.0; 3],
            // A place at the disc's edge sees it in half of all directions, so the air beside it has
            // half of its radiance.
            glow: 0.5,
            albedo: [0.0; 3],
            unused: 0.0,
        }
    }

    /// The opacity and tint of a cell that is `cell` world units wide.
    pub fn over(&self, cell: f32) -> (f32, [f32; 3]) {
        (1.0 - (1.0 - self.opacity).powf(cell), self.tint.map(|v| v.powf(cell)))
    }

    /// Returns whether it emits light.
    pub fn glows(&self) -> bool {
        self.emission != [0.0; 3]
    }
}
