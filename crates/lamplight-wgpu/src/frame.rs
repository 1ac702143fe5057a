//! What every shader knows of a frame.

use bytemuck::{Pod, Zeroable};
use lamplight::methods::raymarch::gap;
use lamplight::settings::{Noise, Raymarch};
use lamplight::stages::noise::fold;
use lamplight::{Method, Settings, Sky};
#[cfg(test)]
use std::mem::offset_of;

/// `Frame` of shaders/frame.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Frame {
    size: [u32; 2],
    number: u32,
    key: u32,
    zenith: [f32; 3],
    threshold: f32,
    horizon: [f32; 3],
    multiplier: f32,
    ground: [f32; 3],
    wall_depth: f32,
    rays: u32,
    steps: u32,
    noise: u32,
    gap: f32,
    hit_distance: f32,
    least_step: f32,
    fade_range: f32,
    fade_dropoff: f32,
    origin: [i32; 2],
    moved: [i32; 2],
    memory: u32,
    /// Uniforms end at a multiple of 16 bytes.
    padding: [u32; 3],
}

/// What is remembered of the frames before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    Nothing,
    /// What surfaces sent on, but no light and no matter: the sky is another.
    Sent,
    All,
}

/// Where a grid lies.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub size: [u32; 2],
    /// The cell of the world that is its left and top one.
    pub origin: [i32; 2],
    /// By how many cells that has moved since the frame before.
    pub moved: [i32; 2],
}

impl Frame {
    /// Fields in order, with where they begin.
    #[cfg(test)]
    pub const OFFSETS: [(&'static str, usize); 20] = [
        ("size", offset_of!(Frame, size)),
        ("number", offset_of!(Frame, number)),
        ("key", offset_of!(Frame, key)),
        ("zenith", offset_of!(Frame, zenith)),
        ("threshold", offset_of!(Frame, threshold)),
        ("horizon", offset_of!(Frame, horizon)),
        ("multiplier", offset_of!(Frame, multiplier)),
        ("ground", offset_of!(Frame, ground)),
        ("wall_depth", offset_of!(Frame, wall_depth)),
        ("rays", offset_of!(Frame, rays)),
        ("steps", offset_of!(Frame, steps)),
        ("noise", offset_of!(Frame, noise)),
        ("gap", offset_of!(Frame, gap)),
        ("hit_distance", offset_of!(Frame, hit_distance)),
        ("least_step", offset_of!(Frame, least_step)),
        ("fade_range", offset_of!(Frame, fade_range)),
        ("fade_dropoff", offset_of!(Frame, fade_dropoff)),
        ("origin", offset_of!(Frame, origin)),
        ("moved", offset_of!(Frame, moved)),
        ("memory", offset_of!(Frame, memory)),
    ];

    /// Frame `number` of a grid.
    pub fn new(
        Place { size, origin, moved }: Place,
        sky: Sky,
        settings: &Settings,
        number: u32,
        memory: Memory,
    ) -> Self {
        let [zenith, horizon, ground] = match sky {
            Sky::Uniform(radiance) => [radiance; 3],
            Sky::Gradient(g) => [g.zenith, g.horizon, g.ground],
        };
        // Its settings are no other method's.
        let plain = Raymarch {
            threshold: 0.0,
            emission_multiplier: 1.0,
            attenuation: false,
            ..settings.raymarch
        };
        let raymarch =
            if settings.method == Method::Cascades { &plain } else { &settings.raymarch };
        Self {
            size,
            number,
            key: fold(settings.seed),
            zenith,
            threshold: raymarch.threshold,
            horizon,
            multiplier: raymarch.emission_multiplier,
            ground,
            wall_depth: settings.wall_depth,
            rays: raymarch.rays,
            steps: raymarch.steps,
            noise: match raymarch.noise {
                Noise::White => 0,
                Noise::Blue => 1,
                Noise::Golden => 2,
            },
            gap: gap(raymarch),
            hit_distance: raymarch.hit_distance,
            least_step: raymarch.least_step,
            fade_range: match raymarch.attenuation {
                true => raymarch.emission_range * size[1] as f32,
                false => 0.0,
            },
            fade_dropoff: raymarch.emission_dropoff,
            origin,
            moved,
            memory: match memory {
                Memory::Nothing => 0,
                Memory::Sent => 1,
                Memory::All => 2,
            },
            padding: [0; 3],
        }
    }
}
