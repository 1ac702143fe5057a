//! What runs over a grid, in which order: the GPU's `frame.rs` of the library, worked out once.

use crate::grid::{Buffers, SETTLING};
use crate::kernel::{Dispatch, Kernels};
use crate::lighting::Pipelines;
use crate::matter::Textures;
use lamplight::Settings;
use lamplight::settings::Hit;
use lamplight::stages::clearance::LONGEST;
use lamplight::stages::jump_flood::passes;
use wgpu::{BindGroup, BindingResource, Buffer, Device, TextureView};

/// What there is to run, and to run it on.
pub struct Plan<'a> {
    pub device: &'a Device,
    pub pipelines: &'a Pipelines,
    pub textures: &'a Textures,
    pub buffers: &'a Buffers,
}

impl Plan<'_> {
    /// Seed map, jump flood, distance field.
    pub fn fields(&self, [width, height]: [u32; 2]) -> Vec<Dispatch> {
        let Buffers { seeds, flood, distance, .. } = self.buffers;
        let Pipelines { seed, jump_flood, distance: measure, .. } = self.pipelines;
        let bound = self.bind(seed, &[view(&self.textures.tint_opacity), whole(seeds)]);
        let mut runs = vec![Dispatch::new(&seed.entries[0], &bound, None)];
        let mut known = seeds;
        let jumps = (0..passes(width, height)).rev().chain((0..SETTLING).map(|_| 0));
        for (i, pass) in jumps.enumerate() {
            let nearest = &flood[(i + 1) % 2];
            let bound = self.bind(jump_flood, &[self.step(), whole(known), whole(nearest)]);
            runs.push(Dispatch::new(&jump_flood.entries[0], &bound, Some(pass)));
            known = nearest;
        }
        let bound = self.bind(measure, &[whole(known), whole(distance)]);
        runs.push(Dispatch::new(&measure.entries[0], &bound, None));
        runs
    }

    /// From matter to light.
    pub fn frame(&self, size: [u32; 2], settings: &Settings) -> Vec<Dispatch> {
        let bounces = settings.bounces.limit();
        // What rays go by: clear squares, or the distance to the nearest cell.
        let (squares, nearest) = (&self.buffers.squares[1], self.buffers.nearest(size));
        let (by, once, again): (_, _, fn(&Self) -> Vec<Dispatch>) = match settings.raymarch.hit {
            Hit::Edge => ([&self.buffers.logs, squares], self.clearance(), Self::clearance),
            Hit::Distance => ([nearest, &self.buffers.distance], self.fields(size), |_| Vec::new()),
        };
        let mut runs = vec![self.optics(0, 0)];
        runs.extend(once);
        for bounce in 0..bounces {
            runs.push(self.raymarch(1, bounce, by));
            runs.push(self.optics(1, bounce));
            // Fog that sends other light on is other matter.
            runs.extend(again(self));
        }
        runs.push(self.raymarch(0, bounces, by));
        runs.extend(self.walls(settings.wall_depth.ceil() as u32));
        runs
    }

    /// Reads the grid (entry 0), or adds what fog sends on (1).
    fn optics(&self, entry: usize, bounce: u32) -> Dispatch {
        let (kernels, matter) = (&self.pipelines.optics, self.textures);
        let Buffers { source, logs, sent, .. } = self.buffers;
        let resources = [
            view(&matter.emission),
            view(&matter.tint_opacity),
            whole(source),
            whole(logs),
            whole(&sent[bounce as usize % 2]),
        ];
        Dispatch::new(&kernels.entries[entry], &self.bind(kernels, &resources), None)
    }

    fn clearance(&self) -> Vec<Dispatch> {
        let kernels = &self.pipelines.clearance;
        let Buffers { source, logs, squares, .. } = self.buffers;
        // All powers of two that the longest side holds are doubled but the last.
        let last = LONGEST.ilog2();
        (0..last + 2)
            .map(|run| {
                let entry = match run {
                    0 => 0,
                    run if run <= last => 1,
                    _ => 2,
                };
                // The last run writes the second half.
                let to = (run + last) as usize % 2;
                let (from, to) = (whole(&squares[1 - to]), whole(&squares[to]));
                let resources = [self.step(), whole(source), whole(logs), from, to];
                let bound = self.bind(kernels, &resources);
                Dispatch::new(&kernels.entries[entry], &bound, Some(run.saturating_sub(1)))
            })
            .collect()
    }

    /// Gathers light (entry 0), or what surfaces receive in a bounce (1), after so many bounces.
    fn raymarch(&self, entry: usize, bounces: u32, by: [&Buffer; 2]) -> Dispatch {
        let (kernels, constant) = (&self.pipelines.raymarch, &self.pipelines.constant);
        let Buffers { source, sent, light, .. } = self.buffers;
        let this = bounces as usize % 2;
        let resources = [
            whole(&constant.blue),
            whole(&constant.directions),
            whole(source),
            whole(by[0]),
            whole(by[1]),
            whole(&sent[1 - this]),
            self.step(),
            view(&self.textures.albedo),
            whole(if entry == 0 { light } else { &sent[this] }),
        ];
        let bound = self.bind(kernels, &resources);
        Dispatch::new(&kernels.entries[entry], &bound, Some(bounces.min(1)))
    }

    /// Light that sinks `depth` px into walls.
    fn walls(&self, depth: u32) -> Vec<Dispatch> {
        let kernels = &self.pipelines.walls;
        let Buffers { source, light, rings, .. } = self.buffers;
        (0..depth + 2)
            .map(|run| {
                let entry = match run {
                    0 => 0,
                    run if run <= depth => 1,
                    _ => 2,
                };
                let to = run as usize % 2;
                let resources = [
                    self.step(),
                    view(&self.textures.emission),
                    whole(source),
                    whole(&rings[1 - to]),
                    whole(&rings[to]),
                    whole(light),
                ];
                let step = if entry == 1 { run } else { 0 };
                Dispatch::new(&kernels.entries[entry], &self.bind(kernels, &resources), Some(step))
            })
            .collect()
    }

    /// Writes the light into a picture of the host's.
    pub fn output(&self, picture: &TextureView) -> Dispatch {
        let kernels = &self.pipelines.output;
        let bound = self.bind(kernels, &[whole(&self.buffers.light), view(picture)]);
        Dispatch::new(&kernels.entries[0], &bound, None)
    }

    fn step(&self) -> BindingResource<'_> {
        self.pipelines.constant.step()
    }

    /// Binds the frame and these resources.
    fn bind(&self, kernels: &Kernels, resources: &[BindingResource]) -> BindGroup {
        let mut all = vec![self.pipelines.constant.frame.as_entire_binding()];
        all.extend_from_slice(resources);
        kernels.bind(self.device, &all)
    }
}

fn whole(buffer: &Buffer) -> BindingResource<'_> {
    buffer.as_entire_binding()
}

fn view(view: &TextureView) -> BindingResource<'_> {
    BindingResource::TextureView(view)
}
