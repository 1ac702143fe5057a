//! Holographic radiance cascades (Freeman, Sannikov and Margel 2025).
//!
//! Quadrant after quadrant, or several together, chunk after chunk ([`lattice`]): trace the first level of intervals, extend
//! them level by level, merge cones down, and let the pixels of the chunk gather from them.

mod border;
mod lattice;
pub mod paper;
mod quadrant;
pub mod sky;
pub mod sweep;
mod tables;
mod tiles;
mod traffic;
mod work;

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pass_list::PassList;
use crate::pipeline::{BoundResources, ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::stage::Stage;
use crate::stages::bounce::{Bounce, FACES};
use crate::stages::convergence::Convergence;
use crate::{programs, shaders};
use lamplight::Bounces;
use lamplight::internals::MAX_OPTICAL_DEPTH;
use lamplight::internals::holographic::lattice::{GatherGeometry, bent, points, rays};
use lamplight::internals::holographic::{
    EMISSIVE, MATTER, MEDIUM, PRIMARY, REACH, SMALL, WEIGHT_EPSILON, exchanged,
};
use lamplight::settings::Holographic as Settings;
use lattice::{Lattice, Packed};
use quadrant::{Axis, PlannedWork, Quadrant, RUN};
use sky::{ConeSky, ConeTable};
use std::collections::BTreeMap;
use sweep::Sweeps;
use tables::Footprints;
use tiles::{BLOCK, EXTENDED, GatherTile, LINES, LINES_LAST, MERGED, WIDTH, held_pairs};
use traffic::BITS;
use wgpu::{Buffer, BufferUsages, DeviceType};
use work::Work;

/// The most bytes of a quadrant that are stored per cell, of a grid padded to a power of two, and per word of an interval.
/// Lower values save memory and take more dispatches.
const MAX_HELD: u64 = 50;
/// Quadrants share dispatches as long as their buffers take no more bytes than this: more on cards with memory of their own,
/// which the dispatches of one quadrant rarely fill.
const LITTLE: u64 = 160 << 20;
const LITTLE_OF_CARD: u64 = 1 << 30;

/// The pipelines.
#[derive(Debug)]
pub struct Holographic {
    settings: Settings,
    slabs: ComputePipelines,
    /// Without tint, and with tint.
    intervals: [IntervalPipelines; 2],
    gather: ComputePipelines,
    gather_faces: ComputePipelines,
    faces: ComputePipelines,
    bounce: Bounce<ComputePipelines, ComputePipelines>,
}

/// The pipelines that depend on how intervals are stored.
#[derive(Debug)]
struct IntervalPipelines {
    /// Words of an interval.
    words: u32,
    trace: ComputePipelines,
    /// For a single level, and for two.
    extend: [ComputePipelines; 2],
    merge: ComputePipelines,
    finish: ComputePipelines,
}

impl IntervalPipelines {
    fn new(
        compiler: &Compiler,
        geometry: GatherGeometry,
        width: u32,
        words: u32,
        inflow: bool,
    ) -> Self {
        let level = geometry.first();
        let stored = ("WORDS", f64::from(words));
        let [straight, diagonal] = exchanged(level).map(f64::from);
        let [straight, diagonal] = [("EXCHANGED", straight), ("EXCHANGED_DIAGONAL", diagonal)];
        let bundles = ("BUNDLES", rays(level) as f64);
        let in_each = ("RAYS", width.into());
        let bits = ("FOURTH", SMALL_BIT);
        let own = [bits, stored, straight, diagonal, bundles, in_each, spacing(geometry)];
        let trace = [CELLS, MARCH, &own].concat();
        let bent = ("BENT", bent(geometry.spacing_level).into());
        let extend = |levels: u32| {
            let (rows, before, pairs) = match levels {
                1 => (tiles::LANES, 0, 1),
                _ => (EXTENDED.rows, EXTENDED.before, held_pairs(words)),
            };
            let constants = [
                stored,
                bent,
                ("LEVELS", levels.into()),
                ("TILE", rows.into()),
                ("BEFORE", before.into()),
                ("LANES", tiles::LANES.into()),
                ("WIDTH", WIDTH.into()),
                ("HELD", pairs.into()),
                ("FIRST_TINT", tiles::HELD.into()),
            ];
            compiler.program(&programs::HOLOGRAPHIC_EXTEND, &constants)
        };
        let merge = [
            stored,
            bent,
            ("RUN", RUN.into()),
            ("BLOCK", BLOCK.into()),
            ("LINES", LINES.into()),
            ("LINES_LAST", LINES_LAST.into()),
            ("TILE", MERGED.rows.into()),
            ("BEFORE", MERGED.before.into()),
        ];
        let merge = [&merge[..], &shaders::inflow(inflow)].concat();
        Self {
            words,
            trace: compiler.program(&programs::HOLOGRAPHIC_TRACE, &trace),
            extend: [1, 2].map(extend),
            merge: compiler.program(&programs::HOLOGRAPHIC_MERGE, &merge),
            finish: compiler.program(&programs::HOLOGRAPHIC_FINISH, &merge),
        }
    }
}

/// The lattices of both axes, as large as memory allows.
struct MemoryLayout {
    lattices: [Lattice; 2],
    /// Quadrants that share dispatches, in a chunk each.
    together: usize,
    /// The most intervals of each level, and words of light, of the quadrants that do.
    intervals: Vec<u64>,
    radiance: u64,
    /// The most words of the light that pixels gather, on planes of odd index or of even index, and the levels in whose
    /// buffers they lie in place of intervals: nothing else reads those any more.
    shown: u64,
    hosts: [Option<usize>; 2],
}

impl MemoryLayout {
    /// Lays out as many quadrants together as fit into memory, or one in chunks that are halved until it does.
    fn new(planner: &FramePlanner, geometry: GatherGeometry, words: u32) -> Self {
        let level = geometry.first();
        let [width, height] = <[u32; 2]>::from(planner.size)
            .map(|side| points(side as usize, geometry.spacing_level));
        let sides = [[width, height], [height, width]];
        let is_card = planner.device.adapter_info().device_type == DeviceType::DiscreteGpu;
        let fused = planner.options.fused_levels(is_card);
        let lattice = |sides, halvings| Lattice::new(sides, level, fused, halvings);
        let little = if is_card { LITTLE_OF_CARD } else { LITTLE };
        // Chunks are smaller if much memory would be needed, or more than the device can bind.
        let padded = sides.map(|[depth, rows]| (depth.next_power_of_two() * rows) as u64);
        let enough = (padded.iter().sum::<u64>() / 2 * u64::from(words) * MAX_HELD).max(little);
        let fits = |layout: &Self| {
            let bytes = layout.bytes(words);
            let bound = bytes.iter().all(|&bytes| bytes <= planner.max_buffer_bytes());
            bound && bytes.iter().sum::<u64>() <= enough
        };
        let in_one_chunk = |together| Self::of(sides.map(|sides| lattice(sides, 0)), together);
        let mut found = [4, 2].into_iter().map(in_one_chunk).filter(fits);
        found.next().unwrap_or_else(|| {
            let in_chunks = sides.map(|sides| {
                let alone = |lattice: &Lattice| Self::of([lattice.clone(), lattice.clone()], 1);
                let mut halved = (0..u32::BITS).map(|halvings| lattice(sides, halvings));
                let found = halved.find(|lattice| lattice.is_smallest() || fits(&alone(lattice)));
                found.unwrap_or_else(|| lattice(sides, u32::BITS))
            });
            Self::of(in_chunks, 1)
        })
    }

    fn of(lattices: [Lattice; 2], together: usize) -> Self {
        let most = |of: &dyn Fn(&Lattice) -> u64| {
            let quadrants = [0, 0, 1, 1].map(|axis: usize| of(&lattices[axis]));
            quadrants.chunks(together).map(|held| held.iter().sum()).max().unwrap_or(0)
        };
        let levels = lattices.iter().map(|lattice| lattice.intervals.len()).max().unwrap_or(0);
        let of_level = |level: usize| {
            most(&|lattice: &Lattice| lattice.intervals.get(level).copied().unwrap_or(0))
        };
        let mut intervals: Vec<u64> = (0..levels).map(of_level).collect();
        let [radiance, shown] =
            [|lattice: &Lattice| lattice.radiance, |lattice: &Lattice| lattice.shown]
                .map(|of| most(&of));
        // The first level is read until the end, and those from a chunk's on are kept for the next chunk.
        let chunk = lattices.iter().map(|lattice| lattice.chunk - lattice.first).min();
        let mut hosts = (1..chunk.unwrap_or(0) as usize).filter(|&level| intervals[level] > 0);
        let hosts = [hosts.next(), hosts.next()];
        for level in hosts.into_iter().flatten() {
            intervals[level] = intervals[level].max(shown.div_ceil(2));
        }
        Self { lattices, together, intervals, radiance, shown, hosts }
    }

    /// Bytes of each buffer: the intervals of each level, their third words, and light.
    fn bytes(&self, words: u32) -> Vec<u64> {
        let packed = size_of::<Packed>() as u64;
        let third = u64::from(words - 2) * size_of::<u32>() as u64;
        let intervals = self.intervals.iter().flat_map(|count| [count * packed, count * third]);
        let shown = self.hosts.iter().filter(|host| host.is_none()).map(|_| self.shown);
        let light = shown.chain([self.radiance]).map(|words| words * size_of::<u32>() as u64);
        intervals.chain(light).collect()
    }
}

/// The intervals of a level, and their third words: one if matter does not tint.
struct LevelBuffers {
    intervals: Buffer,
    tints: Buffer,
}

impl LevelBuffers {
    fn new(planner: &FramePlanner, count: u64, words: u32) -> Result<Self> {
        let tints = if words == 3 { count } else { 1 };
        Ok(Self {
            intervals: planner.buffer::<Packed>("intervals", count.max(1))?,
            tints: planner.buffer::<u32>("tints of intervals", tints.max(1))?,
        })
    }
}

/// The buffers of a plan.
struct Buffers {
    footprints: Buffer,
    cones: Buffer,
    cell_bits: Buffer,
    /// Buffers of each level that is stored, from the first on.
    levels: Vec<Option<LevelBuffers>>,
    radiance: Buffer,
    /// The light that pixels gather, on planes of odd index, and of even index.
    shown: [Buffer; 2],
    /// That of faces, and behind it the light of pixels until the last quadrant adds it up.
    irradiance: Buffer,
    scattered: Buffer,
}

/// The bound resources of each program.
struct Bindings {
    slabs: BoundResources,
    trace: BoundResources,
    /// By the level that is read, and the level that is made.
    extend: BTreeMap<[u32; 2], BoundResources>,
    /// By the level that is read.
    merge: BTreeMap<u32, BoundResources>,
    finish: BoundResources,
    gather: BoundResources,
}

impl Holographic {
    /// Declares the pipelines. `inflow`: for frames with light that enters by place.
    pub fn new(
        compiler: &Compiler,
        settings: &Settings,
        bounces: Bounces,
        moment: bool,
        inflow: bool,
    ) -> Self {
        let geometry = GatherGeometry::new(settings);
        let tile = GatherTile::new(geometry);
        let gather = |pixels: bool| {
            let own = [
                ("FOURTH", PRIMARY_BIT),
                ("WEIGHT_EPSILON", f64::from(WEIGHT_EPSILON)),
                ("REACH", REACH as f64),
                ("PIXELS", f64::from(pixels)),
                ("CONES", lattice::shown(geometry.first() + 1) as f64),
                ("SPLITS_AT_MATTER", f64::from(geometry.splits_at_matter())),
                ("DEPTH", tile.depth.into()),
                ("HELD_CONES", tile.cones.into()),
                ("HELD_ROWS", tile.rows.into()),
                ("ROWS_BEFORE", tile.before.into()),
                spacing(geometry),
                shaders::moment(moment && pixels),
            ];
            let constants = [CELLS, MARCH, &own, &shaders::inflow(inflow)].concat();
            compiler.program(&programs::HOLOGRAPHIC_GATHER, &constants)
        };
        let compared = || compiler.program(&programs::HOLOGRAPHIC_FACES_COMPARED, SOLID);
        let feedback = || compiler.program(&programs::HOLOGRAPHIC_FEEDBACK, &[]);
        let bounce = Bounce::new(compiler, bounces, compared, feedback);
        let marks = ("MARKS", f64::from(bounces == Bounces::Feedback));
        Self {
            settings: settings.clone(),
            slabs: compiler.program(
                &programs::HOLOGRAPHIC_SLABS,
                &[CELLS, &[("SMALL", SMALL_BIT), ("PRIMARY", PRIMARY_BIT)]].concat(),
            ),
            intervals: [2, 3].map(|words| {
                IntervalPipelines::new(compiler, geometry, bundle_width(settings), words, inflow)
            }),
            gather: gather(true),
            gather_faces: gather(false),
            faces: compiler.program(&programs::HOLOGRAPHIC_FACES, &[SOLID, &[marks]].concat()),
            bounce,
        }
    }

    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        let settings = &self.settings;
        let geometry = GatherGeometry::new(settings);
        let intervals = &self.intervals[usize::from(planner.hints.tinted)];
        let layout = MemoryLayout::new(planner, geometry, intervals.words);
        let MemoryLayout { together, radiance, .. } = layout;
        // The first level is bound, even if the grid is too small for any.
        let stored = layout.intervals.iter().enumerate().map(|(level, &count)| {
            let stored = count > 0 || level == 0;
            stored.then(|| LevelBuffers::new(planner, count, intervals.words)).transpose()
        });
        let levels = stored.collect::<Result<Vec<_>>>()?;
        let shown = |host: Option<usize>| match host.and_then(|level| levels[level].as_ref()) {
            Some(host) => Ok(host.intervals.clone()),
            None => planner.buffer::<u32>("light that pixels gather", layout.shown.max(1)),
        };
        let shown = [shown(layout.hosts[0])?, shown(layout.hosts[1])?];

        let footprints = Footprints::new(geometry, bundle_width(settings));
        let ends = layout.lattices.each_ref().map(|lattice| lattice.end);
        let cones = ConeTable::of_bundles(geometry.first(), ends);
        let mut axes = Vec::new();
        let mut cell_bits = 0;
        let [w, h] = <[u32; 2]>::from(planner.size).map(|side| side as usize);
        for ((axis, lattice), cones) in (0..).zip(layout.lattices).zip(&cones.begins) {
            let cells @ [depth, rows] = if axis == 0 { [w, h] } else { [h, w] };
            let words = depth * rows.div_ceil(32);
            axes.push(Axis { axis, lattice, cells, cones: cones.clone(), cell_bits });
            cell_bits += BITS * words as u32;
        }
        let storage = BufferUsages::STORAGE;
        let faces = FACES * planner.cells();
        let buffers = Buffers {
            footprints: planner.filled(
                "footprints",
                storage,
                bytemuck::cast_slice(&footprints.entries),
            )?,
            cones: cones.buffer(planner)?,
            cell_bits: planner.buffer::<u32>("cell bits", cell_bits.into())?,
            levels,
            radiance: planner.buffer::<u32>("light of cones", radiance.max(1))?,
            shown,
            irradiance: planner.buffer::<Packed>("irradiance", faces + planner.cells())?,
            scattered: self.bounce.kept_buffer::<Packed>(planner, faces)?,
        };

        let moment = planner.settings.moment;
        let mut quadrant =
            Quadrant::new(geometry, &footprints, &cones, intervals.words, moment, together);
        let sky = planner.has_panorama().then(|| ConeSky::new(cones, buffers.cones.clone()));
        // Bounces after the first are all the same.
        let within_a_frame = match self.bounce {
            Bounce::Times(times) => times,
            Bounce::Converged(..) => u32::MAX,
            Bounce::Feedback(_) => 0,
        };
        let [first, later] = [false, true].map(|indirect| {
            if within_a_frame > u32::from(indirect) {
                quadrant.gather(&axes, indirect, false)
            } else {
                Vec::new()
            }
        });
        let last = quadrant.gather(&axes, self.bounce.is_any(), true);
        let sweeps = Sweeps::new(planner, quadrant.sweeps())?;
        let bindings = self.bind(planner, intervals, &buffers, &sweeps, light);
        let bound = |planned: &[PlannedWork]| -> Vec<_> {
            planned.iter().map(|work| self.dispatch(intervals, &bindings, work)).collect()
        };
        let [mut first, mut later, last] = [first, later, last].map(|planned| bound(&planned));

        let direct = planner.direct_light()?;
        let resources = [
            view(&planner.textures.tint_opacity),
            view(&planner.textures.albedo),
            whole(&buffers.irradiance),
            whole(&direct),
            whole(&buffers.scattered),
            whole(light),
            whole(&buffers.cell_bits),
        ];
        let faces = planner.bind(&self.faces, &resources);
        let scatter = planner.over_cells(&self.faces, SCATTER, &faces, None);
        let mut dispatches = Vec::new();
        match &self.bounce {
            Bounce::Times(times) => {
                for bounce in 0..*times {
                    dispatches.extend_from_slice(if bounce == 0 { &first } else { &later });
                    dispatches.push(scatter.clone());
                }
            }
            Bounce::Converged(convergence, compared) => {
                let changes = Convergence::changes(planner)?;
                let more = [whole(&changes), planner.shared.step()];
                let faces = planner.bind(compared, &[&resources[..], &more].concat());
                first.push(planner.over_cells(compared, 0, &faces, Some(0)));
                later.push(planner.over_cells(compared, 0, &faces, Some(1)));
                dispatches = convergence.plan(planner, &changes, first, later)?;
            }
            Bounce::Feedback(feedback) => {
                let [matter, albedo, ..] = &resources;
                let resources = [matter.clone(), albedo.clone(), whole(&buffers.scattered)];
                let bound = planner.bind(feedback, &resources);
                dispatches.push(planner.over_cells(feedback, 0, &bound, None));
            }
        }
        dispatches.extend(last);
        let show = planner.over_cells(&self.faces, SHOW, &faces, None);
        dispatches.push(show.with_traffic(traffic::of_shown_faces(planner.cells())));
        if matches!(self.bounce, Bounce::Feedback(_)) {
            dispatches.push(scatter);
        }
        dispatches.extend(planner.add_direct(light));
        let stages = vec![(Stage::Light, light.clone())];
        Ok(PassList { sky, ..PassList::new(dispatches, stages) })
    }

    fn bind(
        &self,
        planner: &FramePlanner,
        intervals: &IntervalPipelines,
        buffers: &Buffers,
        sweeps: &Sweeps,
        light: &Buffer,
    ) -> Bindings {
        let Buffers { footprints, cones, cell_bits, levels, .. } = buffers;
        let Buffers { radiance, shown, irradiance, scattered, .. } = buffers;
        let first = GatherGeometry::new(&self.settings).first();
        let level = |level: u32| {
            let held = levels.get((level - first) as usize)?.as_ref()?;
            Some([whole(&held.intervals), whole(&held.tints)])
        };
        let emission = view(&planner.textures.emission);
        let matter = view(&planner.textures.tint_opacity);
        let slabs = [
            sweeps.binding(),
            emission.clone(),
            matter.clone(),
            whole(scattered),
            whole(cell_bits),
            whole(irradiance),
        ];
        let rays = [
            sweeps.binding(),
            whole(footprints),
            whole(cell_bits),
            emission,
            matter,
            whole(scattered),
        ];
        let mut extend = BTreeMap::new();
        let mut merge = BTreeMap::new();
        let (mut trace, mut finish) = (Vec::new(), Vec::new());
        for at in first..first + levels.len() as u32 {
            let Some(read) = level(at) else { continue };
            for above in [at + 1, at + 2] {
                let Some(made) = level(above) else { continue };
                let resources = [&[sweeps.binding()], &read[..], &made[..]].concat();
                extend.insert([at, above], planner.bind(&intervals.extend[0], &resources));
            }
            let light = [whole(radiance), planner.panorama()];
            let resources = [&[sweeps.binding(), whole(cones)], &read[..], &light].concat();
            merge.insert(at, planner.bind(&intervals.merge, &resources));
            if at == first {
                trace = [&rays[..], &read].concat();
                finish = [resources, shown.each_ref().map(whole).to_vec()].concat();
            }
        }
        let gather = [
            whole(cones),
            whole(&shown[0]),
            whole(&shown[1]),
            whole(light),
            whole(irradiance),
            view(&planner.textures.albedo),
            planner.panorama(),
        ];
        Bindings {
            slabs: planner.bind(&self.slabs, &slabs),
            trace: planner.bind(&intervals.trace, &trace),
            extend,
            merge,
            finish: planner.bind(&intervals.finish, &finish),
            gather: planner.bind(&self.gather, &[&rays[..], &gather].concat()),
        }
    }

    fn dispatch(
        &self,
        intervals: &IntervalPipelines,
        bindings: &Bindings,
        planned: &PlannedWork,
    ) -> Dispatch {
        let (pipelines, entry, bound) = match planned.work {
            Work::Slabs => (&self.slabs, 0, &bindings.slabs),
            Work::Trace => (&intervals.trace, 0, &bindings.trace),
            Work::ExtendOnce => (&intervals.extend[0], 0, &bindings.extend[&planned.levels]),
            Work::Extend => (&intervals.extend[1], 0, &bindings.extend[&planned.levels]),
            Work::Merge => (&intervals.merge, 0, &bindings.merge[&planned.levels[0]]),
            Work::MergeOnce => (&intervals.merge, 1, &bindings.merge[&planned.levels[0]]),
            Work::Finish => (&intervals.finish, 0, &bindings.finish),
            Work::Gather => (&self.gather, 0, &bindings.gather),
            Work::Faces => (&self.gather_faces, 0, &bindings.gather),
        };
        let pipeline = pipelines.entry(entry);
        let dispatch = Dispatch::new(pipeline, bound, Some(planned.step), planned.groups);
        dispatch.with_traffic(planned.traffic)
    }
}

/// Entries of [`programs::HOLOGRAPHIC_FACES`].
const SCATTER: usize = 0;
const SHOW: usize = 1;

/// The rays of a bundle from a row of cells: rows that share a point share those of its bundles.
fn bundle_width(settings: &Settings) -> u32 {
    settings.bundle_rays.div_ceil(settings.lattice_spacing)
}

/// The constant of rows of cells to a point of the lattice.
fn spacing(geometry: GatherGeometry) -> (&'static str, f64) {
    ("SPACING", f64::from(1u32 << geometry.spacing_level))
}

/// The bits of cells that tell solid ones.
const SOLID: &[(&str, f64)] =
    &[("MATTER", MATTER.trailing_zeros() as f64), ("MEDIUM", MEDIUM.trailing_zeros() as f64)];
/// With that of those that emit.
const CELLS: &[(&str, f64)] = &[SOLID[0], SOLID[1], ("EMISSIVE", EMISSIVE.trailing_zeros() as f64)];
const SMALL_BIT: f64 = SMALL.trailing_zeros() as f64;
const PRIMARY_BIT: f64 = PRIMARY.trailing_zeros() as f64;
/// Constants of shaders/methods/holographic/footprint.wgsl beside them.
const MARCH: &[(&str, f64)] = &[("MAX_OPTICAL_DEPTH", MAX_OPTICAL_DEPTH as f64)];

#[cfg(test)]
mod tests {
    use super::sweep::LAST_TURN;
    use super::tiles::{LANES, WAVES};
    use super::*;
    use crate::shaders;
    use lamplight::internals::holographic::lattice::BEYOND;
    use naga::{Expression, Literal};

    /// The value of a constant of a shader.
    fn constant(shader: &str, name: &str) -> u32 {
        let module = naga::front::wgsl::parse_str(&shaders::text(shader)).unwrap();
        let found = module.constants.iter().find(|(_, known)| known.name.as_deref() == Some(name));
        let (_, found) = found.unwrap_or_else(|| panic!("{shader} has no constant {name}"));
        match module.global_expressions[found.init] {
            Expression::Literal(Literal::U32(value)) => value,
            Expression::Literal(Literal::I32(value)) => value.unsigned_abs(),
            ref other => panic!("{shader}: {name} is {other:?}"),
        }
    }

    #[test]
    fn shaders_and_plans_have_the_same_numbers() {
        let [slabs, trace, extend, merge, gather] = ["slabs", "trace", "extend", "merge", "gather"]
            .map(|name| format!("methods/holographic/{name}"));
        for (shader, name, value) in [
            (&slabs, "BITS", BITS),
            (&trace, "TILE", lattice::TILE),
            (&extend, "WAVES_LOG2", WAVES.ilog2()),
            (&merge, "LANES", LANES),
            (&merge, "WAVES", WAVES),
            (&merge, "BEYOND", BEYOND as u32),
            (&gather, "TILE", lattice::TILE),
            (&gather, "ASIDE", tables::ASIDE as u32),
            (&gather, "SLABS", tiles::SLABS),
            (&gather, "LAST_TURN", LAST_TURN),
            (&gather, "PAIR_WORDS", lattice::light_words(2) as u32),
        ] {
            assert_eq!(constant(shader, name), value, "{shader}: {name}");
        }
        let sweeps = format!("array<Sweep, {}>", sweep::QUADRANTS);
        assert!(shaders::text(&merge).contains(&sweeps), "no {sweeps}");
    }
}
