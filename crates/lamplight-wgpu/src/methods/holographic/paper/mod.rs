//! Holographic radiance cascades as published (Freeman, Sannikov and Margel 2025, arXiv 2505.02041).
//!
//! Quadrant after quadrant, in the same buffers: trace the levels up to 2, extend the others, merge cones
//! down from the sky; at last a cross blur. One dispatch per level, in whole floats: plain, for comparison.
//!
//! About W²·(log₂W + 2) intervals of 16 B (24 B with tint) on a W×W grid, 300 MB with all else at 1024².
//! Each level has a buffer of its own, there of 34 MB at most (50 MB with tint): the limits of the web allow
//! 2048², with tint 1672².

mod tables;

use super::lattice::TILE;
use super::sky::{ConeSky, ConeTable};
use super::sweep::{Sweep, Sweeps};
use crate::compiler::Compiler;
use crate::error::Result;
use crate::pass_list::PassList;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use crate::stage::Stage;
use crate::stages::convergence::Convergence;
use crate::stages::gradient_moment::GradientMoment;
use crate::traffic::Traffic;
use lamplight::Bounces;
use lamplight::internals::MAX_OPTICAL_DEPTH;
use lamplight::internals::holographic::lattice::planes;
use lamplight::internals::holographic::paper::{Paper as Cpu, rays};
use std::num::NonZeroU64;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferUsages};

/// Light, in cones and of a cell.
type Rgb = [f32; 3];
/// Bytes of [`Rgb`].
const RGB: u64 = size_of::<Rgb>() as u64;

/// The pipelines.
#[derive(Debug)]
pub struct Paper {
    source: ComputePipelines,
    /// Without tint, and with tint.
    levels: [LevelPipelines; 2],
    gather: ComputePipelines,
    /// Set if the first moment is found.
    moment: Option<GradientMoment>,
    /// Set if light bounces until it has converged, with the pipeline that scatters light then.
    convergence: Option<(Convergence, ComputePipelines)>,
}

/// The pipelines that depend on how intervals are stored.
#[derive(Debug)]
struct LevelPipelines {
    /// Bytes of an interval.
    bytes: u64,
    trace: ComputePipelines,
    extend: ComputePipelines,
    merge: ComputePipelines,
}

impl LevelPipelines {
    fn new(compiler: &Compiler, words: u32) -> Self {
        let stored = ("WORDS", f64::from(words));
        let trace = [stored, ("MAX_OPTICAL_DEPTH", f64::from(MAX_OPTICAL_DEPTH))];
        Self {
            bytes: u64::from(words) * size_of::<f32>() as u64,
            trace: compiler.program(&programs::PAPER_TRACE, &trace),
            extend: compiler.program(&programs::PAPER_EXTEND, &[stored]),
            merge: compiler.program(&programs::PAPER_MERGE, &[stored]),
        }
    }

    /// Plans a quadrant, whose sweeps begin at `first`.
    fn quadrant(
        &self,
        planner: &FramePlanner,
        axis: &PaperAxis,
        buffers: &PaperBuffers,
        first: u32,
    ) -> Vec<Dispatch> {
        let PaperBuffers { sweeps, traced, intervals, radiance, .. } = buffers;
        let bytes = |level: u32| axis.intervals(level) * self.bytes;
        let stored = |level: u32| part(&intervals[level as usize], bytes(level));
        let plan = |pipelines: &ComputePipelines, entry: usize, own: &[_], level, groups| {
            let bound = planner.bind(pipelines, &[&[sweeps.binding()], own].concat());
            Dispatch::new(pipelines.entry(entry), &bound, Some(first + level), groups)
        };
        let mut dispatches = Vec::new();
        for level in 0..=axis.top() {
            let groups = axis.groups(rays(level) as u32, level);
            dispatches.push(if level <= *traced {
                let own = [
                    stored(level),
                    whole(buffers.source),
                    view(&planner.textures.tint_opacity),
                    whole(&buffers.footprints),
                ];
                plan(&self.trace, 0, &own, level, groups)
            } else {
                plan(&self.extend, 0, &[stored(level), stored(level - 1)], level - 1, groups)
            });
        }
        for level in (0..=axis.top()).rev() {
            let above = (level + 1).min(axis.top());
            let entry = usize::from(level == 0);
            let made = if level == 0 {
                whole(buffers.total)
            } else {
                part(&radiance[level as usize % 2], axis.cones(level) * RGB)
            };
            let far = whole(&radiance[(level as usize + 1) % 2]);
            let own = [made, stored(level), stored(above), far, whole(&buffers.cones)];
            let mut merge = plan(&self.merge, entry, &own, level, axis.groups(1 << level, level));
            // Every other plane of the level, and every other ray of the level above.
            let intervals = (bytes(level) + bytes(above)) / 2;
            let light = axis.cones(level) * RGB;
            let read = intervals + axis.cones(above) * RGB + if level == 0 { light } else { 0 };
            merge.traffic = Traffic { read, written: light };
            dispatches.push(merge);
        }
        dispatches
    }
}

/// Binds the first bytes of a buffer.
fn part(buffer: &Buffer, bytes: u64) -> BindingResource<'_> {
    BindingResource::Buffer(BufferBinding { buffer, offset: 0, size: NonZeroU64::new(bytes) })
}

/// The grid along an axis.
#[derive(Clone, Copy, Debug)]
struct PaperAxis {
    /// 0: slabs are columns; 1: rows.
    axis: u32,
    depth: u32,
    rows: u32,
}

impl PaperAxis {
    /// The level whose rays reach through the whole grid.
    fn top(&self) -> u32 {
        self.depth.next_power_of_two().ilog2()
    }

    fn planes(&self, level: u32) -> u32 {
        planes(self.depth as usize, level) as u32
    }

    /// The number of intervals of a level.
    fn intervals(&self, level: u32) -> u64 {
        u64::from(self.planes(level)) * rays(level) as u64 * u64::from(self.rows)
    }

    /// The number of cones of a level.
    fn cones(&self, level: u32) -> u64 {
        (u64::from(self.planes(level)) << level) * u64::from(self.rows)
    }

    /// Workgroups for `across` rays or cones from every row of the planes of a level.
    fn groups(&self, across: u32, level: u32) -> [u32; 3] {
        [self.rows.div_ceil(TILE), across, self.planes(level)]
    }
}

/// The buffers that quadrants read and write.
struct PaperBuffers<'a> {
    sweeps: Sweeps,
    /// The last level that is traced.
    traced: u32,
    source: &'a Buffer,
    footprints: Buffer,
    cones: Buffer,
    /// Level by level.
    intervals: Vec<Buffer>,
    /// Light of cones, of levels of even and of odd number.
    radiance: [Buffer; 2],
    /// Light of cells from all directions, ∫L dω.
    total: &'a Buffer,
}

impl Paper {
    pub fn new(compiler: &Compiler, bounces: Bounces, moment: bool) -> Self {
        let new = |program| compiler.program(program, &[]);
        let converged = || (Convergence::new(compiler), new(&programs::PAPER_SOURCE_COMPARED));
        Self {
            source: new(&programs::PAPER_SOURCE),
            levels: [LevelPipelines::new(compiler, 4), LevelPipelines::new(compiler, 6)],
            gather: new(&programs::PAPER_GATHER),
            moment: moment.then(|| GradientMoment::new(compiler)),
            convergence: (bounces == Bounces::Converged).then(converged),
        }
    }

    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        let source = planner.buffer::<[f32; 4]>("source", planner.cells())?;
        let total = planner.buffer::<Rgb>("light of all directions", planner.cells())?;
        let (quadrants, sky) = self.quadrants(planner, &source, &total)?;
        let textures = planner.textures;
        let read = [
            view(&textures.emission),
            view(&textures.albedo),
            view(&textures.tint_opacity),
            whole(light),
            whole(&source),
        ];
        let sources = planner.bind(&self.source, &read);
        let resources = [view(&textures.tint_opacity), whole(&total), whole(light)];
        let gather = planner.bind(&self.gather, &resources);
        let solve = |source: Dispatch| -> Vec<_> {
            let gather = planner.over_cells(&self.gather, 0, &gather, None);
            let gathered = [source].into_iter().chain(quadrants.iter().cloned()).chain([gather]);
            let moment = self.moment.iter().map(|moment| moment.plan(planner, light));
            gathered.chain(moment).chain(planner.add_direct(light)).collect()
        };
        // Direct light, then the light that it makes cells scatter, once per bounce.
        let mut dispatches = solve(planner.over_cells(&self.source, 0, &sources, None));
        if let Some((convergence, compared)) = &self.convergence {
            let changes = Convergence::changes(planner)?;
            let sources = planner.bind(compared, &[&read[..], &[whole(&changes)]].concat());
            let bounce = solve(planner.over_cells(compared, 0, &sources, None));
            dispatches.extend(convergence.plan(planner, &changes, bounce.clone(), bounce)?);
        } else {
            for _ in 0..planner.settings.bounces.limit() {
                dispatches.extend(solve(planner.over_cells(&self.source, 1, &sources, None)));
            }
        }
        let stages = vec![(Stage::Light, light.clone())];
        Ok(PassList { sky, ..PassList::new(dispatches, stages) })
    }

    /// Plans the light of cells from all four quadrants. Returns the light of the sky in their cones too.
    fn quadrants(
        &self,
        planner: &FramePlanner,
        source: &Buffer,
        total: &Buffer,
    ) -> Result<(Vec<Dispatch>, Option<ConeSky>)> {
        let levels = &self.levels[usize::from(planner.hints.tinted)];
        let [width, height] = planner.size.into();
        let axes = [
            PaperAxis { axis: 0, depth: width, rows: height },
            PaperAxis { axis: 1, depth: height, rows: width },
        ];
        let [a, b] = axes.each_ref();
        let top = a.top().max(b.top());
        let traced = Cpu::published().traced;
        let (footprint_begins, footprints) = tables::traced_footprints(traced);
        let cones = ConeTable::of_paper(top + 1);

        let mut sweeps = Vec::new();
        for axis in &axes {
            for reversed in [0, 1] {
                sweeps.extend((0..=axis.top()).map(|level| Sweep {
                    depth: axis.depth,
                    rows: axis.rows,
                    cell_depth: axis.depth,
                    cell_rows: axis.rows,
                    axis: axis.axis,
                    reversed,
                    level,
                    cones_above: cones.begins[axis.axis as usize][level as usize],
                    turn: 2 * axis.axis + reversed,
                    sky: ConeTable::light_of(cones.entries(), axis.axis, reversed),
                    footprints: footprint_begins.get(level as usize).copied().unwrap_or(0),
                    ..Sweep::default()
                }));
            }
        }
        let most = |level: u32, of: fn(&PaperAxis, u32) -> u64| {
            let present = axes.iter().filter(|axis| level <= axis.top());
            present.map(|axis| of(axis, level)).max().unwrap_or(0)
        };
        let interval = |level| {
            let bytes = most(level, PaperAxis::intervals) * levels.bytes;
            planner.buffer_of_bytes("intervals", bytes)
        };
        let cones_held = (0..=top).map(|level| most(level, PaperAxis::cones)).max().unwrap_or(0);
        let storage = BufferUsages::STORAGE;
        let footprints =
            planner.filled("footprints", storage, bytemuck::cast_slice(&footprints))?;
        let buffers = PaperBuffers {
            sweeps: Sweeps::new(planner, &sweeps.iter().map(|&sweep| [sweep]).collect::<Vec<_>>())?,
            traced,
            source,
            footprints,
            cones: cones.buffer(planner)?,
            intervals: (0..=top).map(interval).collect::<Result<_>>()?,
            radiance: planner.pair::<Rgb>("light of cones", cones_held)?,
            total,
        };
        let mut dispatches = Vec::new();
        for (first, sweep) in (0..).zip(&sweeps).filter(|(_, sweep)| sweep.level == 0) {
            let axis = &axes[sweep.axis as usize];
            dispatches.extend(levels.quadrant(planner, axis, &buffers, first));
        }
        let sky = planner.has_panorama().then(|| ConeSky::new(cones, buffers.cones));
        Ok((dispatches, sky))
    }
}
