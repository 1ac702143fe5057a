//! Holographic radiance cascades: the GPU's `methods/holographic` of the library.
//!
//! Quadrant after quadrant, chunk after chunk ([`lattice`]): trace the first level of intervals, extend
//! them level by level, merge cones down, and let the pixels of the chunk look at them.

mod lattice;
pub mod paper;
mod quadrant;
pub mod sweep;
mod tables;
mod tiles;
mod traffic;

use crate::Result;
use crate::kernel::{Bound, Dispatch, Kernels, Slot};
use crate::lighting::Stage;
use crate::shaders;
use crate::site::{ONE, Run, Site, view, whole};
use crate::stages::convergence::Convergence;
use lamplight::Bounces;
use lamplight::methods::holographic::ways::Look;
use lamplight::methods::holographic::{CLOSED, FRACTION, GLOWING, MATTER, REACH};
use lamplight::stages::transmittance::LOG_OF_ZERO;
use lattice::Lattice;
use quadrant::{Axis, Quadrant, Step, Work};
use sweep::Sweeps;
use tables::Ways;
use tiles::Tiles;
use wgpu::{Buffer, BufferUsages, Device};

/// Bytes of light in a lattice, and on a face.
const PACKED: u64 = 8;
/// Bytes of a quadrant that are held a cell, of a grid filled up to a power of two, for each word of an
/// interval; less means more dispatches.
const MOST_HELD: u64 = 58;
/// Bytes that are not worth a dispatch.
const LITTLE: u64 = 16 << 20;
/// Rows of a workgroup that traces or looks.
const TILE: u32 = 64;

/// The pipelines.
#[derive(Debug)]
pub struct Holographic {
    slabs: Kernels,
    /// Where no matter tints, and where some does.
    intervals: [Intervals; 2],
    hop: Kernels,
    onto: Kernels,
    reflect: Kernels,
    /// Where light bounces until it has converged, with what sends it on then.
    convergence: Option<(Convergence, Kernels)>,
}

/// Those that know how intervals are stored.
#[derive(Debug)]
struct Intervals {
    /// Words of an interval.
    words: u32,
    tiles: Tiles,
    trace: Kernels,
    extend: Kernels,
    cones: Kernels,
}

impl Intervals {
    fn new(device: &Device, words: u32) -> Self {
        use Slot::{Read, Texture, Uniform, Write};
        let stored = ("WORDS", f64::from(words));
        let tiles = Tiles::new(device.limits().max_compute_workgroup_storage_size, words);
        let fused = |tile: u32, held: u32| [stored, ("TILE", tile.into()), ("HELD", held.into())];
        let tracing = [CELLS, MARCH, &[stored]].concat();
        let slots = [Uniform, Slot::Step, Read, Read, Texture, Texture, Read, Write];
        let kernels = |shader, entries: &[&'static str], slots: &[_], constants: &[_]| {
            Kernels::new(device, shader, entries, slots, constants)
        };
        Self {
            words,
            tiles,
            trace: kernels(&shaders::TRACE, &["main"], &slots, &tracing),
            extend: kernels(
                &shaders::EXTEND,
                &["main"],
                &[Uniform, Slot::Step, Write],
                &fused(tiles.extend, tiles.intervals() * words),
            ),
            cones: kernels(
                &shaders::CONES,
                &["main", "finish"],
                &[Uniform, Slot::Step, Read, Read, Write],
                &fused(tiles.cones, tiles.light()),
            ),
        }
    }
}

/// What runs are bound to.
struct Bindings {
    slabs: Bound,
    trace: Bound,
    extend: Bound,
    cones: Bound,
    hop: Bound,
}

impl Holographic {
    pub fn new(device: &Device, bounces: Bounces) -> Self {
        use Slot::{Read, Texture, Uniform, Write};
        let hop = |onto: bool| {
            let slots = [
                Uniform,
                Slot::Step,
                Read,
                Read,
                Texture,
                Texture,
                Read,
                Read,
                Read,
                Write,
                Write,
                Texture,
            ];
            let own = [
                ("CLOSED", f64::from(CLOSED)),
                ("REACH", REACH as f64),
                ("ONTO", f64::from(u8::from(onto))),
            ];
            let constants = [CELLS, MARCH, &own].concat();
            Kernels::new(device, &shaders::HOP, &["main"], &slots, &constants)
        };
        let reflect = |entries: &[&'static str], more: &[_]| {
            let slots = [&[Uniform, Texture, Texture, Read, Write, Write], more].concat();
            Kernels::new(device, &shaders::REFLECT, entries, &slots, &[])
        };
        let converges = bounces == Bounces::Converged;
        Self {
            slabs: Kernels::new(
                device,
                &shaders::SLABS,
                &["main"],
                &[Uniform, Slot::Step, Texture, Texture, Read, Write, Write],
                CELLS,
            ),
            intervals: [2, 3].map(|words| Intervals::new(device, words)),
            hop: hop(false),
            onto: hop(true),
            reflect: reflect(&["send", "show"], &[]),
            convergence: converges
                .then(|| (Convergence::new(device), reflect(&["send_on"], &[Write, Slot::Step]))),
        }
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        let settings = &site.settings.holographic;
        let look = Look::new(settings);
        let intervals = &self.intervals[usize::from(site.known.tinted)];
        let [width, height] = site.size.map(|side| side as usize);
        let sides = [[width, height], [height, width]];
        let words = u64::from(intervals.words);
        let lay_out = |halvings| {
            let lattices = sides.map(|sides| {
                Lattice::new(sides, look.level, words, site.options.fused_levels, halvings)
            });
            let most = |of: fn(&Lattice) -> u64| of(&lattices[0]).max(of(&lattices[1]));
            let bytes = [most(|l| l.intervals) * ONE, most(|l| l.radiance) * PACKED];
            (lattices, bytes)
        };
        // In smaller chunks where much memory would be held, or more than the device can bind.
        let filled_up = sides.map(|[depth, rows]| (depth.next_power_of_two() * rows) as u64);
        let enough = (filled_up.iter().sum::<u64>() / 2 * words * MOST_HELD).max(LITTLE);
        let fits = |(lattices, bytes): &([Lattice; 2], [u64; 2])| {
            let smallest = lattices.iter().all(|l| l.chunk == l.first + 1);
            let bound = bytes.iter().all(|&bytes| bytes <= site.most_bytes());
            smallest || (bound && bytes.iter().sum::<u64>() <= enough)
        };
        let laid_out = (0..u32::BITS).map(lay_out).find(fits);
        let (lattices, [interval_bytes, radiance_bytes]) =
            laid_out.unwrap_or_else(|| lay_out(u32::BITS));

        let ways = Ways::new(look, settings.beams);
        let mut cones: Vec<[f32; 4]> = Vec::new();
        let mut axes = Vec::new();
        let mut bits = 0;
        for (axis, lattice) in (0..).zip(lattices) {
            let (mut begins, table) = tables::cones(look.level, lattice.end);
            begins.iter_mut().for_each(|begin| *begin += cones.len() as u32);
            cones.extend(table);
            let words = lattice.depth * lattice.rows.div_ceil(32);
            axes.push(Axis { axis, lattice, cones: begins, bits });
            bits += 3 * words as u32;
        }
        let tables = [
            site.filled("ways", BufferUsages::STORAGE, bytemuck::cast_slice(&ways.words))?,
            site.filled("cones", BufferUsages::STORAGE, bytemuck::cast_slice(&cones))?,
        ];
        let bits = site.buffer("kinds of cells", u64::from(bits) * ONE)?;
        let held = site.buffer("intervals", interval_bytes)?;
        let radiance = site.buffer("light of cones", radiance_bytes)?;
        let faces = 4 * site.cells() * PACKED;
        let received = site.buffer("received", faces)?;
        let bounces = site.settings.bounces.limit();
        let sent = site.buffer("sent", if bounces > 0 { faces } else { PACKED })?;

        let mut quadrant =
            Quadrant::new(look, &ways, settings.beams, intervals.tiles, intervals.words);
        // Bounces after the first are all the same.
        let bounced = [false, true].map(|sends| match bounces > u32::from(sends) {
            true => quadrant.gather(&axes, sends, false),
            false => Vec::new(),
        });
        let seen = quadrant.gather(&axes, bounces > 0, true);
        let sweeps = Sweeps::new(site, quadrant.sweeps())?;
        let told = || sweeps.binding();
        let (emission, matter) = (&site.textures.emission, &site.textures.tint_opacity);
        let [ways, cones] = &tables;
        let bound = Bindings {
            slabs: site.bind(
                &self.slabs,
                &[
                    told(),
                    view(emission),
                    view(matter),
                    whole(&sent),
                    whole(&bits),
                    whole(&received),
                ],
            ),
            trace: site.bind(
                &intervals.trace,
                &[
                    told(),
                    whole(ways),
                    whole(&bits),
                    view(emission),
                    view(matter),
                    whole(&sent),
                    whole(&held),
                ],
            ),
            extend: site.bind(&intervals.extend, &[told(), whole(&held)]),
            cones: site
                .bind(&intervals.cones, &[told(), whole(cones), whole(&held), whole(&radiance)]),
            hop: site.bind(
                &self.hop,
                &[
                    told(),
                    whole(ways),
                    whole(&bits),
                    view(emission),
                    view(matter),
                    whole(&sent),
                    whole(cones),
                    whole(&radiance),
                    whole(light),
                    whole(&received),
                    view(&site.textures.albedo),
                ],
            ),
        };
        let resources = [
            view(matter),
            view(&site.textures.albedo),
            whole(&received),
            whole(&sent),
            whole(light),
        ];
        let faces = site.bind(&self.reflect, &resources);
        let gather = |steps: &[Step]| -> Vec<_> {
            steps.iter().map(|step| self.dispatch(intervals, &bound, step)).collect()
        };
        let gathers = bounced.each_ref().map(|steps| gather(steps));
        let mut dispatches = Vec::new();
        if let Some((convergence, send_on)) = &self.convergence {
            let found = Convergence::found(site)?;
            let more = [whole(&found), site.shared.step()];
            let faces = site.bind(send_on, &[&resources[..], &more].concat());
            let [mut first, mut later] = gathers;
            first.push(site.over_cells(send_on, 0, &faces, Some(0)));
            later.push(site.over_cells(send_on, 0, &faces, Some(1)));
            dispatches = convergence.plan(site, &found, [first, later])?;
        } else {
            for bounce in 0..bounces {
                dispatches.extend_from_slice(&gathers[usize::from(bounce > 0)]);
                dispatches.push(site.over_cells(&self.reflect, 0, &faces, None));
            }
        }
        dispatches.extend(gather(&seen));
        dispatches.push(site.over_cells(&self.reflect, 1, &faces, None));
        Ok(Run { dispatches, stages: vec![(Stage::Light, light.clone())], lamps: None })
    }

    fn dispatch(&self, intervals: &Intervals, bound: &Bindings, step: &Step) -> Dispatch {
        let (kernels, entry, bound) = match step.work {
            Work::Slabs => (&self.slabs, 0, &bound.slabs),
            Work::Trace => (&intervals.trace, 0, &bound.trace),
            Work::Extend => (&intervals.extend, 0, &bound.extend),
            Work::Cones => (&intervals.cones, 0, &bound.cones),
            Work::Finish => (&intervals.cones, 1, &bound.cones),
            Work::Hop => (&self.hop, 0, &bound.hop),
            Work::Onto => (&self.onto, 0, &bound.hop),
        };
        let mut run = Dispatch::new(&kernels.entries[entry], bound, Some(step.sweep), step.groups);
        run.traffic = step.traffic;
        run
    }
}

const CELLS: &[(&str, f64)] = &[
    ("MATTER", MATTER.trailing_zeros() as f64),
    ("FRACTION", FRACTION.trailing_zeros() as f64),
    ("GLOWING", GLOWING.trailing_zeros() as f64),
];
const MARCH: &[(&str, f64)] = &[("LOG_OF_ZERO", LOG_OF_ZERO as f64)];
