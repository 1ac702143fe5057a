//! The cascades of a grid, as the shaders are told of them, and how many cones go at once.
//!
//! What lies within one cone of the nearest cascade needs nothing from beside it. So where the means
//! that a cascade keeps in all cones would be more than [`MOST`] bytes, cones are worked out in several
//! batches, whose light adds up.

use crate::Result;
use crate::kernel::STEP_BYTES;
use crate::site::{FOUR, Site, too_large};
use bytemuck::{Pod, Zeroable, bytes_of};
use lamplight::methods::cascades::{BRANCHES, Cascade, cascades, mean_sine};
#[cfg(test)]
use std::mem::offset_of;
use std::num::NonZeroU64;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferUsages};

/// Bytes of the means of a cascade that are kept at once. More: fewer dispatches on large grids; less:
/// more of them stay in the GPU's caches.
const MOST: u64 = 48 << 20;

/// px that endless rays go: out of any grid from anywhere around it.
const ENDLESS: f32 = 1e9;

/// `Path` of shaders/cascades/merge.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Path {
    start: [f32; 2],
    step: [f32; 2],
    way: [f32; 2],
    length: f32,
    sine: f32,
}

impl Path {
    /// Fields in order, with where they begin.
    #[cfg(test)]
    pub const OFFSETS: [(&'static str, usize); 5] = [
        ("start", offset_of!(Path, start)),
        ("step", offset_of!(Path, step)),
        ("way", offset_of!(Path, way)),
        ("length", offset_of!(Path, length)),
        ("sine", offset_of!(Path, sine)),
    ];

    fn of(cascade: &Cascade, number: u32, overlap: f32) -> Self {
        let path = cascade.path(number, overlap);
        Self {
            start: path.start,
            step: [path.end[0] - path.start[0], path.end[1] - path.start[1]],
            way: path.way,
            length: path.length.min(ENDLESS),
            sine: mean_sine(number, cascade.rays),
        }
    }
}

/// `Layer` of shaders/cascades/merge.wgsl: one cascade in one batch.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Layer {
    count: [u32; 2],
    spacing: f32,
    path: u32,
    far_count: [u32; 2],
    far_spacing: f32,
    cones: u32,
    cone: u32,
    rays: u32,
}

impl Layer {
    /// Fields in order, with where they begin.
    #[cfg(test)]
    pub const OFFSETS: [(&'static str, usize); 8] = [
        ("count", offset_of!(Layer, count)),
        ("spacing", offset_of!(Layer, spacing)),
        ("path", offset_of!(Layer, path)),
        ("far_count", offset_of!(Layer, far_count)),
        ("far_spacing", offset_of!(Layer, far_spacing)),
        ("cones", offset_of!(Layer, cones)),
        ("cone", offset_of!(Layer, cone)),
        ("rays", offset_of!(Layer, rays)),
    ];
}

/// The cascades of a grid.
#[derive(Debug)]
pub struct Ladder {
    /// The nearest first.
    pub cascades: Vec<Cascade>,
    /// Cones of the nearest that are worked out at once.
    cones: u32,
}

impl Ladder {
    /// Refuses a grid with so many directions that the device cannot run through them.
    pub fn over(site: &Site) -> Result<Self> {
        let mut all = Vec::new();
        cascades(site.size, &site.settings.cascades, &mut all);
        let limits = site.device.limits();
        let layers = u64::from(limits.max_compute_workgroups_per_dimension);
        let bytes = MOST.min(limits.max_storage_buffer_binding_size);
        let rays = all[0].rays;
        let mut ladder = Self { cascades: all, cones: rays };
        while ladder.cones > 1 && (ladder.layers_of_groups() > layers || ladder.bytes() > bytes) {
            ladder.cones /= 2;
        }
        match ladder.layers_of_groups() {
            needed if needed > layers => {
                Err(too_large(site.size, "layers of workgroups", needed, layers))
            }
            _ => Ok(ladder),
        }
    }

    /// Times that cones are worked out.
    pub fn batches(&self) -> u32 {
        self.cascades[0].rays / self.cones
    }

    /// Cones at once of the cascade before a further one.
    pub fn cones_before(&self, further: usize) -> u64 {
        u64::from(self.cones) * u64::from(BRANCHES).pow(further as u32 - 1)
    }

    fn layers_of_groups(&self) -> u64 {
        (1..self.cascades.len()).map(|further| self.cones_before(further)).max().unwrap_or(1)
    }

    /// Bytes of what any cascade keeps.
    pub fn bytes(&self) -> u64 {
        let means = |further: usize| {
            self.cones_before(further) * self.cascades[further].lattice.len() as u64
        };
        (1..self.cascades.len()).map(means).max().unwrap_or(1) * FOUR
    }

    /// The paths of all rays, cascade by cascade.
    pub fn paths(&self, site: &Site) -> Result<Buffer> {
        let count: u64 = self.cascades.iter().map(|cascade| u64::from(cascade.rays)).sum();
        site.allows(count * size_of::<Path>() as u64)?;
        let overlap = site.settings.cascades.overlap;
        let of = |cascade: &Cascade, number| Path::of(cascade, number, overlap);
        let rays = self.cascades.iter().flat_map(|c| (0..c.rays).map(move |number| (c, number)));
        let paths: Vec<Path> = rays.map(|(cascade, number)| of(cascade, number)).collect();
        site.filled("paths", BufferUsages::STORAGE, bytemuck::cast_slice(&paths))
    }

    /// What each dispatch is told, batch by batch, the nearest cascade first.
    pub fn layers(&self, site: &Site) -> Result<Buffer> {
        let rays = self.cascades[0].rays;
        let mut bytes = Vec::new();
        for cone in (0..rays).step_by(self.cones as usize) {
            let mut path = 0;
            for (i, cascade) in self.cascades.iter().enumerate() {
                let far = self.cascades.get(i + 1).map(|far| far.lattice);
                let layer = Layer {
                    count: cascade.lattice.count,
                    spacing: cascade.lattice.spacing,
                    path: path + cascade.rays / rays * cone,
                    far_count: far.map_or([0; 2], |far| far.count),
                    far_spacing: far.map_or(0.0, |far| far.spacing),
                    cones: self.cones,
                    cone,
                    rays,
                };
                path += cascade.rays;
                bytes.extend_from_slice(bytes_of(&layer));
                bytes.resize(bytes.len().next_multiple_of(STEP_BYTES as usize), 0);
            }
        }
        site.filled("layers", BufferUsages::UNIFORM, &bytes)
    }

    /// The number of a cascade's layer in a batch.
    pub fn layer(&self, batch: u32, cascade: usize) -> u32 {
        batch * self.cascades.len() as u32 + cascade as u32
    }
}

/// Binds one of the layers; which one is said when it runs.
pub fn first(layers: &Buffer) -> BindingResource<'_> {
    let size = NonZeroU64::new(size_of::<Layer>() as u64);
    BindingResource::Buffer(BufferBinding { buffer: layers, offset: 0, size })
}
