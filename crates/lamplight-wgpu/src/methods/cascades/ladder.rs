//! The cascades of a grid as shaders read them, and the number of cones that are computed at once.
//!
//! A cone of the nearest cascade needs nothing from the cones beside it. So if the means that a cascade keeps
//! for all cones would take more than [`MAX_BYTES`], cones are computed in several batches, whose light adds
//! up.

use crate::error::Result;
use crate::gpu_struct::gpu_struct;
use crate::pipeline::STEP_BYTES;
use crate::planner::FramePlanner;
use bytemuck::bytes_of;
use lamplight::internals::cascades::{BRANCHES, Cascade, cascades, mean_sine};
use lamplight::settings;
use std::f32::consts::TAU;
use std::num::NonZeroU64;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferUsages};

/// Bytes of the means of a cascade that are kept at once. Higher: fewer dispatches on large grids; lower: more
/// of them stay in the GPU's caches.
const MAX_BYTES: u64 = 48 << 20;

/// Length of endless rays, px: out of any grid from anywhere around it.
const ENDLESS: f32 = 1e9;

gpu_struct! {
    /// `Path` of shaders/methods/cascades/probe.wgsl, where the fields are explained.
    pub struct Path {
        start: [f32; 2],
        step: [f32; 2],
        direction: [f32; 2],
        length: f32,
        sine: f32,
    }
}

impl Path {
    fn of(cascade: &Cascade, number: u32, overlap: f32) -> Self {
        let path = cascade.segment(number, overlap);
        Self {
            start: path.start,
            step: [path.end[0] - path.start[0], path.end[1] - path.start[1]],
            direction: path.direction,
            length: path.length.min(ENDLESS),
            sine: mean_sine(number, cascade.rays),
        }
    }
}

gpu_struct! {
    /// `Layer` of shaders/methods/cascades/probe.wgsl, where the fields are explained.
    pub struct Layer {
        count: [u32; 2],
        spacing: f32,
        path: u32,
        far_count: [u32; 2],
        far_spacing: f32,
        cones: u32,
        cone: u32,
        rays: u32,
        number: u32,
        angle: f32,
    }
}

/// The cascades of a grid.
#[derive(Debug)]
pub struct Ladder {
    /// The nearest one first.
    pub cascades: Vec<Cascade>,
    /// Cones of the nearest cascade per batch.
    cones: u32,
    /// Fraction of its length by which each interval extends into the next.
    overlap: f32,
    /// Values per mean: of the light, and of the components of its first moment if that is found.
    values: u64,
}

impl Ladder {
    /// Lays out the cascades of a grid.
    ///
    /// # Errors
    /// If the grid has more directions than the device can dispatch.
    pub fn over(planner: &FramePlanner, settings: &settings::Cascades) -> Result<Self> {
        let mut all = Vec::new();
        cascades(planner.size.into(), settings, &mut all);
        let limits = planner.device.limits();
        let layers = u64::from(limits.max_compute_workgroups_per_dimension);
        let bytes = MAX_BYTES.min(limits.max_storage_buffer_binding_size);
        let rays = all[0].rays;
        let values = if planner.settings.moment { 3 } else { 1 };
        let mut ladder = Self { cascades: all, cones: rays, overlap: settings.overlap, values };
        while ladder.cones > 1 && (ladder.layers_of_groups() > layers || ladder.bytes() > bytes) {
            ladder.cones /= 2;
        }
        let needed = ladder.layers_of_groups();
        if needed > layers {
            return Err(planner.size.too_large("layers of workgroups", needed, layers));
        }
        Ok(ladder)
    }

    /// The number of batches.
    pub fn batches(&self) -> u32 {
        self.cascades[0].rays / self.cones
    }

    /// Cones per batch of the cascade before a further one.
    pub fn cones_before(&self, further: usize) -> u64 {
        u64::from(self.cones) * u64::from(BRANCHES).pow(further as u32 - 1)
    }

    fn layers_of_groups(&self) -> u64 {
        (1..self.cascades.len()).map(|further| self.cones_before(further)).max().unwrap_or(1)
    }

    fn bytes(&self) -> u64 {
        self.means() * size_of::<[f32; 4]>() as u64
    }

    /// The largest number of values that a cascade keeps.
    pub fn means(&self) -> u64 {
        let means = |further: usize| {
            self.cones_before(further) * self.cascades[further].lattice.len() as u64 * self.values
        };
        (1..self.cascades.len()).map(means).max().unwrap_or(1)
    }

    /// The paths of all rays, cascade by cascade.
    pub fn paths(&self, planner: &FramePlanner) -> Result<Buffer> {
        let count: u64 = self.cascades.iter().map(|cascade| u64::from(cascade.rays)).sum();
        planner.check_bytes(count * size_of::<Path>() as u64)?;
        let of = |cascade: &Cascade, number| Path::of(cascade, number, self.overlap);
        let rays = self.cascades.iter().flat_map(|c| (0..c.rays).map(move |number| (c, number)));
        let paths: Vec<Path> = rays.map(|(cascade, number)| of(cascade, number)).collect();
        planner.filled("paths", BufferUsages::STORAGE, bytemuck::cast_slice(&paths))
    }

    /// The layers, selected by each dispatch: batch by batch, the nearest cascade first.
    pub fn layers(&self, planner: &FramePlanner) -> Result<Buffer> {
        let rays = self.cascades[0].rays;
        let mut bytes = Vec::new();
        for cone in (0..rays).step_by(self.cones as usize) {
            let mut path = 0;
            for (i, cascade) in self.cascades.iter().enumerate() {
                let number = cascade.rays / rays * cone;
                let far = self.cascades.get(i + 1).map(|far| far.lattice);
                let layer = Layer {
                    count: cascade.lattice.count,
                    spacing: cascade.lattice.spacing,
                    path: path + number,
                    far_count: far.map_or([0; 2], |far| far.count),
                    far_spacing: far.map_or(0.0, |far| far.spacing),
                    cones: self.cones,
                    cone,
                    rays,
                    number,
                    angle: TAU / cascade.rays as f32,
                };
                path += cascade.rays;
                bytes.extend_from_slice(bytes_of(&layer));
                bytes.resize(bytes.len().next_multiple_of(STEP_BYTES as usize), 0);
            }
        }
        planner.filled("layers", BufferUsages::UNIFORM, &bytes)
    }

    /// The index of a cascade's layer in a batch.
    pub fn layer(&self, batch: u32, cascade: usize) -> u32 {
        batch * self.cascades.len() as u32 + cascade as u32
    }
}

/// Binds one of the layers, selected by each dispatch.
pub fn selected(layers: &Buffer) -> BindingResource<'_> {
    let size = NonZeroU64::new(size_of::<Layer>() as u64);
    BindingResource::Buffer(BufferBinding { buffer: layers, offset: 0, size })
}
