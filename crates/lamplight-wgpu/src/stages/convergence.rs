//! Rounds of light that end when little changes any more.
//!
//! `bounces = "converged"` sends light on until the largest change of a round, ÷ the mean of what is
//! sent, is under [`CONVERGED`]. A frame is recorded before anything is known, so all rounds that
//! there may be are recorded, in as many workgroups as a buffer on the GPU says: each round leaves what
//! it changed, and once that is little a kernel writes 0 there. What follows then costs the launch of
//! empty dispatches, which is not nothing: wgpu checks each (unless the host leaves
//! `InstanceFlags::VALIDATION_INDIRECT_CALL` out). So where the albedo is known, no more rounds are
//! recorded than it can take ([`rounds`]).

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

/// Rounds are planned by so many, so that another albedo seldom makes another plan.
const STEP: u32 = 16;

/// Rounds after which light between surfaces of so large an albedo has converged, in so many cells. The
/// largest change of a round is at most albedo × that of the one before, and the mean of what is sent,
/// which only grows, at least the largest change of the first ÷ how many numbers are sent. One is far
/// smaller and the other far larger as a rule, which leaves room for methods that make a little light.
pub fn rounds(albedo: f32, cells: usize) -> u32 {
    const NUMBERS: f64 = 4.0 * 3.0;
    let most = Bounces::Converged.limit();
    if albedo >= 1.0 {
        return most;
    }
    let least = f64::from(CONVERGED) / (NUMBERS * cells as f64);
    // Nothing at all is left where the albedo is 0.
    let later = least.ln() / f64::from(albedo).ln();
    (1 + later.ceil() as u32).next_multiple_of(STEP).min(most)
}

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
        let rounds = site.known.rounds.unwrap_or(Bounces::Converged.limit());
        for _ in 1..rounds {
            dispatches.extend_from_slice(&later);
        }
        Ok(dispatches)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_grow_with_the_albedo_up_to_all() {
        let of = |albedo| rounds(albedo, 320 * 180);
        assert_eq!([0.0, 0.5, 0.8, 0.9, 0.95, 1.0].map(of), [16, 32, 96, 208, 256, 256]);
    }
}
