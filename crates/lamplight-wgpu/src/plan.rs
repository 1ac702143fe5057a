//! What runs over a grid, in which order: the GPU's `frame.rs` of the library, worked out once.

use crate::grid::{Buffers, SETTLING};
use crate::kernel::{Dispatch, Kernels};
use crate::matter::Textures;
use crate::pipelines::Pipelines;
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
        let Buffers { logs, distance, .. } = self.buffers;
        let bounces = settings.bounces.limit();
        // What rays go by: clear squares, or the distance to the nearest cell.
        let (found, by) = match settings.raymarch.hit {
            Hit::Edge => (self.clearance(), [logs, self.buffers.squares()]),
            Hit::Distance => (self.fields(size), [self.buffers.nearest(size), distance]),
        };
        let mut runs = vec![self.optics(0, 0)];
        runs.extend_from_slice(&found);
        for bounce in 0..bounces {
            runs.push(self.raymarch(1, bounce, by));
            runs.push(self.optics(1, bounce));
            // Fog that sends other light on is other matter, to squares.
            if settings.raymarch.hit == Hit::Edge {
                runs.extend_from_slice(&found);
            }
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
        let Buffers { source, logs, clearance, .. } = self.buffers;
        let bind = |to: usize| {
            let (from, to) = (whole(&clearance[1 - to]), whole(&clearance[to]));
            let resources = [self.step(), whole(source), whole(logs), from, to];
            self.bind(&self.pipelines.clearance, &resources)
        };
        // All powers of two that the longest side holds are doubled but the last.
        ping_pong(&self.pipelines.clearance, [bind(0), bind(1)], LONGEST.ilog2())
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
        let Buffers { source, light, rings, .. } = self.buffers;
        let bind = |to: usize| {
            let resources = [
                self.step(),
                view(&self.textures.emission),
                whole(source),
                whole(&rings[1 - to]),
                whole(&rings[to]),
                whole(light),
            ];
            self.bind(&self.pipelines.walls, &resources)
        };
        ping_pong(&self.pipelines.walls, [bind(0), bind(1)], depth)
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

/// A kernel's three entries between two halves, bound by which they write: to begin, into the first;
/// so many times, told which; and to finish.
fn ping_pong(kernels: &Kernels, halves: [BindGroup; 2], times: u32) -> Vec<Dispatch> {
    let entry = |step: u32| match step {
        0 => 0,
        step if step <= times => 1,
        _ => 2,
    };
    let run = |step: u32| {
        let half = &halves[step as usize % 2];
        Dispatch::new(&kernels.entries[entry(step)], half, Some(step))
    };
    (0..times + 2).map(run).collect()
}

fn whole(buffer: &Buffer) -> BindingResource<'_> {
    buffer.as_entire_binding()
}

fn view(view: &TextureView) -> BindingResource<'_> {
    BindingResource::TextureView(view)
}
