//! The buffers of a grid of one size, and the runs of kernels over it that make a frame.

use crate::kernel::{Dispatch, Kernels};
use crate::lighting::Pipelines;
use crate::matter::Matter;
use crate::{Error, Result};
use lamplight::stages::clearance::LONGEST;
use lamplight::stages::jump_flood::passes;
use wgpu::{BindGroup, BindingResource, Buffer, BufferDescriptor, BufferUsages, Device};

/// Bytes a cell of the largest buffer: four floats.
const WIDEST: u64 = 16;

/// Everything that depends on the size of the grid.
#[derive(Debug)]
pub struct Grid {
    pub size: [u32; 2],
    pub matter: Matter,
    pub seeds: Buffer,
    pub nearest: Buffer,
    pub distance: Buffer,
    pub squares: Buffer,
    pub light: Buffer,
    /// Seed map, jump flood, distance field.
    pub fields: Vec<Dispatch>,
    /// From matter to light.
    pub frame: Vec<Dispatch>,
}

impl Grid {
    /// Makes buffers, and plans what runs on them; walls show light `depth` px deep.
    pub fn new(device: &Device, size: [u32; 2], pipelines: &Pipelines, depth: u32) -> Result<Self> {
        check(device, size)?;
        let buffer = |label, bytes: u64| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size: u64::from(size[0]) * u64::from(size[1]) * bytes,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let matter = Matter::new(device, size);
        let [seeds, flood, other] =
            ["seeds", "jump flood", "jump flood, other half"].map(|n| buffer(n, 4));
        let distance = buffer("distance", 4);
        let [source, logs] = ["source", "log transmittance"].map(|n| buffer(n, WIDEST));
        let [powers, squares] = ["clearance, other half", "clearance"].map(|n| buffer(n, 4));
        let [rings, rings_other] = ["walls", "walls, other half"].map(|n| buffer(n, 4));
        let light = buffer("light", WIDEST);

        let Pipelines { constant, .. } = pipelines;
        let emission = BindingResource::TextureView(&matter.emission_view);
        let tint_opacity = BindingResource::TextureView(&matter.tint_opacity_view);
        let frame = constant.frame.as_entire_binding();
        let bind = |kernels: &Kernels, resources: &[BindingResource]| -> BindGroup {
            let all: Vec<_> =
                std::iter::once(frame.clone()).chain(resources.iter().cloned()).collect();
            kernels.bind(device, &all)
        };
        let of = Buffer::as_entire_binding;
        let step = constant.step();

        let seed = bind(&pipelines.seed, &[tint_opacity.clone(), of(&seeds)]);
        let mut fields = vec![Dispatch::new(&pipelines.seed.entries[0], &seed, None)];
        let jumps = passes(size[0], size[1]);
        let mut from = &seeds;
        for pass in (0..jumps).rev() {
            let to = if (jumps - pass) % 2 == 1 { &flood } else { &other };
            let bound = bind(&pipelines.jump_flood, &[step.clone(), of(from), of(to)]);
            fields.push(Dispatch::new(&pipelines.jump_flood.entries[0], &bound, Some(pass)));
            from = to;
        }
        let nearest = from.clone();
        let bound = bind(&pipelines.distance, &[of(&nearest), of(&distance)]);
        fields.push(Dispatch::new(&pipelines.distance.entries[0], &bound, None));

        let optics = &pipelines.optics;
        let bound = bind(optics, &[emission.clone(), tint_opacity, of(&source), of(&logs)]);
        let mut run = vec![Dispatch::new(&optics.entries[0], &bound, None)];
        let clearance = &pipelines.clearance;
        let halves = [(&squares, &powers), (&powers, &squares)].map(|(from, to)| {
            bind(clearance, &[step.clone(), of(&source), of(&logs), of(from), of(to)])
        });
        // The longest side has as many bits as there are powers; all are doubled but the last.
        let doublings = LONGEST.ilog2();
        let [begin, double, finish] = &clearance.entries[..] else { unreachable!("three entries") };
        let half = |i: u32| &halves[(i % 2) as usize];
        // An even number of runs ends in `squares`.
        let first = doublings % 2;
        run.push(Dispatch::new(begin, half(first), Some(0)));
        for i in 0..doublings {
            run.push(Dispatch::new(double, half(first + 1 + i), Some(i)));
        }
        run.push(Dispatch::new(finish, half(first + 1 + doublings), Some(0)));

        let raymarch = &pipelines.raymarch;
        let bound = bind(
            raymarch,
            &[
                of(&constant.blue),
                of(&constant.directions),
                of(&source),
                of(&logs),
                of(&squares),
                of(&light),
            ],
        );
        run.push(Dispatch::new(&raymarch.entries[0], &bound, None));

        let walls = &pipelines.walls;
        let halves = [(&rings_other, &rings), (&rings, &rings_other)].map(|(from, to)| {
            bind(
                walls,
                &[step.clone(), emission.clone(), of(&source), of(from), of(to), of(&light)],
            )
        });
        let [begin, sink, finish] = &walls.entries[..] else { unreachable!("three entries") };
        run.push(Dispatch::new(begin, &halves[0], Some(0)));
        for ring in 1..=depth {
            run.push(Dispatch::new(sink, &halves[(ring % 2) as usize], Some(ring)));
        }
        run.push(Dispatch::new(finish, &halves[((depth + 1) % 2) as usize], Some(0)));
        Ok(Self { size, matter, seeds, nearest, distance, squares, light, fields, frame: run })
    }
}

/// Refuses a grid that the device cannot hold.
fn check(device: &Device, [width, height]: [u32; 2]) -> Result<()> {
    let limits = device.limits();
    let too_large =
        |what, needed, allowed| Error::TooLarge { width, height, what, needed, allowed };
    let (side, most) = (width.max(height), limits.max_texture_dimension_2d);
    if side > most {
        return Err(too_large("px a side", side.into(), most.into()));
    }
    let bytes = u64::from(width) * u64::from(height) * WIDEST;
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    if bytes > most {
        return Err(too_large("bytes a buffer", bytes, most));
    }
    Ok(())
}
