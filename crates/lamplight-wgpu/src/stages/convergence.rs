//! Rounds of light that end when little changes any more.
//!
//! `bounces = "converged"` sends light on until the largest change of a round, ÷ the mean of what is
//! sent, is under [`CONVERGED`]. A frame is recorded before anything is known, so all rounds that
//! there may be are recorded, in as many workgroups as a buffer on the GPU says: each round leaves what
//! it changed, and once that is little a kernel writes 0 there. What follows then costs the launch of
//! empty dispatches.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot, WORKGROUP};
use crate::shaders;
use crate::site::{ONE, Site, whole};
use lamplight::settings::Bounces;
use lamplight::stages::bounce::CONVERGED;
use wgpu::{Buffer, BufferUsages, Device};

/// Bytes of what is found in a tile of cells.
const FOUND: u64 = 3 * ONE;
/// Bytes of three counts of workgroups.
const GROUPS: u64 = 3 * ONE;

/// The pipelines.
#[derive(Debug)]
pub struct Convergence(Kernels);

impl Convergence {
    pub fn new(device: &Device) -> Self {
        use Slot::{Read, Uniform, Write};
        let (slots, constants) =
            ([Uniform, Read, Read, Write], [("CONVERGED", f64::from(CONVERGED))]);
        Self(Kernels::new(device, &shaders::CONVERGENCE, &["begin", "decide"], &slots, &constants))
    }

    /// Where a round leaves what it changed (shaders/found.wgsl).
    pub fn found(site: &Site) -> Result<Buffer> {
        let [width, height] = site.size.map(|side| u64::from(side.div_ceil(WORKGROUP)));
        site.buffer("change of a round", width * height * FOUND)
    }

    /// All rounds: the first, and as many of the others as it takes.
    pub fn plan(
        &self,
        site: &Site,
        found: &Buffer,
        rounds: [Vec<Dispatch>; 2],
    ) -> Result<Vec<Dispatch>> {
        let mut sizes: Vec<_> = rounds.iter().flatten().map(|dispatch| dispatch.groups).collect();
        sizes.sort_unstable();
        sizes.dedup();
        let usage = BufferUsages::STORAGE;
        let table = site.filled("workgroups of a round", usage, bytemuck::cast_slice(&sizes))?;
        let usage = usage | BufferUsages::INDIRECT;
        let groups = site.buffer_for("rounds to come", table.size(), usage)?;

        let resources = [whole(found), whole(&table), whole(&groups)];
        let bound = site.bind(&self.0, &resources);
        let run = |entry: usize| Dispatch::new(&self.0.entries[entry], &bound, None, [1, 1, 1]);
        let [first, later] = rounds.map(|round| {
            let told = |dispatch: Dispatch| {
                let at = sizes.partition_point(|size| *size < dispatch.groups);
                dispatch.told_by(&groups, at as u64 * GROUPS)
            };
            round.into_iter().map(told).chain([run(1)]).collect::<Vec<_>>()
        });
        let mut dispatches = vec![run(0)];
        dispatches.extend(first);
        for _ in 1..Bounces::Converged.limit() {
            dispatches.extend_from_slice(&later);
        }
        Ok(dispatches)
    }
}
