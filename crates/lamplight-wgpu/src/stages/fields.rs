//! Seed map, jump flood, distance field.

use crate::Result;
use crate::kernel::{Kernels, Slot};
use crate::lighting::Stage;
use crate::shaders;
use crate::site::{ONE, Run, Site, view, whole};
use lamplight::stages::jump_flood::passes;
use lamplight::stages::seed::NONE;
use wgpu::{Buffer, Device};

/// Passes of offset 1 after the jump flood, where the CPU goes on until nothing changes. That took at
/// most 4 over the example scenes and 9 over 400 random grids of up to 400 px a side; beyond it a cell
/// here and there would know a cell that is not quite the nearest.
const SETTLING: u32 = 12;

/// What the distance field holds in a grid without matter, where the CPU has +∞: shaders may take
/// infinity for granted not to be.
const FAR: f32 = f32::MAX;

/// The pipelines.
#[derive(Debug)]
pub struct Fields {
    seed: Kernels,
    jump_flood: Kernels,
    distance: Kernels,
}

/// What they leave behind.
#[derive(Debug)]
pub struct Measured {
    pub nearest: Buffer,
    pub distance: Buffer,
    pub run: Run,
}

impl Fields {
    pub fn new(device: &Device) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        let none = ("NONE", f64::from(NONE));
        let far = ("FAR", f64::from(FAR));
        let kernels = |shader, slots: &[_], constants: &[_]| {
            Kernels::new(device, shader, &["main"], slots, constants)
        };
        Self {
            seed: kernels(&shaders::SEED, &[Uniform, Texture, Write], &[none]),
            jump_flood: kernels(&shaders::JUMP_FLOOD, &[Uniform, Step, Read, Write], &[none]),
            distance: kernels(&shaders::DISTANCE, &[Uniform, Read, Write], &[none, far]),
        }
    }

    pub fn plan(&self, site: &Site) -> Result<Measured> {
        let [width, height] = site.size;
        let bytes = site.cells() * ONE;
        let (seeds, flood) = (site.buffer("seeds", bytes)?, site.pair("jump flood", bytes)?);
        let distance = site.buffer("distance", bytes)?;
        let once = |kernels, resources: &[_]| {
            site.over_cells(kernels, 0, &site.bind(kernels, resources), None)
        };
        let mut dispatches =
            vec![once(&self.seed, &[view(&site.textures.tint_opacity), whole(&seeds)])];
        let mut known = &seeds;
        let jumps = (0..passes(width, height)).rev().chain((0..SETTLING).map(|_| 0));
        for (i, pass) in jumps.enumerate() {
            let nearest = &flood[i % 2];
            let resources = [site.shared.step(), whole(known), whole(nearest)];
            let bound = site.bind(&self.jump_flood, &resources);
            dispatches.push(site.over_cells(&self.jump_flood, 0, &bound, Some(pass)));
            known = nearest;
        }
        dispatches.push(once(&self.distance, &[whole(known), whole(&distance)]));
        let nearest = known.clone();
        let stages = vec![
            (Stage::Seeds, seeds),
            (Stage::Nearest, nearest.clone()),
            (Stage::Distance, distance.clone()),
        ];
        Ok(Measured { nearest, distance, run: Run { dispatches, stages, lamps: None } })
    }
}
