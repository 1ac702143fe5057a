//! Bounces that end once little changes any more.
//!
//! `bounces = "converged"` repeats bounces until the largest change of one, ÷ the mean scattered radiance, is
//! below [`CONVERGED`]. A frame is recorded before anything is known, so all possible bounces are recorded as
//! indirect dispatches: each bounce leaves its change, and once that is small a kernel sets their workgroup
//! counts to 0. Empty dispatches still cost their launch, and wgpu validates each (unless the host clears
//! `InstanceFlags::VALIDATION_INDIRECT_CALL`). So if the albedo is known, no more bounces are recorded than it
//! can need ([`crate::hints`]).

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch, WORKGROUP};
use crate::planner::{FramePlanner, whole};
use crate::programs;
use lamplight::internals::CONVERGED;
use lamplight::settings::Bounces;
use wgpu::{Buffer, BufferUsages};

/// `Change` of shaders/shared/change.wgsl.
type Change = [f32; 3];
/// The arguments of an indirect dispatch.
type Groups = [u32; 3];

/// The pipelines.
#[derive(Debug)]
pub struct Convergence(ComputePipelines);

impl Convergence {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [("CONVERGED", f64::from(CONVERGED))];
        Self(compiler.program(&programs::CONVERGENCE, &constants))
    }

    /// Creates the buffer for the change of each tile in a bounce.
    pub fn changes(planner: &FramePlanner) -> Result<Buffer> {
        let tiles = <[u32; 2]>::from(planner.size).map(|side| u64::from(side.div_ceil(WORKGROUP)));
        planner.buffer::<Change>("change of a bounce", tiles[0] * tiles[1])
    }

    /// Plans all bounces: the `first`, and `later` ones until `changes` are small.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        changes: &Buffer,
        first: Vec<Dispatch>,
        later: Vec<Dispatch>,
    ) -> Result<Vec<Dispatch>> {
        let mut sizes: Vec<Groups> =
            first.iter().chain(&later).map(|dispatch| dispatch.groups).collect();
        sizes.sort_unstable();
        sizes.dedup();
        let usage = BufferUsages::STORAGE;
        let table =
            planner.filled("workgroups of a bounce", usage, bytemuck::cast_slice(&sizes))?;
        let usage = usage | BufferUsages::INDIRECT;
        let groups = planner.buffer_for("workgroups of later bounces", table.size(), usage)?;

        let bound = planner.bind(&self.0, &[whole(changes), whole(&table), whole(&groups)]);
        let run = |entry: usize| Dispatch::new(self.0.entry(entry), &bound, None, [1, 1, 1]);
        let indirect = |bounce: Vec<Dispatch>| {
            let indirect = |dispatch: Dispatch| {
                let at = sizes.partition_point(|size| *size < dispatch.groups);
                dispatch.indirect(&groups, (at * size_of::<Groups>()) as u64)
            };
            bounce.into_iter().map(indirect).chain([run(1)]).collect::<Vec<_>>()
        };
        let mut dispatches = vec![run(0)];
        dispatches.extend(indirect(first));
        let later = indirect(later);
        for _ in 1..planner.hints.bounces.unwrap_or(Bounces::Converged.limit()) {
            dispatches.extend_from_slice(&later);
        }
        Ok(dispatches)
    }
}
