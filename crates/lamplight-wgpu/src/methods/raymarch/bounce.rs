//! The bounces of `raymarch`: between them and within a frame, rays are gathered at surfaces only.

use super::gather::{Gather, GatherBuffers, Gathered};
use crate::error::Result;
use crate::pipeline::Dispatch;
use crate::planner::FramePlanner;
use crate::stages::bounce::Bounce;
use crate::stages::compare::Compare;
use crate::stages::convergence::Convergence;
use crate::stages::feedback::Feedback;
use crate::stages::medium_grid::MediumGridPipelines;
use wgpu::Buffer;

/// Plans all bounces. Returns the scattered radiance after the last. `find_squares` is repeated whenever
/// media scatter other light.
pub fn plan(
    bounce: &Bounce<Compare, Feedback>,
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
    let dispatches = match bounce {
        Bounce::Times(times) => {
            let mut dispatches = Vec::new();
            let (mut from, mut to) = (one, other);
            for bounce in 0..*times {
                dispatches.extend(gather(bounce.min(1), from, to));
                dispatches.extend(light_media(to));
                (from, to) = (to, from);
            }
            return Ok((dispatches, from.clone()));
        }
        Bounce::Converged(convergence, compare) => {
            let changes = Convergence::changes(planner)?;
            let [first, later] = [0, 1].map(|step| {
                let compare = compare.plan(planner, one, other, &changes, step);
                let gathered = gather(step, other, one).chain([compare]);
                gathered.chain(light_media(other)).collect()
            });
            convergence.plan(planner, &changes, first, later)?
        }
        Bounce::Feedback(feedback) => {
            let mut dispatches = vec![feedback.plan(planner, &buffers.grid, other, one)];
            dispatches.extend(light_media(one));
            dispatches.extend(gather(1, one, other));
            dispatches.extend(light_media(other));
            dispatches
        }
    };
    Ok((dispatches, other.clone()))
}
