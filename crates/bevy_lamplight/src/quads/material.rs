//! The material of a quad.

use crate::components::{BRIGHTEST, Matter2d, NormalY};
use bevy::color::LinearRgba;
use bytemuck::{Pod, Zeroable};
use lamplight_wgpu::wgpu::TextureFormat;
use lamplight_wgpu::wgpu::TextureSampleType::Float;

/// A [`Matter2d`] with every value brought into its range; on the GPU part of an instance of shaders/quads.wgsl.
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
    /// Bits of what is drawn besides matter: the encoding of a normal map, by [`QuadMaterial::normal_encoding`], or
    /// light layers.
    pub bits: u32,
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
            bits: 0,
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
            bits: 0,
        }
    }

    /// The material of a surface that is drawn for its normals alone.
    pub fn surface(normal_encoding: u32) -> Self {
        Self { bits: normal_encoding, ..Self::zeroed() }
    }

    /// The material of what is drawn for its light layers alone.
    pub fn layers(mask: u8) -> Self {
        Self { bits: mask.into(), ..Self::zeroed() }
    }

    /// The bits by which shaders/normals.wgsl reads a normal map of a format; `None` if it holds no normals.
    pub fn normal_encoding(format: TextureFormat, y: NormalY) -> Option<u32> {
        use TextureFormat::{
            Bc5RgSnorm, EacRg11Snorm, Rg8Snorm, Rg16Snorm, Rgba8Snorm, Rgba16Snorm,
        };
        const Y_DOWN: u32 = 1;
        const SRGB: u32 = 2;
        const TWO_CHANNELS: u32 = 4;
        let is_signed = matches!(
            format,
            Rg8Snorm | Rgba8Snorm | Rg16Snorm | Rgba16Snorm | EacRg11Snorm | Bc5RgSnorm
        );
        let is_float = matches!(format.sample_type(None, None), Some(Float { .. }));
        let bit = |is_set, bit| if is_set { bit } else { 0 };
        (is_float && format.components() >= 2 && !is_signed).then(|| {
            bit(y == NormalY::Down, Y_DOWN)
                | bit(format.is_srgb(), SRGB)
                | bit(format.components() == 2, TWO_CHANNELS)
        })
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
