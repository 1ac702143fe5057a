//! Holographic radiance cascades as published (Freeman, Sannikov and Margel 2025, arXiv 2505.02041): the
//! GPU's `methods/holographic/paper` and `published.rs` of the library.
//!
//! Quadrant after quadrant, in the same buffers: trace the levels up to 2, extend the others, merge cones
//! down from the sky; at last a cross blur. A level a dispatch, in whole floats: plain, for comparison.
//!
//! About W²·(log₂W + 2) intervals of 16 B (24 B with tint) on a W×W grid, 300 MB with all else at 1024².
//! Each level has a buffer of its own, there of 34 MB at most (50 MB with tint): the limits of the web allow
//! 2048², with tint 1672².

mod tables;

use super::TILE;
use super::sweep::{Sweep, Sweeps};
use crate::Result;
use crate::cost::Traffic;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::lighting::Stage;
use crate::shaders;
use crate::site::{FOUR, ONE, Run, Site, view, whole};
use crate::stages::convergence::Convergence;
use lamplight::Bounces;
use lamplight::methods::holographic::paper::{Paper as Cpu, rays};
use lamplight::methods::holographic::planes;
use lamplight::stages::transmittance::LOG_OF_ZERO;
use std::num::NonZeroU64;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferUsages, Device};

/// Bytes of light, in cones and of a cell.
const LIGHT: u64 = 3 * ONE;

/// The pipelines.
#[derive(Debug)]
pub struct Paper {
    source: Kernels,
    /// Where no matter tints, and where some does.
    levels: [Levels; 2],
    gather: Kernels,
    /// Where light bounces until it has converged, with what sends it on then.
    convergence: Option<(Convergence, Kernels)>,
}

/// Those that know how intervals are stored.
#[derive(Debug)]
struct Levels {
    /// Bytes of an interval.
    bytes: u64,
    trace: Kernels,
    extend: Kernels,
    merge: Kernels,
}

impl Levels {
    fn new(device: &Device, words: u32) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        let stored = ("WORDS", f64::from(words));
        let kernels = |shader, entries: &[&'static str], own: &[_], constants: &[_]| {
            let slots = [&[Uniform, Step, Write], own].concat();
            Kernels::new(device, shader, entries, &slots, constants)
        };
        let log = ("LOG_OF_ZERO", f64::from(LOG_OF_ZERO));
        Self {
            bytes: u64::from(words) * ONE,
            trace: kernels(
                &shaders::PAPER_TRACE,
                &["main"],
                &[Read, Texture, Read],
                &[stored, log],
            ),
            extend: kernels(&shaders::PAPER_EXTEND, &["main"], &[Read], &[stored]),
            merge: kernels(
                &shaders::PAPER_MERGE,
                &["main", "last"],
                &[Read, Read, Read, Read],
                &[stored],
            ),
        }
    }

    /// The runs of a quadrant, told the sweeps from `first` on.
    fn quadrant(&self, site: &Site, axis: &Axis, buffers: &Buffers, first: u32) -> Vec<Dispatch> {
        let Buffers { sweeps, traced, intervals, radiance, .. } = buffers;
        let bytes = |level: u32| axis.intervals(level) * self.bytes;
        let stored = |level: u32| part(&intervals[level as usize], bytes(level));
        let run = |kernels: &Kernels, entry: usize, own: &[_], level, groups| {
            let bound = site.bind(kernels, &[&[sweeps.binding()], own].concat());
            Dispatch::new(&kernels.entries[entry], &bound, Some(first + level), groups)
        };
        let mut runs = Vec::new();
        for level in 0..=axis.top() {
            let groups = axis.groups(rays(level) as u32, level);
            runs.push(if level <= *traced {
                let own = [
                    stored(level),
                    whole(buffers.source),
                    view(&site.textures.tint_opacity),
                    whole(&buffers.ways),
                ];
                run(&self.trace, 0, &own, level, groups)
            } else {
                run(&self.extend, 0, &[stored(level), stored(level - 1)], level - 1, groups)
            });
        }
        for level in (0..=axis.top()).rev() {
            let above = (level + 1).min(axis.top());
            let entry = usize::from(level == 0);
            let made = match level {
                0 => whole(buffers.fluence),
                _ => part(&radiance[level as usize % 2], axis.cones(level) * LIGHT),
            };
            let far = whole(&radiance[(level as usize + 1) % 2]);
            let own = [made, stored(level), stored(above), far, whole(&buffers.cones)];
            let mut merge = run(&self.merge, entry, &own, level, axis.groups(1 << level, level));
            // Of the level every other plane, of that above every other ray.
            let intervals = (bytes(level) + bytes(above)) / 2;
            let light = axis.cones(level) * LIGHT;
            let read = intervals + axis.cones(above) * LIGHT + if level == 0 { light } else { 0 };
            merge.traffic = Traffic { read, written: light };
            runs.push(merge);
        }
        runs
    }
}

/// Binds the first bytes of a buffer.
fn part(buffer: &Buffer, bytes: u64) -> BindingResource<'_> {
    BindingResource::Buffer(BufferBinding { buffer, offset: 0, size: NonZeroU64::new(bytes) })
}

/// The grid along an axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// 0: slabs are columns; 1: rows.
    axis: u32,
    depth: u32,
    rows: u32,
}

impl Axis {
    /// Rays of this level reach through the whole grid.
    fn top(&self) -> u32 {
        self.depth.next_power_of_two().ilog2()
    }

    fn planes(&self, level: u32) -> u32 {
        planes(self.depth as usize, level) as u32
    }

    /// Intervals of a level.
    fn intervals(&self, level: u32) -> u64 {
        u64::from(self.planes(level)) * rays(level) as u64 * u64::from(self.rows)
    }

    /// Cones of a level.
    fn cones(&self, level: u32) -> u64 {
        (u64::from(self.planes(level)) << level) * u64::from(self.rows)
    }

    /// Workgroups for so many rays or cones from every row of the planes of a level.
    fn groups(&self, across: u32, level: u32) -> [u32; 3] {
        [self.rows.div_ceil(TILE), across, self.planes(level)]
    }
}

/// What quadrants read and write.
struct Buffers<'a> {
    sweeps: Sweeps,
    /// Up to this level intervals are traced.
    traced: u32,
    source: &'a Buffer,
    ways: Buffer,
    cones: Buffer,
    /// Level by level.
    intervals: Vec<Buffer>,
    /// Light of cones, of levels of even and of odd number.
    radiance: [Buffer; 2],
    fluence: &'a Buffer,
}

impl Paper {
    pub fn new(device: &Device, bounces: Bounces) -> Self {
        use Slot::{Read, Texture, Uniform, Write};
        let kernels = |shader, entries: &[&'static str], slots: &[_]| {
            Kernels::new(device, shader, entries, slots, &[])
        };
        let source = |entries: &[&'static str], more: &[_]| {
            let slots = [&[Uniform, Texture, Texture, Texture, Read, Write], more].concat();
            kernels(&shaders::PAPER_SOURCE, entries, &slots)
        };
        let converges = bounces == Bounces::Converged;
        Self {
            source: source(&["main", "bounce"], &[]),
            levels: [Levels::new(device, 4), Levels::new(device, 6)],
            gather: kernels(&shaders::PAPER_GATHER, &["main"], &[Uniform, Texture, Read, Write]),
            convergence: converges
                .then(|| (Convergence::new(device), source(&["bounce_on"], &[Write]))),
        }
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        let source = site.buffer("source", site.cells() * FOUR)?;
        let fluence = site.buffer("fluence", site.cells() * LIGHT)?;
        let quadrants = self.quadrants(site, &source, &fluence)?;
        let textures = site.textures;
        let seen = [
            view(&textures.emission),
            view(&textures.albedo),
            view(&textures.tint_opacity),
            whole(light),
            whole(&source),
        ];
        let see = site.bind(&self.source, &seen);
        let resources = [view(&textures.tint_opacity), whole(&fluence), whole(light)];
        let show = site.bind(&self.gather, &resources);
        let solve = |see: Dispatch| -> Vec<_> {
            let show = site.over_cells(&self.gather, 0, &show, None);
            [see].into_iter().chain(quadrants.iter().cloned()).chain([show]).collect()
        };
        // Direct light, then what it makes surfaces send on, as often as light bounces.
        let mut dispatches = solve(site.over_cells(&self.source, 0, &see, None));
        if let Some((convergence, bounce_on)) = &self.convergence {
            let found = Convergence::found(site)?;
            let see = site.bind(bounce_on, &[&seen[..], &[whole(&found)]].concat());
            let round = solve(site.over_cells(bounce_on, 0, &see, None));
            dispatches.extend(convergence.plan(site, &found, [round.clone(), round])?);
        } else {
            for _ in 0..site.settings.bounces.limit() {
                dispatches.extend(solve(site.over_cells(&self.source, 1, &see, None)));
            }
        }
        Ok(Run { dispatches, stages: vec![(Stage::Light, light.clone())], lamps: None })
    }

    /// What turns cells into the fluence of all four quadrants.
    fn quadrants(&self, site: &Site, source: &Buffer, fluence: &Buffer) -> Result<Vec<Dispatch>> {
        let levels = &self.levels[usize::from(site.known.tinted)];
        let [width, height] = site.size;
        let axes = [
            Axis { axis: 0, depth: width, rows: height },
            Axis { axis: 1, depth: height, rows: width },
        ];
        let [a, b] = axes.each_ref();
        let top = a.top().max(b.top());
        let traced = Cpu::published().traced;
        let (way_begins, ways) = tables::traced_ways(traced);
        let (cone_begins, cones) = tables::cones(top + 1);

        let mut sweeps = Vec::new();
        for axis in &axes {
            for reversed in [0, 1] {
                sweeps.extend((0..=axis.top()).map(|level| Sweep {
                    depth: axis.depth,
                    rows: axis.rows,
                    axis: axis.axis,
                    reversed,
                    level,
                    levels: u32::from(level < axis.top()),
                    cones_top: cone_begins[level as usize],
                    begins: u32::from(axis.axis == 0 && reversed == 0),
                    ways: way_begins.get(level as usize).copied().unwrap_or(0),
                    ..Sweep::default()
                }));
            }
        }
        let most = |level: u32, of: fn(&Axis, u32) -> u64| {
            let there = axes.iter().filter(|axis| level <= axis.top());
            there.map(|axis| of(axis, level)).max().unwrap_or(0)
        };
        let interval =
            |level| site.buffer("intervals", most(level, Axis::intervals) * levels.bytes);
        let cones_held = (0..=top).map(|level| most(level, Axis::cones)).max().unwrap_or(0);
        let buffers = Buffers {
            sweeps: Sweeps::new(site, &sweeps)?,
            traced,
            source,
            ways: site.filled("ways", BufferUsages::STORAGE, bytemuck::cast_slice(&ways))?,
            cones: site.filled("cones", BufferUsages::STORAGE, bytemuck::cast_slice(&cones))?,
            intervals: (0..=top).map(interval).collect::<Result<_>>()?,
            radiance: site.pair("light of cones", cones_held * LIGHT)?,
            fluence,
        };
        let mut dispatches = Vec::new();
        for (first, sweep) in (0..).zip(&sweeps).filter(|(_, sweep)| sweep.level == 0) {
            let axis = &axes[sweep.axis as usize];
            dispatches.extend(levels.quadrant(site, axis, &buffers, first));
        }
        Ok(dispatches)
    }
}
