//! `raymarch`: rays from every pixel.

mod bounce;
mod gather;

use crate::compiler::Compiler;
use crate::error::{Result, unsupported};
use crate::pass_list::PassList;
use crate::planner::FramePlanner;
use crate::stage::Stage;
use crate::stages::bounce::{Bounce, FACES};
use crate::stages::compare::Compare;
use crate::stages::denoise::Denoise;
use crate::stages::distance::DistancePipelines;
use crate::stages::empty_space::EmptySpace;
use crate::stages::feedback::Feedback;
use crate::stages::invalidate::Invalidate;
use crate::stages::medium_grid::MediumGridPipelines;
use crate::stages::temporal::Temporal;
use gather::{Gather, GatherBuffers, Gathered};
use lamplight::settings::{Bounces, Hit, Raymarch as Settings};
use wgpu::{Buffer, Queue};

/// The pipelines, and buffers that are the same for every grid.
#[derive(Debug)]
pub struct Raymarch {
    medium_grid: MediumGridPipelines,
    skipping: Skipping,
    gather: Gather,
    bounce: Bounce<Compare, Feedback>,
    invalidate: Option<Invalidate>,
    temporal: Option<Temporal>,
    denoise: Option<Denoise>,
    /// True if the variance of the light, or the changes that rays met, are needed.
    traced: bool,
}

/// The field by which rays skip empty space.
#[derive(Debug)]
enum Skipping {
    Squares(EmptySpace),
    Distance(DistancePipelines),
}

impl Raymarch {
    pub fn new(
        compiler: &Compiler,
        queue: &Queue,
        settings: &Settings,
        bounces: Bounces,
        moment: bool,
        inflow: bool,
    ) -> lamplight::Result<Self> {
        let accumulates = settings.temporal.history_length > 1;
        let (tracks, varies) = (Temporal::tracks(settings), settings.denoise.passes > 0);
        let traced = tracks || varies;
        let skipping = match settings.hit {
            Hit::Edge => Skipping::Squares(EmptySpace::new(compiler)),
            Hit::Distance => Skipping::Distance(DistancePipelines::new(compiler)),
            other => return Err(unsupported("raymarch.hit", other)),
        };
        let rejects = accumulates && settings.temporal.reject;
        let bounce = Bounce::in_floats(compiler, bounces);
        Ok(Self {
            medium_grid: MediumGridPipelines::new(compiler, bounce.keeps_media_apart()),
            skipping,
            gather: Gather::new(compiler, queue, settings, tracks, varies, moment, inflow)?,
            bounce,
            invalidate: rejects.then(|| Invalidate::new(compiler)),
            temporal: accumulates
                .then(|| Temporal::new(compiler, settings, bounces, traced, moment)),
            denoise: varies.then(|| Denoise::new(compiler, settings, moment)),
            traced,
        })
    }

    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        let grid = self.medium_grid.buffers(planner)?;
        let faces = FACES * planner.cells();
        let scattered = [
            self.bounce.buffer::<[f32; 4]>(planner, faces)?,
            self.bounce.kept_buffer::<[f32; 4]>(planner, faces)?,
        ];
        let mut dispatches = vec![self.medium_grid.read(planner, &grid, &scattered[0])];
        let mut any_changed = None;
        if let Some(invalidate) = &self.invalidate {
            let (any, marks) = invalidate.plan(planner, &grid)?;
            dispatches.extend(marks);
            any_changed = Some(any);
        }
        // Media that scatter other light are other matter to squares, but not to distances.
        let (fields, find, repeats, mut stages) = match &self.skipping {
            Skipping::Squares(empty_space) => {
                let (squares, find) = empty_space.plan(planner, &grid)?;
                let stages = vec![(Stage::EmptySpace, squares.clone())];
                ([grid.extinction.clone(), squares], find, true, stages)
            }
            Skipping::Distance(pipelines) => {
                let field = pipelines.plan(planner)?;
                let PassList { dispatches, stages, .. } = field.passes;
                ([field.nearest, field.distance], dispatches, false, stages)
            }
        };
        let cells = if self.traced { planner.cells() } else { 1 };
        let traced = planner.buffer::<[f32; 2]>("traced", cells)?;
        let buffers = GatherBuffers { grid, fields, traced };
        dispatches.extend_from_slice(&find);
        let repeats = repeats && !self.bounce.keeps_media_apart();
        let find = if repeats { find } else { Vec::new() };
        let (grid, gather) = (&self.medium_grid, &self.gather);
        let (bounces, scattered) =
            bounce::plan(&self.bounce, planner, grid, gather, &buffers, &scattered, &find)?;
        dispatches.extend(bounces);
        let step = self.bounce.is_any().into();
        dispatches.push(gather.plan(planner, Gathered::Light, &buffers, step, &scattered, light));

        let GatherBuffers { fields: [_, near], traced, .. } = &buffers;
        if let Some(temporal) = &self.temporal {
            dispatches.extend(temporal.plan(planner, light, traced, any_changed.as_ref())?);
        }
        if let Some(denoise) = &self.denoise {
            dispatches.extend(denoise.plan(planner, near, traced, light)?);
        }
        dispatches.extend(planner.add_direct(light));
        stages.push((Stage::Light, light.clone()));
        Ok(PassList::new(dispatches, stages))
    }
}
