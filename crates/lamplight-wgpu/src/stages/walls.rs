//! The light that solid cells show.

use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use lamplight::internals::walls::{ALONG, KERNEL, OCTAVE, SOFTENING, STRAIGHT, octaves};
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Walls(ComputePipelines);

impl Walls {
    pub fn new(device: &Device) -> Self {
        let constants = [
            ("OCTAVE", f64::from(OCTAVE)),
            ("STRAIGHT", f64::from(STRAIGHT)),
            ("SOFTENING", f64::from(SOFTENING)),
            ("KERNEL_0", f64::from(KERNEL[0])),
            ("KERNEL_1", f64::from(KERNEL[1])),
            ("KERNEL_2", f64::from(KERNEL[2])),
            ("ALONG_0", f64::from(ALONG[0])),
            ("ALONG_1", f64::from(ALONG[1])),
            ("ALONG_2", f64::from(ALONG[2])),
        ];
        Self(ComputePipelines::new(device, &programs::WALLS, &constants))
    }

    /// Plans the light of solid cells from that of their faces.
    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<Vec<Dispatch>> {
        let octaves = octaves(planner.settings.wall_depth);
        let size = <[u32; 2]>::from(planner.size);
        let level_size = |level: u32| size.map(|n| n.div_ceil(1 << level));
        let level_cells = |level: u32| level_size(level).map(u64::from).iter().product::<u64>();
        // Where nothing sinks in, the buffers are bound, but not used.
        let cells = if octaves == 0 { 1 } else { planner.cells() };
        let sums = (1..=octaves).map(level_cells).sum::<u64>().max(1);
        let surface = planner.buffer::<[f32; 4]>("walls: surface", cells)?;
        let irradiance = planner.buffer::<[f32; 4]>("walls: irradiance", sums)?;
        let emission = planner.buffer::<[f32; 4]>("walls: emission", sums)?;
        let resources = [
            view(&planner.textures.tint_opacity),
            planner.shared.step(),
            view(&planner.textures.emission),
            whole(&surface),
            whole(&irradiance),
            whole(&emission),
            whole(light),
        ];
        let bound = planner.bind(&self.0, &resources);
        let over = |entry: usize, level: u32| {
            Dispatch::over(level_size(level), &self.0.entries[entry], &bound, Some(level))
        };
        if octaves == 0 {
            return Ok(vec![over(0, 0)]);
        }
        let blurs = (1..=octaves).map(|level| over(2, level));
        let sums = (1..octaves).rev().map(|level| over(3, level));
        Ok([over(1, 0)].into_iter().chain(blurs).chain(sums).chain([over(4, 0)]).collect())
    }
}
