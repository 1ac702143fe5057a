//! Bounces: a number of them, until light has converged, or one per frame.

use super::gather::{Gather, GatherBuffers, Gathered};
use crate::error::Result;
use crate::pipeline::Dispatch;
use crate::planner::FramePlanner;
use crate::stages::compare::Compare;
use crate::stages::convergence::Convergence;
use crate::stages::feedback::Feedback;
use crate::stages::medium_grid::MediumGridPipelines;
use lamplight::Bounces;
use wgpu::{Buffer, Device};

/// Faces of a cell; a medium uses the first.
const FACES: u64 = 4;

/// The way in which light bounces.
#[derive(Debug)]
pub enum Bounce {
    Times(u32),
    Converged(Convergence, Compare),
    Feedback(Feedback),
}

impl Bounce {
    pub fn new(device: &Device, bounces: Bounces) -> Self {
        match bounces {
            Bounces::Count(times) => Self::Times(times),
            Bounces::Converged => Self::Converged(Convergence::new(device), Compare::new(device)),
            Bounces::Feedback => Self::Feedback(Feedback::new(device)),
        }
    }

    /// Returns whether media that scatter are crossed cell by cell from the start. It saves finding squares
    /// again in each of many bounces, most of which are recorded in vain; once a medium is lit its cells differ
    /// anyway.
    pub fn keeps_media_apart(&self) -> bool {
        matches!(self, Self::Converged(..))
    }

    /// Creates the buffers of scattered radiance before and after a bounce; of a single value if light does not
    /// bounce.
    pub fn buffers(&self, planner: &FramePlanner) -> Result<[Buffer; 2]> {
        let count = match self {
            Self::Times(0) => 1,
            _ => planner.cells() * FACES,
        };
        let after = match self {
            Self::Feedback(_) => planner.kept_scattered::<[f32; 4]>(count)?,
            _ => planner.buffer::<[f32; 4]>("scattered", count)?,
        };
        Ok([planner.buffer::<[f32; 4]>("scattered", count)?, after])
    }

    /// Plans all bounces. Returns the scattered radiance after the last. `find_squares` is repeated whenever
    /// media scatter other light.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        medium_grid: &MediumGridPipelines,
        gather: &Gather,
        buffers: &GatherBuffers,
        scattered: &[Buffer; 2],
        find_squares: &[Dispatch],
    ) -> Result<(Vec<Dispatch>, Buffer)> {
        let [one, other] = scattered;
        let gather = |step, from, to| {
            let gathered = gather.plan(planner, Gathered::Scattered, buffers, step, from, to);
            [gathered].into_iter().chain(planner.scatter_direct(to))
        };
        let light_media = |scattered: &Buffer| {
            let lit = medium_grid.light_media(planner, &buffers.grid, scattered);
            let mut dispatches = vec![lit];
            dispatches.extend_from_slice(find_squares);
            dispatches
        };
        let dispatches = match self {
            Self::Times(times) => {
                let mut dispatches = Vec::new();
                let (mut from, mut to) = (one, other);
                for bounce in 0..*times {
                    dispatches.extend(gather(bounce.min(1), from, to));
                    dispatches.extend(light_media(to));
                    (from, to) = (to, from);
                }
                return Ok((dispatches, from.clone()));
            }
            Self::Converged(convergence, compare) => {
                let changes = Convergence::changes(planner)?;
                let [first, later] = [0, 1].map(|step| {
                    let compare = compare.plan(planner, one, other, &changes, step);
                    let gathered = gather(step, other, one).chain([compare]);
                    gathered.chain(light_media(other)).collect()
                });
                convergence.plan(planner, &changes, first, later)?
            }
            Self::Feedback(feedback) => {
                let mut dispatches = vec![feedback.plan(planner, &buffers.grid, other, one)];
                dispatches.extend(light_media(one));
                dispatches.extend(gather(1, one, other));
                dispatches.extend(light_media(other));
                dispatches
            }
        };
        Ok((dispatches, other.clone()))
    }
}
