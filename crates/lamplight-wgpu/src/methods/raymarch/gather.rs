//! The gather of light, or of scattered radiance, by rays from every pixel.

use crate::compiler::Compiler;
use crate::error::unsupported;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::shared::filled;
use crate::stages::medium_grid::MediumGrid;
use crate::stages::packet::PACKET;
use crate::{programs, shaders};
use lamplight::internals::distance::MARGIN;
use lamplight::internals::noise;
use lamplight::internals::raymarch::{GOLDEN_RATIO, NEVER, SECTOR, directions};
use lamplight::internals::seed::NONE;
use lamplight::settings::{Hit, Raymarch};
use wgpu::{Buffer, BufferUsages, Queue};

/// The pipelines, and buffers that are the same for every grid.
#[derive(Debug)]
pub struct Gather {
    rays: ComputePipelines,
    blue: Buffer,
    directions: Buffer,
}

/// The buffers that gathers read and write.
pub struct GatherBuffers {
    pub grid: MediumGrid,
    /// The two fields that rays go by: extinction and squares, or nearest cells and distances.
    pub fields: [Buffer; 2],
    /// The variance of the light, and whether rays met a change; a single cell if nothing reads them.
    pub traced: Buffer,
}

/// The result of a gather, an entry of [`programs::RAYMARCH`].
#[derive(Clone, Copy)]
pub enum Gathered {
    /// The light of every cell.
    Light = 0,
    /// The scattered radiance of the next bounce.
    Scattered = 1,
}

impl Gather {
    /// Compiles the pipelines. With `tracks`, rays report changes; with `varies`, the variance is measured.
    pub fn new(
        compiler: &Compiler,
        queue: &Queue,
        settings: &Raymarch,
        tracks: bool,
        varies: bool,
        moment: bool,
        inflow: bool,
    ) -> lamplight::Result<Self> {
        let storage =
            |label, bytes| filled(&compiler.device, queue, label, BufferUsages::STORAGE, bytes);
        let stops = [("STOPS", f64::from(tracks || settings.attenuation))];
        let (program, march) = match settings.hit {
            Hit::Edge => (&programs::RAYMARCH, [PACKET, &[("ENDS", 0.0)], &stops].concat()),
            Hit::Distance => (&programs::RAYMARCH_DISTANCE, MARCH_DISTANCE.to_vec()),
            other => return Err(unsupported("raymarch.hit", other)),
        };
        let needed = [
            ("TRACKS", f64::from(tracks)),
            ("VARIES", f64::from(varies)),
            ("TRACED", f64::from(tracks || varies)),
            shaders::moment(moment),
        ];
        let constants =
            [GATHER, &march, &shaders::LUMINANCE, &needed, &shaders::inflow(inflow)].concat();
        let directions: Vec<[f32; 2]> = directions(settings).collect();
        Ok(Self {
            rays: compiler.program(program, &constants),
            blue: storage("blue noise", noise::blue()),
            directions: storage("directions", bytemuck::cast_slice(&directions)),
        })
    }

    /// Plans a gather from the scattered radiance in `from`, which counts from step 1 on, to `to`.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        gathered: Gathered,
        buffers: &GatherBuffers,
        step: u32,
        from: &Buffer,
        to: &Buffer,
    ) -> Dispatch {
        let GatherBuffers { grid, fields, traced } = buffers;
        let resources = [
            whole(&self.blue),
            whole(&self.directions),
            whole(&grid.source),
            whole(&fields[0]),
            whole(&fields[1]),
            whole(from),
            planner.shared.step(),
            view(&planner.textures.albedo),
            whole(to),
            whole(traced),
            planner.panorama(),
        ];
        let bound = planner.bind(&self.rays, &resources);
        planner.over_cells(&self.rays, gathered as usize, &bound, Some(step))
    }
}

/// Constants of shaders/methods/raymarch/gather.wgsl and its imports.
const GATHER: &[(&str, f64)] = &[
    ("SIDE", noise::SIDE as f64),
    ("SLICES", noise::FRAMES as f64),
    ("STEP_X", noise::R2[0] as f64),
    ("STEP_Y", noise::R2[1] as f64),
    ("GOLDEN", noise::GOLDEN as f64),
    ("GOLDEN_RATIO", GOLDEN_RATIO as f64),
    ("SECTOR", SECTOR as f64),
];
/// Constants of shaders/methods/raymarch/march_distance.wgsl.
const MARCH_DISTANCE: &[(&str, f64)] =
    &[("NEVER", NEVER as f64), ("NO_SEED", NONE as f64), ("MARGIN", MARGIN as f64)];
