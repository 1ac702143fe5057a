//! The buffers of a grid of one size, and what runs over them.

use crate::kernel::Dispatch;
use crate::matter::Textures;
use crate::pipelines::Pipelines;
use crate::plan::Plan;
use crate::{Error, Result};
use lamplight::Settings;
use lamplight::settings::Bounces;
use lamplight::stages::clearance::LONGEST;
use lamplight::stages::jump_flood::passes;
use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device};

/// Bytes of four floats.
const FOUR: u64 = 16;
/// Bytes of one number.
const ONE: u64 = 4;

/// Everything that depends on the size of the grid.
#[derive(Debug)]
pub struct Grid {
    pub size: [u32; 2],
    pub textures: Textures,
    pub buffers: Buffers,
    /// Seed map, jump flood, distance field.
    pub fields: Vec<Dispatch>,
    /// From matter to light.
    pub frame: Vec<Dispatch>,
}

/// One entry a cell, row by row; pairs are the halves of a ping-pong.
#[derive(Debug)]
pub struct Buffers {
    pub seeds: Buffer,
    pub flood: [Buffer; 2],
    pub distance: Buffer,
    pub source: Buffer,
    pub logs: Buffer,
    pub clearance: [Buffer; 2],
    /// What surfaces send on, by face; next to nothing where light does not bounce.
    pub sent: [Buffer; 2],
    pub light: Buffer,
    pub rings: [Buffer; 2],
}

/// Passes of offset 1 after the jump flood, where the CPU goes on until nothing changes. That took at
/// most 4 over the example scenes and 9 over 400 random grids of up to 400 px a side; beyond it a cell
/// here and there would know a cell that is not quite the nearest.
pub const SETTLING: u32 = 12;

impl Buffers {
    /// The clear squares, when all doublings are done.
    pub fn squares(&self) -> &Buffer {
        &self.clearance[((LONGEST.ilog2() + 1) % 2) as usize]
    }

    /// The Voronoi map of a grid.
    pub fn nearest(&self, [width, height]: [u32; 2]) -> &Buffer {
        &self.flood[((passes(width, height) + SETTLING) % 2) as usize]
    }
}

impl Grid {
    /// Makes buffers, and plans what runs on them.
    pub fn new(
        device: &Device,
        textures: Textures,
        pipelines: &Pipelines,
        settings: &Settings,
    ) -> Result<Self> {
        let size = textures.size()?;
        check(device, size, settings)?;
        let cells = u64::from(size[0]) * u64::from(size[1]);
        let buffer = |label, bytes: u64| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        let pair = |label, bytes: u64| [0, 1].map(|_| buffer(label, bytes));
        let buffers = Buffers {
            seeds: buffer("seeds", cells * ONE),
            flood: pair("jump flood", cells * ONE),
            distance: buffer("distance", cells * ONE),
            source: buffer("source", cells * FOUR),
            logs: buffer("log transmittance", cells * FOUR),
            clearance: pair("clearance", cells * ONE),
            sent: pair("sent", (cells * faces(settings)).max(1) * FOUR),
            light: buffer("light", cells * FOUR),
            rings: pair("walls", cells * ONE),
        };
        let plan = Plan { device, pipelines, textures: &textures, buffers: &buffers };
        let (fields, frame) = (plan.fields(size), plan.frame(size, settings));
        Ok(Self { size, textures, buffers, fields, frame })
    }
}

/// Faces of a cell of which it is kept what they send on.
fn faces(settings: &Settings) -> u64 {
    if settings.bounces == Bounces::Count(0) { 0 } else { 4 }
}

/// Refuses a grid that the device cannot hold.
pub fn check(device: &Device, [width, height]: [u32; 2], settings: &Settings) -> Result<()> {
    let limits = device.limits();
    let too_large =
        |what, needed, allowed| Error::TooLarge { width, height, what, needed, allowed };
    let (side, most) = (width.max(height), limits.max_texture_dimension_2d);
    if side > most {
        return Err(too_large("px a side", side.into(), most.into()));
    }
    let bytes = u64::from(width) * u64::from(height) * FOUR * faces(settings).max(1);
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    if bytes > most {
        return Err(too_large("bytes a buffer", bytes, most));
    }
    Ok(())
}
