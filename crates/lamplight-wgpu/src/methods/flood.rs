//! Rays drawn into a grid of light, then blurred, kept from frame to frame: the GPU's `methods/flood`
//! of the library.
//!
//! The library keeps the source's energy without colour too, a mean of old and new that depends on
//! which ray came first. It has no part in the light, and is not made here.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::lamps::{Fan, Lamps, TOGETHER};
use crate::lighting::Stage;
use crate::shaders;
use crate::shared::filled;
use crate::site::{FOUR, Run, Site, view, whole};
use crate::stages::ground::Ground;
use lamplight::methods::flood::{STEEPNESS, reach};
use lamplight::settings::{Fade, Flood as Settings, Sweeps};
use lamplight::stages::circle;
use lamplight::stages::transmittance::LOG_OF_ZERO;
use wgpu::{Buffer, BufferUsages, Device, Queue};

/// The pipelines, the directions of rays, and what is kept.
#[derive(Debug)]
pub struct Flood {
    ground: Ground,
    rays: Kernels,
    blur: Kernels,
    ways: Buffer,
}

/// How a lamp is drawn into a grid.
pub fn fan(lamp: &lamplight::Lamp, [width, height]: [u32; 2], settings: &Settings) -> Fan {
    let (reach, falloff) = match settings.fade {
        Fade::Lamp => (lamp.range, Some(lamp.falloff)),
        Fade::Seed => (lamp.range.min(reach(width.max(height) as f32)), None),
    };
    Fan { reach, count: settings.rays, soft: 0.0, falloff }
}

impl Flood {
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        // None is no number to divide by; then nothing is sent.
        let counts = [settings.rays, settings.matter_rays.max(1), settings.bounce_rays];
        let ways: Vec<[f32; 4]> = counts
            .iter()
            .flat_map(|&n| (0..n).map(move |i| way(circle::direction(i, n))))
            .collect();
        let [rays, matter_rays, bounce_rays] = counts.map(f64::from);
        let constants = [
            ("RAYS", rays),
            ("MATTER_RAYS", matter_rays),
            ("BOUNCE_RAYS", bounce_rays),
            ("STEEPNESS", f64::from(STEEPNESS)),
            ("REACH", f64::from(reach(1.0))),
            ("TRANSLUCENT", 1.0),
            ("LOG_OF_ZERO", f64::from(LOG_OF_ZERO)),
        ];
        Self {
            ground: Ground::new(device),
            rays: Kernels::new(
                device,
                &shaders::FLOOD_RAYS,
                &["lamp_rays", "matter_rays", "sky_rays"],
                &[Uniform, Read, Texture, Read, Texture, Texture, Read, Write],
                &constants,
            ),
            blur: Kernels::new(
                device,
                &shaders::FLOOD,
                &["decay", "mix_neighbours", "show"],
                &[Uniform, Step, Read, Read, Write, Write],
                &[("DECAY", f64::from(settings.decay))],
            ),
            ways: filled(device, queue, "ways", BufferUsages::STORAGE, bytemuck::cast_slice(&ways)),
        }
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        let ground = self.ground.plan(site)?;
        let lamps = site.buffer("lamps", Lamps::bytes(site.room.lamps))?;
        let bytes = site.cells() * FOUR;
        // The light in the grid, which is kept, and room to blur it.
        let halves = [site.kept("flood", bytes)?, site.buffer("flood, blurred", bytes)?];
        let resources = [
            whole(&lamps),
            view(&site.textures.tint_opacity),
            whole(&ground.kinds),
            view(&site.textures.emission),
            view(&site.textures.albedo),
            whole(&self.ways),
            whole(&halves[0]),
        ];
        let drawn = site.bind(&self.rays, &resources);
        let bind = |to: usize| {
            let (from, to) = (whole(&halves[1 - to]), whole(&halves[to]));
            let resources = [site.shared.step(), from, whole(&ground.kinds), to, whole(light)];
            site.bind(&self.blur, &resources)
        };
        let into = [bind(0), bind(1)];
        let blur =
            |entry, half: usize, step| site.over_cells(&self.blur, entry, &into[half], Some(step));

        let settings = &site.settings.flood;
        let mut dispatches = vec![ground.read, blur(0, 0, 0)];
        let groups = site.groups(site.room.rays / u64::from(TOGETHER));
        dispatches.push(Dispatch::new(&self.rays.entries[0], &drawn, None, groups));
        if settings.matter_rays > 0 {
            dispatches.push(site.over_cells(&self.rays, 1, &drawn, None));
            let sides = 2 * (u64::from(site.size[0]) + u64::from(site.size[1]));
            let rays = sides * u64::from(settings.matter_rays);
            let groups = site.groups(rays.div_ceil(u64::from(TOGETHER)));
            dispatches.push(Dispatch::new(&self.rays.entries[2], &drawn, None, groups));
        }
        let passes: &[u32] = match settings.sweeps {
            Sweeps::Even => &[ALONG_X, ALONG_Y],
            Sweeps::Seed => &[ALONG_X + AFTER, ALONG_X + BEFORE, ALONG_Y + AFTER, ALONG_Y + BEFORE],
        };
        // Of an even number of passes the last writes where the first read.
        for _ in 0..settings.rounds {
            let halves = [1, 0].into_iter().cycle();
            dispatches.extend(passes.iter().zip(halves).map(|(&step, half)| blur(1, half, step)));
        }
        dispatches.push(blur(2, 0, 0));
        Ok(Run { dispatches, stages: vec![(Stage::Light, light.clone())], lamps: Some(lamps) })
    }
}

/// What `mix_neighbours` of shaders/flood.wgsl is told: the axis,
const ALONG_X: u32 = 0;
const ALONG_Y: u32 = 1;
/// and whether light comes only from the neighbour after, or before.
const AFTER: u32 = 2;
const BEFORE: u32 = 4;

/// A direction and its inverse, which knows the sign of zeros.
fn way(direction: [f32; 2]) -> [f32; 4] {
    let [x, y] = direction;
    let inverse = direction.map(|d| 1.0 / d.abs().max(f32::MIN_POSITIVE).copysign(d));
    [x, y, inverse[0], inverse[1]]
}
