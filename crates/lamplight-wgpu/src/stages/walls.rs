//! The light that solid cells show.

use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Walls(ComputePipelines);

impl Walls {
    pub fn new(device: &Device) -> Self {
        Self(ComputePipelines::new(device, &programs::WALLS, &[]))
    }

    /// Plans the light of solid cells from that of their faces.
    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<Vec<Dispatch>> {
        let rings = planner.pair::<u32>("walls", planner.cells())?;
        let bind = |to: usize| {
            let resources = [
                view(&planner.textures.tint_opacity),
                planner.shared.step(),
                view(&planner.textures.emission),
                whole(&rings[1 - to]),
                whole(&rings[to]),
                whole(light),
            ];
            planner.bind(&self.0, &resources)
        };
        let depth = planner.settings.wall_depth.ceil() as u32;
        Ok(planner.ping_pong(&self.0, [bind(0), bind(1)], depth))
    }
}
