//! `flood`: rays drawn into a grid of light, then blurred, kept from frame to frame.
//!
//! The library also keeps the source's energy without colour, a mean of old and new that depends on which ray
//! came first. It does not affect light, and is not computed here.

use crate::compiler::Compiler;
use crate::error::{Result, unsupported};
use crate::lamps::{GROUP_RAYS, LampList, LampRays};
use crate::pass_list::PassList;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use crate::shared::filled;
use crate::stage::Stage;
use crate::stages::class::ClassPipeline;
use crate::stages::gradient_moment::GradientMoment;
use lamplight::Lamp;
use lamplight::internals::flood::{STEEPNESS, reach};
use lamplight::internals::{MAX_OPTICAL_DEPTH, circle};
use lamplight::settings::{Fade, Flood as Settings, Sweeps};
use std::f64::consts::TAU;
use wgpu::{Buffer, BufferUsages, Queue};

/// The pipelines, and the directions of rays.
#[derive(Debug)]
pub struct Flood {
    settings: Settings,
    class: ClassPipeline,
    rays: ComputePipelines,
    blur: ComputePipelines,
    directions: Buffer,
    /// Set if the first moment is found.
    moment: Option<GradientMoment>,
}

/// Entries of [`programs::FLOOD_RAYS`].
const LAMP_RAYS: usize = 0;
const MATTER_RAYS: usize = 1;
const SKY_RAYS: usize = 2;
/// Entries of [`programs::FLOOD_BLUR`].
const DECAY: usize = 0;
const MIX: usize = 1;
const SHOW: usize = 2;

impl Flood {
    pub fn new(compiler: &Compiler, queue: &Queue, settings: &Settings, moment: bool) -> Self {
        // The shader divides by the number of matter rays, even if none are drawn.
        let counts = [settings.rays, settings.matter_rays.max(1), settings.bounce_rays];
        let directions: Vec<[f32; 4]> = counts
            .iter()
            .flat_map(|&n| (0..n).map(move |i| with_inverse(circle::direction(i, n))))
            .collect();
        let [rays, matter_rays, bounce_rays] = counts.map(f64::from);
        let spacing = if settings.fade == Fade::Lamp { TAU / rays } else { 0.0 };
        let constants = [
            ("RAYS", rays),
            ("MATTER_RAYS", matter_rays),
            ("BOUNCE_RAYS", bounce_rays),
            ("STEEPNESS", f64::from(STEEPNESS)),
            ("REACH", f64::from(reach(1.0))),
            ("SPACING", spacing),
            ("TRANSLUCENT", 1.0),
            ("MAX_OPTICAL_DEPTH", f64::from(MAX_OPTICAL_DEPTH)),
        ];
        let decay = [("DECAY", f64::from(settings.decay))];
        let directions = bytemuck::cast_slice(&directions);
        Self {
            settings: settings.clone(),
            class: ClassPipeline::new(compiler),
            rays: compiler.program(&programs::FLOOD_RAYS, &constants),
            blur: compiler.program(&programs::FLOOD_BLUR, &decay),
            directions: filled(
                &compiler.device,
                queue,
                "directions",
                BufferUsages::STORAGE,
                directions,
            ),
            moment: moment.then(|| GradientMoment::new(compiler)),
        }
    }

    /// Returns the rays of a lamp.
    pub fn lamp_rays(&self, lamp: &Lamp, [width, height]: [u32; 2]) -> lamplight::Result<LampRays> {
        let (reach, falloff) = match self.settings.fade {
            Fade::Lamp => (lamp.range, Some(lamp.falloff)),
            Fade::Seed => (lamp.range.min(reach(width.max(height) as f32)), None),
            other => return Err(unsupported("flood.fade", other)),
        };
        Ok(LampRays { reach, count: self.settings.rays, soft: 0.0, falloff })
    }

    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        let class = self.class.plan(planner)?;
        let lamps = planner.buffer_of_bytes("lamps", LampList::bytes(planner.capacity.lamps))?;
        // The light in the grid, which persists, and a second buffer for the blur.
        let halves = [
            planner.history::<[f32; 4]>("flood", planner.cells())?,
            planner.buffer::<[f32; 4]>("flood, blurred", planner.cells())?,
        ];
        let resources = [
            whole(&lamps),
            view(&planner.textures.tint_opacity),
            whole(&class.classes),
            view(&planner.textures.emission),
            view(&planner.textures.albedo),
            whole(&self.directions),
            whole(&halves[0]),
            planner.panorama(),
        ];
        let drawn = planner.bind(&self.rays, &resources);
        let bind = |to: usize| {
            let resources = [
                planner.shared.step(),
                whole(&halves[1 - to]),
                whole(&class.classes),
                whole(&halves[to]),
                whole(light),
            ];
            planner.bind(&self.blur, &resources)
        };
        let into = [bind(0), bind(1)];
        let blur = |entry, half: usize, step| {
            planner.over_cells(&self.blur, entry, &into[half], Some(step))
        };

        let settings = &self.settings;
        let mut dispatches = vec![class.dispatch, blur(DECAY, 0, 0)];
        let rays = |entry: usize, count: u64| {
            let groups = planner.groups(count.div_ceil(GROUP_RAYS.into()));
            Dispatch::new(self.rays.entry(entry), &drawn, None, groups)
        };
        dispatches.push(rays(LAMP_RAYS, planner.capacity.rays));
        if settings.matter_rays > 0 {
            dispatches.push(planner.over_cells(&self.rays, MATTER_RAYS, &drawn, None));
            let sides = 2 * (u64::from(planner.size.width) + u64::from(planner.size.height));
            dispatches.push(rays(SKY_RAYS, sides * u64::from(settings.matter_rays)));
        }
        let passes: &[u32] = match settings.sweeps {
            Sweeps::Even => &[ALONG_X, ALONG_Y],
            Sweeps::Seed => &[ALONG_X + AFTER, ALONG_X + BEFORE, ALONG_Y + AFTER, ALONG_Y + BEFORE],
            other => return Err(unsupported("flood.sweeps", other).into()),
        };
        // The number of passes is even, so the last one writes where the first one reads.
        for _ in 0..settings.rounds {
            let halves = [1, 0].into_iter().cycle();
            dispatches.extend(passes.iter().zip(halves).map(|(&step, half)| blur(MIX, half, step)));
        }
        dispatches.push(blur(SHOW, 0, 0));
        dispatches.extend(self.moment.iter().map(|moment| moment.plan(planner, light)));
        dispatches.extend(planner.add_direct(light));
        let stages = vec![(Stage::Light, light.clone())];
        Ok(PassList { lamps: Some(lamps), ..PassList::new(dispatches, stages) })
    }
}

/// The step of `mix_neighbours` in shaders/methods/flood/blur.wgsl: the axis,
const ALONG_X: u32 = 0;
const ALONG_Y: u32 = 1;
/// plus one of these if light comes only from the neighbour after, or before.
const AFTER: u32 = 2;
const BEFORE: u32 = 4;

/// A direction and its inverse, which keeps the sign of zeros.
fn with_inverse(direction: [f32; 2]) -> [f32; 4] {
    let [x, y] = direction;
    let inverse = direction.map(|d| 1.0 / d.abs().max(f32::MIN_POSITIVE).copysign(d));
    [x, y, inverse[0], inverse[1]]
}
