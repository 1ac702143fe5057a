//! Radiance cascades (Sannikov 2023).
//!
//! From the last cascade to the first, one dispatch each: every thread takes a probe, traces the four rays of a
//! cone through their intervals, reads behind them what the four probes of the next cascade around have
//! gathered, and keeps the mean: `L = r + T·L_next`. Intervals never go to memory. The means lie cone by cone
//! with the probes side by side, so that neighbouring threads read and write neighbouring addresses, and in two
//! buffers in turns, since only the next nearer cascade reads them.

pub mod ladder;

use crate::error::{Result, unsupported};
use crate::pass_list::PassList;
use crate::pipeline::{BoundResources, ComputePipelines, Dispatch, WORKGROUP};
use crate::planner::{FramePlanner, view, whole};
use crate::shared::filled;
use crate::stage::Stage;
use crate::stages::compare::Compare;
use crate::stages::convergence::Convergence;
use crate::stages::empty_space::EmptySpace;
use crate::stages::medium_grid::{MediumGrid, MediumGridPipelines};
use crate::stages::packet::PACKET;
use crate::{programs, shaders};
use ladder::Ladder;
use lamplight::internals::cascades::{BEFORE, cosine};
use lamplight::settings::{Bounces, Cascades as Settings, Merge};
use wgpu::{BindingResource, Buffer, BufferUsages, Device, Queue};

/// The pipelines, and buffers that are the same for every grid.
#[derive(Debug)]
pub struct Cascades {
    settings: Settings,
    medium_grid: MediumGridPipelines,
    empty_space: EmptySpace,
    /// For scattered radiance, and for light.
    passes: Passes,
    /// For light, if its first moment is found.
    moment: Option<Passes>,
    cosines: Buffer,
    /// Set if light bounces until it has converged.
    convergence: Option<(Convergence, Compare)>,
}

/// The pipelines of a gather.
#[derive(Debug)]
struct Passes {
    merge: ComputePipelines,
    gather: ComputePipelines,
}

/// The buffers of a plan.
struct Plan<'a> {
    planner: &'a FramePlanner<'a>,
    ladder: Ladder,
    paths: Buffer,
    layers: Buffer,
    /// The means of cascades of even and of odd number.
    halves: [Buffer; 2],
    grid: MediumGrid,
    squares: Buffer,
}

/// A gather: what it reads, and where its result goes.
#[derive(Clone, Copy)]
struct GatherTarget<'a> {
    /// Entry of [`programs::CASCADES_GATHER`].
    entry: usize,
    /// Scattered radiance counts from step 1 on.
    step: u32,
    scattered: &'a Buffer,
    to: &'a Buffer,
}

/// Entries of [`programs::CASCADES_GATHER`]: light, or the scattered radiance of the next bounce.
const LIGHT: usize = 0;
const SCATTERED: usize = 1;

impl Cascades {
    pub fn new(
        device: &Device,
        queue: &Queue,
        settings: &Settings,
        bounces: Bounces,
        moment: bool,
    ) -> lamplight::Result<Self> {
        let fix = match settings.merge {
            Merge::Plain => 0.0,
            Merge::BilinearFix => 1.0,
            other => return Err(unsupported("cascades.merge", other)),
        };
        let merge = [PACKET, &[("ENDS", 1.0), ("BILINEAR_FIX", fix)]].concat();
        let gather = [&merge[..], &[("BEFORE", BEFORE.into())]].concat();
        let passes = |moment: bool| {
            let [merge, gather] = [&merge, &gather]
                .map(|constants| [constants, &[shaders::moment(moment)][..]].concat());
            Passes {
                merge: ComputePipelines::new(device, &programs::CASCADES_MERGE, &merge),
                gather: ComputePipelines::new(device, &programs::CASCADES_GATHER, &gather),
            }
        };
        let rays = settings.nearest_rays();
        let cosines = |cone| [0, 1, 2, 3].map(|face| cosine(face, cone, rays));
        let cosines: Vec<[f32; 4]> = (0..rays).map(cosines).collect();
        let cosines = bytemuck::cast_slice(&cosines);
        let converges = bounces == Bounces::Converged;
        Ok(Self {
            settings: settings.clone(),
            // As in `raymarch`, squares are not found again in each of many recorded bounces.
            medium_grid: MediumGridPipelines::new(device, converges),
            empty_space: EmptySpace::new(device),
            passes: passes(false),
            moment: moment.then(|| passes(true)),
            cosines: filled(device, queue, "cosines", BufferUsages::STORAGE, cosines),
            convergence: converges.then(|| (Convergence::new(device), Compare::new(device))),
        })
    }

    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        let ladder = Ladder::over(planner, &self.settings)?;
        let (paths, layers) = (ladder.paths(planner)?, ladder.layers(planner)?);
        let halves = planner.pair::<[f32; 4]>("cascades", ladder.means())?;
        let grid = self.medium_grid.buffers(planner)?;
        let bounces = planner.settings.bounces.limit();
        let faces = if planner.settings.bounces == Bounces::Count(0) { 0 } else { 4 };
        let scattered = planner.pair::<[f32; 4]>("scattered", (planner.cells() * faces).max(1))?;
        let (squares, find_squares) = self.empty_space.plan(planner, &grid)?;
        let plan = Plan { planner, ladder, paths, layers, halves, grid, squares };

        let mut dispatches = vec![self.medium_grid.read(planner, &plan.grid, &scattered[0])];
        dispatches.extend_from_slice(&find_squares);
        let [mut from, mut to] = scattered.each_ref();
        if let Some((convergence, compare)) = &self.convergence {
            let changes = Convergence::changes(planner)?;
            let [first, later] = [0, 1].map(|step| {
                let target = GatherTarget { entry: SCATTERED, step, scattered: from, to };
                let mut bounce = self.gather(&plan, target);
                bounce.extend(planner.scatter_direct(to));
                bounce.push(compare.plan(planner, to, from, &changes, step));
                bounce.push(self.medium_grid.light_media(planner, &plan.grid, from));
                bounce
            });
            dispatches.extend(convergence.plan(planner, &changes, first, later)?);
        } else {
            for bounce in 0..bounces {
                let target =
                    GatherTarget { entry: SCATTERED, step: bounce.min(1), scattered: from, to };
                dispatches.extend(self.gather(&plan, target));
                dispatches.extend(planner.scatter_direct(to));
                dispatches.push(self.medium_grid.light_media(planner, &plan.grid, to));
                // Media that scatter other light are other matter to empty-space skipping.
                dispatches.extend_from_slice(&find_squares);
                (from, to) = (to, from);
            }
        }
        let target =
            GatherTarget { entry: LIGHT, step: bounces.min(1), scattered: from, to: light };
        dispatches.extend(self.gather(&plan, target));
        dispatches.extend(planner.add_direct(light));
        let stages = vec![(Stage::EmptySpace, plan.squares), (Stage::Light, light.clone())];
        Ok(PassList::new(dispatches, stages))
    }

    /// Plans a gather over all cones of the nearest cascade, batch by batch.
    fn gather(&self, plan: &Plan, target: GatherTarget) -> Vec<Dispatch> {
        let with_moment = self.moment.as_ref().filter(|_| target.entry == LIGHT);
        let Passes { merge: merges, gather: gathers } = with_moment.unwrap_or(&self.passes);
        let merge = [0, 1].map(|half: usize| {
            let [far, near] = [&plan.halves[1 - half], &plan.halves[half]];
            plan.bind(merges, GatherTarget { to: near, ..target }, far, &[])
        });
        let more = [view(&plan.planner.textures.albedo), whole(&self.cosines)];
        let gather = plan.bind(gathers, target, &plan.halves[1], &more);
        let mut dispatches = Vec::new();
        for batch in 0..plan.ladder.batches() {
            for further in (1..plan.ladder.cascades.len()).rev() {
                let [columns, rows] = plan.ladder.cascades[further].lattice.count;
                let cones = plan.ladder.cones_before(further) as u32;
                let groups = [columns.div_ceil(WORKGROUP), rows.div_ceil(WORKGROUP), cones];
                let (pipeline, bound) = (&merges.entries[0], &merge[further % 2]);
                let layer = plan.ladder.layer(batch, further);
                dispatches.push(Dispatch::new(pipeline, bound, Some(layer), groups));
            }
            let nearest = Some(plan.ladder.layer(batch, 0));
            dispatches.push(plan.planner.over_cells(gathers, target.entry, &gather, nearest));
        }
        dispatches
    }
}

impl Plan<'_> {
    /// Binds the resources of a merge, or of a gather, which has some more.
    fn bind(
        &self,
        pipelines: &ComputePipelines,
        target: GatherTarget,
        far: &Buffer,
        more: &[BindingResource],
    ) -> BoundResources {
        let Self { planner, grid, .. } = self;
        let mut resources = vec![
            whole(&self.paths),
            whole(far),
            whole(&grid.source),
            whole(&grid.extinction),
            whole(&self.squares),
            whole(target.scattered),
            planner.shared.number(target.step),
            ladder::selected(&self.layers),
            whole(target.to),
            planner.panorama(),
        ];
        resources.extend_from_slice(more);
        planner.bind(pipelines, &resources)
    }
}
