//! The direct light of lamps with exact light ([`Method::lights_exactly`](lamplight::Method::lights_exactly)) and of
//! suns, for methods that find all other light themselves.
//!
//! One dispatch finds what every open cell and every face receives from all lamps, one adds the suns. Methods add it
//! to what surfaces scatter in each bounce, and to the light at the end. Visibility is exact, without a shadow map:
//! a cell goes through the blocks of cells in the triangle between itself and the light. Cost: about
//! `d/4 · (1 + s/4)` words of classes per cell and light at distance d and of size s.

use crate::compiler::Compiler;
use crate::cookies::CookieAtlas;
use crate::error::Result;
use crate::found_light::FoundLight;
use crate::gpu_struct::gpu_struct;
use crate::lamps::{Capacity, LampList, LampRays};
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::stages::class::ClassPipeline;
use crate::{programs, shaders};
use lamplight::internals::elevation::of_sun;
use lamplight::internals::{MAX_OPTICAL_DEPTH, polar};
use lamplight::settings::Polar;
use lamplight::{Lamp, Settings};
use wgpu::{Buffer, Queue};

/// Side of a tile, px.
const TILE: u32 = 16;
/// Values per cell: four faces, of which an open cell uses the first.
const FACES: u32 = 4;
/// Bytes before the suns: their number.
const HEAD: u64 = size_of::<[u32; 4]>() as u64;

gpu_struct! {
    /// `Sun` of shaders/stages/direct.wgsl, where the fields are explained.
    pub struct Sun {
        travels: [f32; 2],
        slope: f32,
        width: f32,
        radiance: [f32; 3],
        mask: u32,
        moment_weight: f32,
        /// Elements of arrays end at a multiple of 16 bytes.
        padding: [u32; 3],
    }
}

/// The lights of a frame before they are written to the GPU.
#[derive(Debug, Default)]
pub struct DirectLights {
    lamps: LampList,
    suns: Vec<Sun>,
}

impl DirectLights {
    /// Replaces the lights by the suns and lamps that the method of the settings lights exactly.
    pub fn set(
        &mut self,
        settings: &Settings,
        lamps: &[Lamp],
        cookies: &CookieAtlas,
        suns: &[lamplight::Sun],
        size: [u32; 2],
    ) -> lamplight::Result<()> {
        let polar = Polar::default();
        let rays = |lamp: &Lamp| {
            let (reach, _) = polar::rays(lamp, size, &polar);
            Ok(LampRays { reach, count: 0, soft: 0.0, falloff: Some(lamp.falloff) })
        };
        let exact = |lamp: &&Lamp| settings.method().lights_exactly(lamp);
        self.lamps.set(lamps.iter().filter(exact), cookies, rays)?;
        self.suns.clear();
        let exact = |sun: &&lamplight::Sun| settings.method().shines_exactly(sun);
        self.suns.extend(suns.iter().filter(exact).map(|sun| Sun {
            travels: [sun.direction.cos(), sun.direction.sin()],
            slope: (0.5 * sun.angle).tan(),
            width: sun.angle,
            radiance: sun.radiance(),
            mask: sun.mask.into(),
            moment_weight: of_sun(sun, settings.elevation.tan()),
            padding: [0; 3],
        }));
        Ok(())
    }

    /// The capacity that the lights need.
    pub fn needed(&self) -> Capacity {
        let exact_lamps = self.lamps.needed().lamps;
        Capacity { exact_lamps, suns: self.suns.len() as u64, ..Capacity::default() }
    }

    /// Writes the lights to the buffers of a plan.
    pub fn write(&self, queue: &Queue, buffers: &LightBuffers) {
        self.lamps.write(queue, &buffers.lamps);
        let head = [self.suns.len() as u32, 0, 0, 0];
        queue.write_buffer(&buffers.suns, 0, bytemuck::bytes_of(&head));
        queue.write_buffer(&buffers.suns, HEAD, bytemuck::cast_slice(&self.suns));
    }
}

/// The buffers that lights are written to before each frame.
#[derive(Debug)]
pub struct LightBuffers {
    lamps: Buffer,
    suns: Buffer,
}

/// The pipelines.
#[derive(Debug)]
pub struct Direct {
    /// True if the first moment is found too.
    moment: bool,
    /// True if media transmit light, or end rays.
    translucent: bool,
    class: ClassPipeline,
    shine: ComputePipelines,
    add: ComputePipelines,
}

impl Direct {
    pub fn new(compiler: &Compiler, settings: &Settings) -> Self {
        let (moment, translucent) = (settings.moment, is_translucent(settings));
        let found = shaders::moment(moment);
        let medium = ("MAX_OPTICAL_DEPTH", f64::from(MAX_OPTICAL_DEPTH));
        let constants = [("TRANSLUCENT", f64::from(translucent)), medium, found];
        Self {
            moment,
            translucent,
            class: ClassPipeline::new(compiler),
            shine: compiler.program(&programs::DIRECT, &constants),
            add: compiler.program(&programs::ADD_DIRECT, &[found]),
        }
    }

    /// Returns whether it finds what these settings ask for.
    pub fn serves(&self, settings: &Settings) -> bool {
        self.moment == settings.moment && self.translucent == is_translucent(settings)
    }

    /// Plans finding the direct light.
    pub fn plan(
        &self,
        planner: &FramePlanner,
    ) -> Result<(FoundLight<'_>, LightBuffers, Vec<Dispatch>)> {
        let class = self.class.plan(planner)?;
        let Capacity { exact_lamps, suns, .. } = planner.capacity;
        let bytes = HEAD + suns.max(1) * size_of::<Sun>() as u64;
        let buffers = LightBuffers {
            lamps: planner.buffer_of_bytes("exact lamps", LampList::bytes(exact_lamps))?,
            suns: planner.buffer_of_bytes("suns", bytes)?,
        };
        let found =
            planner.buffer::<[f32; 4]>("direct light", u64::from(FACES) * planner.cells())?;
        let resources = [
            whole(&buffers.lamps),
            view(&planner.textures.tint_opacity),
            whole(&class.classes),
            whole(&buffers.suns),
            whole(&found),
            planner.masks(),
            planner.cookies(),
        ];
        let bound = planner.bind(&self.shine, &resources);
        let [columns, rows] = <[u32; 2]>::from(planner.size).map(|side| side.div_ceil(TILE));
        let shine = |entry: usize| {
            Dispatch::new(self.shine.entry(entry), &bound, None, [columns, rows, FACES])
        };
        let mut dispatches = vec![class.dispatch, shine(LAMPS)];
        dispatches.extend((suns > 0).then(|| shine(SUNS)));
        Ok((FoundLight { pipelines: &self.add, found }, buffers, dispatches))
    }
}

/// Returns whether light passes media: only `polar` may want it to end there.
fn is_translucent(settings: &Settings) -> bool {
    settings.method.as_polar().is_none_or(|polar| polar.translucent)
}

/// Entries of [`programs::DIRECT`].
const LAMPS: usize = 0;
const SUNS: usize = 1;
