//! Radiance cascades (Sannikov 2023).
//!
//! From the last cascade to the first, one dispatch each: every thread takes a probe, traces the four rays of a
//! cone through their intervals, reads behind them what the four probes of the next cascade around have
//! gathered, and keeps the mean: `L = r + T·L_next`. Intervals never go to memory. The means lie cone by cone
//! with the probes side by side, so that neighbouring threads read and write neighbouring addresses, and in two
//! buffers in turns, since only the next nearer cascade reads them.

pub mod ladder;

use crate::compiler::Compiler;
use crate::error::{Result, unsupported};
use crate::pass_list::PassList;
use crate::pipeline::{BoundResources, ComputePipelines, Dispatch, WORKGROUP};
use crate::planner::{FramePlanner, view, whole};
use crate::shared::filled;
use crate::stage::Stage;
use crate::stages::bounce::{Bounce, FACES};
use crate::stages::compare::Compare;
use crate::stages::convergence::Convergence;
use crate::stages::empty_space::EmptySpace;
use crate::stages::feedback::Feedback;
use crate::stages::medium_grid::{MediumGrid, MediumGridPipelines};
use crate::stages::packet::PACKET;
use crate::{programs, shaders};
use ladder::Ladder;
use lamplight::internals::cascades::{BEFORE, cosine};
use lamplight::settings::{Bounces, Cascades as Settings, Merge};
use wgpu::{BindingResource, Buffer, BufferUsages, Queue};

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
    bounce: Bounce<Compare, Feedback>,
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

/// The scattered radiance that a gather reads. It counts from step 1 on.
#[derive(Clone, Copy)]
struct Indirect<'a> {
    step: u32,
    scattered: &'a Buffer,
}

/// Entries of [`programs::CASCADES_GATHER`]: light, or the scattered radiance of the next bounce.
const LIGHT: usize = 0;
const SCATTERED: usize = 1;

impl Cascades {
    pub fn new(
        compiler: &Compiler,
        queue: &Queue,
        settings: &Settings,
        bounces: Bounces,
        moment: bool,
        inflow: bool,
    ) -> lamplight::Result<Self> {
        let fix = match settings.merge {
            Merge::Plain => 0.0,
            Merge::BilinearFix => 1.0,
            other => return Err(unsupported("cascades.merge", other)),
        };
        let own = [("ENDS", 1.0), ("BILINEAR_FIX", fix)];
        let merge = [PACKET, &own, &shaders::inflow(inflow)].concat();
        let gather = [&merge[..], &[("BEFORE", BEFORE.into())]].concat();
        let passes = |moment: bool| {
            let [merge, gather] = [&merge, &gather]
                .map(|constants| [constants, &[shaders::moment(moment)][..]].concat());
            Passes {
                merge: compiler.program(&programs::CASCADES_MERGE, &merge),
                gather: compiler.program(&programs::CASCADES_GATHER, &gather),
            }
        };
        let rays = settings.nearest_rays();
        let cosines = |cone| [0, 1, 2, 3].map(|face| cosine(face, cone, rays));
        let cosines: Vec<[f32; 4]> = (0..rays).map(cosines).collect();
        let cosines = bytemuck::cast_slice(&cosines);
        let bounce = Bounce::in_floats(compiler, bounces);
        Ok(Self {
            settings: settings.clone(),
            medium_grid: MediumGridPipelines::new(compiler, bounce.keeps_media_apart()),
            empty_space: EmptySpace::new(compiler),
            passes: passes(false),
            moment: moment.then(|| passes(true)),
            cosines: filled(&compiler.device, queue, "cosines", BufferUsages::STORAGE, cosines),
            bounce,
        })
    }

    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        let ladder = Ladder::over(planner, &self.settings)?;
        let (paths, layers) = (ladder.paths(planner)?, ladder.layers(planner)?);
        let halves = planner.pair::<[f32; 4]>("cascades", ladder.means())?;
        let grid = self.medium_grid.buffers(planner)?;
        let faces = FACES * planner.cells();
        let one = self.bounce.buffer::<[f32; 4]>(planner, faces)?;
        let other = self.bounce.kept_buffer::<[f32; 4]>(planner, faces)?;
        let (squares, find_squares) = self.empty_space.plan(planner, &grid)?;
        let plan = Plan { planner, ladder, paths, layers, halves, grid, squares };

        let mut dispatches = vec![self.medium_grid.read(planner, &plan.grid, &one)];
        dispatches.extend_from_slice(&find_squares);
        let light_media = |scattered| self.medium_grid.light_media(planner, &plan.grid, scattered);
        let [mut from, mut to] = [&one, &other];
        match &self.bounce {
            Bounce::Times(times) => {
                for bounce in 0..*times {
                    let indirect = Indirect { step: bounce.min(1), scattered: from };
                    dispatches.extend(self.gather(&plan, indirect, &[(SCATTERED, to)]));
                    dispatches.extend(planner.scatter_direct(to));
                    dispatches.push(light_media(to));
                    // Media that scatter other light are other matter to empty-space skipping.
                    dispatches.extend_from_slice(&find_squares);
                    (from, to) = (to, from);
                }
            }
            Bounce::Converged(convergence, compare) => {
                let changes = Convergence::changes(planner)?;
                let [first, later] = [0, 1].map(|step| {
                    let indirect = Indirect { step, scattered: from };
                    let mut bounce = self.gather(&plan, indirect, &[(SCATTERED, to)]);
                    bounce.extend(planner.scatter_direct(to));
                    bounce.push(compare.plan(planner, to, from, &changes, step));
                    bounce.push(light_media(from));
                    bounce
                });
                dispatches.extend(convergence.plan(planner, &changes, first, later)?);
            }
            Bounce::Feedback(feedback) => {
                dispatches.push(feedback.plan(planner, &plan.grid, to, from));
                dispatches.push(light_media(from));
                dispatches.extend_from_slice(&find_squares);
            }
        }
        let indirect = Indirect { step: self.bounce.is_any().into(), scattered: from };
        let kept = matches!(self.bounce, Bounce::Feedback(_)).then_some(to);
        let targets: Vec<_> =
            [(LIGHT, light)].into_iter().chain(kept.map(|kept| (SCATTERED, kept))).collect();
        dispatches.extend(self.gather(&plan, indirect, &targets));
        dispatches.extend(kept.and_then(|kept| planner.scatter_direct(kept)));
        dispatches.extend(planner.add_direct(light));
        let stages = vec![(Stage::EmptySpace, plan.squares), (Stage::Light, light.clone())];
        Ok(PassList::new(dispatches, stages))
    }

    /// Plans a gather over all cones of the nearest cascade, batch by batch. Each target is an entry of
    /// [`programs::CASCADES_GATHER`] and the buffer that it writes to.
    fn gather(
        &self,
        plan: &Plan,
        indirect: Indirect,
        targets: &[(usize, &Buffer)],
    ) -> Vec<Dispatch> {
        let lights = targets.iter().any(|&(entry, _)| entry == LIGHT);
        let with_moment = self.moment.as_ref().filter(|_| lights);
        let Passes { merge: merges, gather: gathers } = with_moment.unwrap_or(&self.passes);
        let merge = [0, 1].map(|half: usize| {
            plan.bind(merges, indirect, [&plan.halves[1 - half], &plan.halves[half]], &[])
        });
        let more = [view(&plan.planner.textures.albedo), whole(&self.cosines)];
        let gather: Vec<_> = targets
            .iter()
            .map(|&(entry, to)| (entry, plan.bind(gathers, indirect, [&plan.halves[1], to], &more)))
            .collect();
        let mut dispatches = Vec::new();
        for batch in 0..plan.ladder.batches() {
            for further in (1..plan.ladder.cascades.len()).rev() {
                let [columns, rows] = plan.ladder.cascades[further].lattice.count;
                let cones = plan.ladder.cones_before(further) as u32;
                let groups = [columns.div_ceil(WORKGROUP), rows.div_ceil(WORKGROUP), cones];
                let (pipeline, bound) = (merges.entry(0), &merge[further % 2]);
                let layer = plan.ladder.layer(batch, further);
                dispatches.push(Dispatch::new(pipeline, bound, Some(layer), groups));
            }
            let nearest = Some(plan.ladder.layer(batch, 0));
            let gathers = gather
                .iter()
                .map(|(entry, bound)| plan.planner.over_cells(gathers, *entry, bound, nearest));
            dispatches.extend(gathers);
        }
        dispatches
    }
}

impl Plan<'_> {
    /// Binds the resources of a merge, or of a gather, which has some more.
    fn bind(
        &self,
        pipelines: &ComputePipelines,
        indirect: Indirect,
        [far, to]: [&Buffer; 2],
        more: &[BindingResource],
    ) -> BoundResources {
        let Self { planner, grid, .. } = self;
        let mut resources = vec![
            whole(&self.paths),
            whole(far),
            whole(&grid.source),
            whole(&grid.extinction),
            whole(&self.squares),
            whole(indirect.scattered),
            planner.shared.number(indirect.step),
            ladder::selected(&self.layers),
            whole(to),
            planner.panorama(),
        ];
        resources.extend_from_slice(more);
        planner.bind(pipelines, &resources)
    }
}
