//! Radiance cascades: the GPU's `methods/cascades` of the library (Sannikov 2023).
//!
//! From the last cascade to the first, one dispatch each: every thread stands at a probe, sends the four
//! rays of a cone through their intervals, reads behind them what the four probes of the next cascade
//! around have gathered, and keeps the mean: `L = r + t·L_next`. Intervals never go to memory. What is
//! kept lies cone by cone with the probes side by side, so that neighbouring threads read and write
//! neighbouring places, and in two buffers in turns, since only the next nearer cascade reads it.

pub mod ladder;

use crate::Result;
use crate::kernel::{Bound, Dispatch, Kernels, Slot, WORKGROUP};
use crate::lighting::Stage;
use crate::shaders;
use crate::shared::filled;
use crate::site::{FOUR, Run, Site, view, whole};
use crate::stages::clearance::Clearance;
use crate::stages::compare::Compare;
use crate::stages::convergence::Convergence;
use crate::stages::optics::{Optics, Seen};
use crate::stages::packet::PACKET;
use ladder::Ladder;
use lamplight::Settings;
use lamplight::methods::cascades::{BEFORE, cosine};
use lamplight::settings::{Bounces, Merge};
use wgpu::{BindingResource, Buffer, BufferUsages, Device, Queue};

/// The pipelines, and what is the same for every grid.
#[derive(Debug)]
pub struct Cascades {
    optics: Optics,
    clearance: Clearance,
    fill: Kernels,
    gather: Kernels,
    cosines: Buffer,
    /// Where light bounces until it has converged.
    convergence: Option<(Convergence, Compare)>,
}

/// What runs over a grid, and the buffers that it reads and writes.
struct Plan<'a> {
    site: &'a Site<'a>,
    ladder: Ladder,
    paths: Buffer,
    layers: Buffer,
    /// What cascades with an even number have gathered, and those with an odd one.
    halves: [Buffer; 2],
    seen: Seen,
    squares: Buffer,
}

/// What the last gather finds: light; the others find what surfaces send on.
const LIGHT: usize = 0;
const SENT: usize = 1;

impl Cascades {
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        let slots = [Uniform, Read, Read, Read, Read, Read, Read, Uniform, Step, Write];
        let fix = settings.cascades.merge == Merge::BilinearFix;
        let merge = [PACKET, &[("ENDS", 1.0), ("BILINEAR_FIX", fix.into())]].concat();
        let rays = settings.cascades.nearest_rays();
        let cosines = |cone| [0, 1, 2, 3].map(|face| cosine(face, cone, rays));
        let cosines: Vec<[f32; 4]> = (0..rays).map(cosines).collect();
        let cosines = bytemuck::cast_slice(&cosines);
        let converges = settings.bounces == Bounces::Converged;
        Self {
            // As in `raymarch`, where many rounds are recorded no squares are found anew.
            optics: Optics::new(device, converges),
            clearance: Clearance::new(device),
            fill: Kernels::new(device, &shaders::CASCADES_FILL, &["main"], &slots, &merge),
            gather: Kernels::new(
                device,
                &shaders::CASCADES_GATHER,
                &["main", "receive"],
                &[&slots[..], &[Texture, Read]].concat(),
                &[&merge[..], &[("BEFORE", BEFORE.into())]].concat(),
            ),
            cosines: filled(device, queue, "cosines", BufferUsages::STORAGE, cosines),
            convergence: converges.then(|| (Convergence::new(device), Compare::new(device))),
        }
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        let ladder = Ladder::over(site)?;
        let (paths, layers) = (ladder.paths(site)?, ladder.layers(site)?);
        let halves = site.pair("cascades", ladder.bytes())?;
        let seen = self.optics.buffers(site)?;
        let bounces = site.settings.bounces.limit();
        let faces = if site.settings.bounces == Bounces::Count(0) { 0 } else { 4 };
        let sent = site.pair("sent", (site.cells() * faces).max(1) * FOUR)?;
        let (squares, found) = self.clearance.plan(site, &seen)?;
        let plan = Plan { site, ladder, paths, layers, halves, seen, squares };

        let mut dispatches = vec![self.optics.read(site, &plan.seen, &sent[0])];
        dispatches.extend_from_slice(&found);
        let [mut from, mut to] = sent.each_ref();
        if let Some((convergence, compare)) = &self.convergence {
            let found = Convergence::found(site)?;
            let rounds = [0, 1].map(|step| {
                let mut round = self.gather(&plan, SENT, step, [from, to]);
                round.push(compare.run(site, [to, from], &found, step));
                round.push(self.optics.light_fog(site, &plan.seen, from));
                round
            });
            dispatches.extend(convergence.plan(site, &found, rounds)?);
        } else {
            for bounce in 0..bounces {
                dispatches.extend(self.gather(&plan, SENT, bounce.min(1), [from, to]));
                dispatches.push(self.optics.light_fog(site, &plan.seen, to));
                // Fog that sends other light on is other matter, to squares.
                dispatches.extend_from_slice(&found);
                (from, to) = (to, from);
            }
        }
        dispatches.extend(self.gather(&plan, LIGHT, bounces.min(1), [from, light]));
        let stages = vec![(Stage::Clearance, plan.squares), (Stage::Light, light.clone())];
        Ok(Run { dispatches, stages, lamps: None })
    }

    /// All cones of the nearest cascade, batch by batch: from what surfaces send, which counts from step
    /// 1 on, into light or what they send next.
    fn gather(
        &self,
        plan: &Plan,
        entry: usize,
        step: u32,
        [from, to]: [&Buffer; 2],
    ) -> Vec<Dispatch> {
        let fill = [0, 1].map(|half: usize| {
            let [far, near] = [&plan.halves[1 - half], &plan.halves[half]];
            plan.bind(&self.fill, (step, from), [far, near], &[])
        });
        let more = [view(&plan.site.textures.albedo), whole(&self.cosines)];
        let gather = plan.bind(&self.gather, (step, from), [&plan.halves[1], to], &more);
        let mut dispatches = Vec::new();
        for batch in 0..plan.ladder.batches() {
            for further in (1..plan.ladder.cascades.len()).rev() {
                let [columns, rows] = plan.ladder.cascades[further].lattice.count;
                let cones = plan.ladder.cones_before(further) as u32;
                let groups = [columns.div_ceil(WORKGROUP), rows.div_ceil(WORKGROUP), cones];
                let (kernel, bound) = (&self.fill.entries[0], &fill[further % 2]);
                let layer = plan.ladder.layer(batch, further);
                dispatches.push(Dispatch::new(kernel, bound, Some(layer), groups));
            }
            let nearest = plan.ladder.layer(batch, 0);
            dispatches.push(plan.site.over_cells(&self.gather, entry, &gather, Some(nearest)));
        }
        dispatches
    }
}

impl Plan<'_> {
    /// Binds what merging takes: what surfaces send from a step on, what lies beyond `far`, where what is
    /// found goes.
    fn bind(
        &self,
        kernels: &Kernels,
        (step, sent): (u32, &Buffer),
        [far, to]: [&Buffer; 2],
        more: &[BindingResource],
    ) -> Bound {
        let Self { site, seen, .. } = self;
        let mut resources = vec![
            whole(&self.paths),
            whole(far),
            whole(&seen.source),
            whole(&seen.logs),
            whole(&self.squares),
            whole(sent),
            site.shared.number(step),
            ladder::first(&self.layers),
            whole(to),
        ];
        resources.extend_from_slice(more);
        site.bind(kernels, &resources)
    }
}
