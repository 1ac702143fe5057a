//! Rounds of light that end when little changes any more.
//!
//! `bounces = "converged"` sends light on until the largest change of a round, ÷ the mean of what is
//! sent, is under [`CONVERGED`]. A frame is recorded before anything is known, so all rounds that
//! there may be are recorded, in as many workgroups as a buffer on the GPU says: after each round a
//! kernel compares what is sent with what was, and once it has converged writes 0 there. What follows
//! then costs the launch of empty dispatches.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot, WORKGROUP};
use crate::shaders;
use crate::site::{ONE, Site, whole};
use lamplight::settings::Bounces;
use lamplight::stages::bounce::CONVERGED;
use wgpu::{Buffer, BufferUsages, Device};

/// Bytes of what is found in a tile of cells.
const FOUND: u64 = 3 * ONE;

/// The pipelines.
#[derive(Debug)]
pub struct Convergence {
    compare: Kernels,
    /// Apart: the buffer that says how often something runs cannot be bound to it.
    decide: Kernels,
}

/// What a round is made of, all over cells.
pub struct Round {
    /// From what surfaces send to what they receive and send on next.
    pub gather: Vec<Dispatch>,
    /// What depends on what they send now.
    pub follow: Vec<Dispatch>,
}

impl Convergence {
    /// For so many entries a cell of what surfaces send: colours, and more than 0 in the fourth place
    /// where a surface is.
    pub fn new(device: &Device, slots: u32) -> Self {
        use Slot::{Read, Step, Uniform, Write};
        let constants = [("SLOTS", f64::from(slots)), ("CONVERGED", f64::from(CONVERGED))];
        let kernels = |entries: &[&'static str], slots: &[_]| {
            Kernels::new(device, &shaders::CONVERGENCE, entries, slots, &constants)
        };
        Self {
            compare: kernels(&["compare"], &[Uniform, Step, Read, Write, Write]),
            decide: kernels(&["begin", "decide"], &[Uniform, Step, Read, Write, Write, Write]),
        }
    }

    /// Rounds from `sent` to `received`, which then is what is sent. `round` gives the first (0), in
    /// which nothing has been sent before, and all others (1).
    pub fn plan(
        &self,
        site: &Site,
        received: &Buffer,
        sent: &Buffer,
        round: impl Fn(u32) -> Round,
    ) -> Result<Vec<Dispatch>> {
        let [width, height] = site.size.map(|side| u64::from(side.div_ceil(WORKGROUP)));
        let found = site.buffer("change of a round", width * height * FOUND)?;
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT;
        let groups = site.buffer_for("rounds to come", 3 * ONE, usage)?;

        let step = site.shared.step();
        let resources = [step, whole(received), whole(sent), whole(&found), whole(&groups)];
        let bound = site.bind(&self.compare, &resources[..4]);
        let compare = |step| site.over_cells(&self.compare, 0, &bound, Some(step));
        let all = site.bind(&self.decide, &resources);
        let decide =
            |entry: usize| Dispatch::new(&self.decide.entries[entry], &all, Some(0), [1, 1, 1]);
        let planned = |step: u32| {
            let Round { gather, follow } = round(step);
            let all = gather.into_iter().chain([compare(step)]).chain(follow);
            let mut all: Vec<_> = all.map(|dispatch| dispatch.told_by(&groups)).collect();
            all.push(decide(1));
            all
        };
        let mut dispatches = vec![decide(0)];
        dispatches.extend(planned(0));
        let later = planned(1);
        for _ in 1..Bounces::Converged.limit() {
            dispatches.extend_from_slice(&later);
        }
        Ok(dispatches)
    }
}
