//! The uniforms of a frame, which every shader reads.

use crate::error::{Result, unsupported};
use crate::frame_input::Lights;
use crate::gpu_struct::gpu_struct;
use lamplight::internals::elevation::longest_moment;
use lamplight::internals::noise::fold;
use lamplight::internals::raymarch::stride;
use lamplight::internals::sky::{column, place};
use lamplight::settings::{Noise, Raymarch};
use lamplight::{Settings, Sky};

gpu_struct! {
    /// `FrameUniforms` of shaders/shared/uniforms.wgsl, where the fields are explained.
    pub struct FrameUniforms {
        size: [u32; 2],
        number: u32,
        seed: u32,
        zenith: [f32; 3],
        threshold: f32,
        horizon: [f32; 3],
        emission_multiplier: f32,
        ground: [f32; 3],
        wall_depth: f32,
        rays: u32,
        steps: u32,
        noise: u32,
        stride: f32,
        hit_distance: f32,
        min_step: f32,
        fade_range: f32,
        fade_dropoff: f32,
        origin: [i32; 2],
        moved: [i32; 2],
        size_before: [u32; 2],
        history: u32,
        sky_columns: u32,
        sky_origin: f32,
        elevation_tangent: f32,
        longest_moment: f32,
        /// Uniforms end at a multiple of 16 bytes.
        padding: [u32; 1],
    }
}

/// The data that a frame takes from the frames before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum History {
    None,
    /// Scattered radiance, but neither light nor matter: the sky or the size of the grid has changed.
    IndirectOnly,
    Full,
}

/// The position of a grid in the world.
#[derive(Clone, Copy, Debug)]
pub struct GridPosition {
    pub size: [u32; 2],
    /// The cell of the world that is the grid's left and top one.
    pub origin: [i32; 2],
    /// The change of `origin` since the frame before, in cells.
    pub moved: [i32; 2],
    /// The size of the grid of the frame before.
    pub size_before: [u32; 2],
}

impl FrameUniforms {
    /// The uniforms of frame `number`.
    pub fn new(
        position: GridPosition,
        lights: Lights,
        settings: &Settings,
        number: u32,
        history: History,
    ) -> Result<Self, lamplight::Error> {
        let Lights { lamps, suns, sky, inflow } = lights;
        let ([zenith, horizon, ground], panorama) = match sky {
            Sky::Uniform(radiance) => ([*radiance; 3], None),
            Sky::Gradient(g) => ([g.zenith, g.horizon, g.ground], None),
            Sky::Panorama(panorama) => ([[0.0; 3]; 3], Some(panorama)),
            other => return Err(unsupported("sky", other)),
        };
        let strip = match (inflow, panorama) {
            (Some(inflow), _) => Some((inflow.columns(), column(inflow.columns(), 0.0))),
            (None, Some(panorama)) => Some((panorama.columns().len(), place(panorama, 0.0))),
            (None, None) => None,
        };
        let (columns, origin) = strip.unwrap_or_default();
        // Without whole turns, for the precision of shaders.
        let origin = origin.rem_euclid(columns.max(1) as f64);
        // Only `raymarch` uses these settings; `cascades`, which shares its shaders, needs the defaults.
        let neutral = Raymarch::default();
        let raymarch = settings.method.as_raymarch().unwrap_or(&neutral);
        let fade_range = if raymarch.attenuation {
            raymarch.emission_range * position.size[1] as f32
        } else {
            0.0
        };
        Ok(Self {
            size: position.size,
            number,
            seed: fold(settings.seed),
            zenith,
            threshold: raymarch.threshold,
            horizon,
            emission_multiplier: raymarch.emission_multiplier,
            ground,
            wall_depth: settings.wall_depth,
            rays: raymarch.rays,
            steps: raymarch.steps,
            noise: match raymarch.noise {
                Noise::White => 0,
                Noise::Blue => 1,
                Noise::Golden => 2,
                other => return Err(unsupported("raymarch.noise", other)),
            },
            stride: stride(raymarch),
            hit_distance: raymarch.hit_distance,
            min_step: raymarch.least_step,
            fade_range,
            fade_dropoff: raymarch.emission_dropoff,
            origin: position.origin,
            moved: position.moved,
            size_before: position.size_before,
            history: match history {
                History::None => 0,
                History::IndirectOnly => 1,
                History::Full => 2,
            },
            sky_columns: columns as u32,
            sky_origin: origin as f32,
            elevation_tangent: settings.elevation.tan(),
            longest_moment: longest_moment(lamps, suns, settings.elevation),
            padding: [0; 1],
        })
    }
}
