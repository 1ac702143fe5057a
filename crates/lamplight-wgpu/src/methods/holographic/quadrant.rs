//! The dispatches of a gather over all quadrants, in order.

use super::lattice::{Lattice, TILE, TRACED};
use super::sky::ConeTable;
use super::sweep::{QUADRANTS, STEPS, Sweep, Together};
use super::tables::Footprints;
use super::tiles::{Tiles, WAVES};
use super::traffic::traffic;
use super::work::Work;
use crate::traffic::Traffic;
use lamplight::internals::holographic::lattice::{GatherGeometry, cones, planes};

/// Cones that a thread merges, one after another.
pub const RUN: u32 = 8;

/// The grid along an axis.
#[derive(Debug)]
pub struct Axis {
    /// 0: slabs are columns; 1: rows.
    pub axis: u32,
    pub lattice: Lattice,
    /// The first entry of each level, from the second on, in the table of cones.
    pub cones: Vec<u32>,
    /// The first word of the cell bits.
    pub cell_bits: u32,
}

/// A planned dispatch, before it is bound.
#[derive(Debug)]
pub struct PlannedWork {
    pub work: Work,
    /// The step of its sweeps.
    pub step: u32,
    pub groups: [u32; 3],
    pub traffic: Traffic,
}

/// A quadrant's part of a dispatch.
#[derive(Clone, Copy, Debug)]
struct Part {
    work: Work,
    sweep: Sweep,
    groups: [u32; 3],
}

/// Plans gathers, and collects the sweeps of their dispatches.
#[derive(Debug)]
pub struct Quadrant {
    geometry: GatherGeometry,
    /// The first entries of the footprints of bundles, and of views.
    bundles: u32,
    views: u32,
    /// Entries of the table of cones.
    cones: u32,
    /// Rays of a bundle.
    width: u32,
    /// Workgroups that extend intervals.
    tiles: Tiles,
    /// Words of an interval.
    words: u32,
    /// Quadrants that share dispatches.
    together: usize,
    sweeps: Vec<Together>,
    /// The parts of the quadrant that is being planned.
    parts: Vec<Part>,
}

impl Quadrant {
    pub fn new(
        geometry: GatherGeometry,
        footprints: &Footprints,
        cones: &ConeTable,
        width: u32,
        tiles: Tiles,
        words: u32,
        together: usize,
    ) -> Self {
        let Footprints { bundles, views, .. } = *footprints;
        let (cones, sweeps, parts) = (cones.entries(), Vec::new(), Vec::new());
        Self { geometry, bundles, views, cones, width, tiles, words, together, sweeps, parts }
    }

    /// The sweeps of all dispatches planned so far.
    pub fn sweeps(&self) -> &[Together] {
        &self.sweeps
    }

    /// Plans a gather of light from all sides. `indirect`: with scattered radiance; `all`: for all pixels, else
    /// for faces and media only.
    pub fn gather(&mut self, axes: &[Axis], indirect: bool, all: bool) -> Vec<PlannedWork> {
        let mut slabs = Vec::new();
        let mut quadrants = Vec::new();
        let mut place = [0; 2];
        for axis in axes {
            let sweep = self.sweep(axis, indirect);
            let Lattice { depth, rows, intervals, radiance, .. } = axis.lattice;
            self.push(Work::Slabs, sweep, [depth.div_ceil(64), rows.div_ceil(32), 1]);
            slabs.push(std::mem::take(&mut self.parts));
            for reversed in [0, 1] {
                let first_quadrant = u32::from(axis.axis == 0 && reversed == 0);
                let sky = ConeTable::light_of(self.cones, axis.axis, reversed);
                self.quadrant(axis, Sweep { reversed, first_quadrant, sky, ..sweep }, all);
                if quadrants.len() % self.together == 0 {
                    place = [0; 2];
                }
                self.parts.iter_mut().for_each(|part| part.sweep = part.sweep.moved(place));
                place = [place[0] + intervals as u32, place[1] + radiance as u32];
                quadrants.push(std::mem::take(&mut self.parts));
            }
        }
        let mut planned = self.share(&slabs);
        for together in quadrants.chunks(self.together) {
            planned.extend(self.share(together));
        }
        planned
    }

    /// Plans dispatches that quadrants share: each does the earliest kind of work that any of them needs next.
    fn share(&mut self, quadrants: &[Vec<Part>]) -> Vec<PlannedWork> {
        let mut left: Vec<&[Part]> = quadrants.iter().map(Vec::as_slice).collect();
        let mut planned = Vec::new();
        while let Some(work) = left.iter().filter_map(|parts| Some(parts.first()?.work)).min() {
            let mut parts = Vec::new();
            for left in &mut left {
                if let Some((part, rest)) = left.split_first()
                    && part.work == work
                    && (parts.is_empty() || work.is_apart())
                {
                    parts.push(*part);
                    *left = rest;
                }
            }
            planned.push(self.plan(work, &parts));
        }
        planned
    }

    fn plan(&mut self, work: Work, parts: &[Part]) -> PlannedWork {
        let quadrants = parts.len() as u32;
        let most = |i: usize| parts.iter().map(|part| part.groups[i]).max().unwrap_or(0);
        let mut together = [Sweep::default(); QUADRANTS];
        for (sweep, part) in together.iter_mut().zip(parts) {
            *sweep = Sweep { quadrants, ..part.sweep };
        }
        let step = STEPS * self.sweeps.len() as u32;
        self.sweeps.push(together);
        let traffic = |part: &Part| traffic(work, &part.sweep, part.groups, self.words.into());
        PlannedWork {
            work,
            step,
            groups: [most(0), most(1), quadrants * most(2)],
            traffic: parts.iter().map(traffic).sum(),
        }
    }

    /// The parameters that all dispatches of an axis share.
    fn sweep(&self, axis: &Axis, indirect: bool) -> Sweep {
        Sweep {
            depth: axis.lattice.depth as u32,
            rows: axis.lattice.rows as u32,
            axis: axis.axis,
            cell_bits: axis.cell_bits,
            indirect: u32::from(indirect),
            gather_length: self.geometry.min_length as u32,
            ..Sweep::default()
        }
    }

    fn push(&mut self, work: Work, sweep: Sweep, groups: [usize; 3]) {
        let groups = groups.map(|count| count as u32);
        if groups.iter().all(|&count| count > 0) {
            let planes = groups[if work == Work::Trace { 1 } else { 2 }];
            self.parts.push(Part { work, sweep: Sweep { planes, ..sweep }, groups });
        }
    }

    fn quadrant(&mut self, axis: &Axis, sweep: Sweep, all: bool) {
        let lattice = &axis.lattice;
        let mut chain = Chain { held: vec![None; (lattice.end - lattice.chunk) as usize] };
        for chunk in (0..lattice.chunks()).rev() {
            self.trace(lattice, sweep, chunk);
            self.extend(lattice, sweep, chunk);
            self.merge_chain(axis, sweep, chunk, &mut chain);
            self.merge(axis, sweep, chunk);
            self.final_gather(axis, sweep, chunk, all);
        }
    }

    /// Plans the first level: all planes of the chunk except the grid's first.
    fn trace(&mut self, lattice: &Lattice, sweep: Sweep, chunk: usize) {
        let level = lattice.first;
        let all = 1 << (lattice.chunk - level);
        let planes = range(chunk * all, all, planes(lattice.depth, level), 1);
        let first = lattice.first_of(level, chunk);
        let sweep = Sweep {
            level,
            first: planes.start as u32,
            odd: [lattice.odd(level), 0, 0, 0],
            odd_first: [first; 4],
            even: lattice.even(level),
            even_first: first,
            footprints: self.bundles,
            rays: self.width,
            ..sweep
        };
        self.push(Work::Trace, sweep, [lattice.rows.div_ceil(TRACED as usize), planes.len(), 1]);
    }

    /// Plans the levels above: those within the chunk, and those that its near end completes.
    fn extend(&mut self, lattice: &Lattice, sweep: Sweep, chunk: usize) {
        // Nothing needs what begins at the grid's near end.
        let top = if chunk == 0 { lattice.chunk - 1 } else { lattice.chunk };
        for [level, levels] in lattice.groups(lattice.first, top) {
            let above = level + levels;
            let all = 1 << (lattice.chunk - above);
            // Of the grid's first plane only levels in between are needed.
            let low = usize::from(levels == 1);
            let planes = range(chunk * all, all, planes(lattice.depth, above), low);
            self.extend_group(lattice, sweep, chunk, [level, levels], planes);
        }
        let (mut level, mut plane) = (lattice.chunk, chunk);
        while plane > 0 && plane.is_multiple_of(2) && level + 1 < lattice.end {
            plane /= 2;
            self.extend_group(lattice, sweep, chunk, [level, 1], plane..plane + 1);
            level += 1;
        }
    }

    fn extend_group(
        &mut self,
        lattice: &Lattice,
        sweep: Sweep,
        chunk: usize,
        [level, levels]: [u32; 2],
        planes: std::ops::Range<usize>,
    ) {
        let of = |up: usize| level + up as u32;
        let first = |level| lattice.first_of(level, chunk);
        let sweep = Sweep {
            level,
            levels,
            first: planes.start as u32,
            odd: std::array::from_fn(|up| lattice.odd(of(up))),
            odd_first: std::array::from_fn(|up| first(of(up))),
            odd_top: lattice.odd(level + levels),
            odd_top_first: first(level + levels),
            even: lattice.even(level),
            even_first: first(level),
            even_top: lattice.even(level + levels),
            even_top_first: first(level + levels),
            ..sweep
        };
        let rays = 2 << level;
        if levels == 1 {
            let tiles = lattice.rows.div_ceil(self.tiles.lanes as usize);
            self.push(Work::ExtendOnce, sweep, [tiles, rays / WAVES, planes.len()]);
        } else {
            // Planes are slanted by up to so many rows.
            let slant = ((1usize << levels) - 2) << level;
            let tiles = (lattice.rows + slant).div_ceil(self.tiles.rows() as usize);
            self.push(Work::Extend, sweep, [tiles, rays, planes.len()]);
        }
    }

    /// Plans light at the far end of the chunk, from that at the planes of higher levels behind it.
    fn merge_chain(&mut self, axis: &Axis, sweep: Sweep, chunk: usize, chain: &mut Chain) {
        for (level, plane) in chain.missing(&axis.lattice, chunk + 1) {
            let sweep = Sweep {
                first: plane as u32,
                far: plane.div_ceil(2) as u32,
                odd_first: [plane as u32 / 2; 4],
                below_far: plane as u32,
                ..sweep
            };
            self.merge_level(axis, sweep, level, 1);
        }
    }

    /// Plans light at all planes of the chunk, down to the level that pixels gather from.
    fn merge(&mut self, axis: &Axis, sweep: Sweep, chunk: usize) {
        let lattice = &axis.lattice;
        let (first, depth) = (lattice.first, lattice.depth);
        for level in (first + 1..lattice.chunk).rev() {
            let all = 1 << (lattice.chunk - level);
            // From behind the near end of the chunk to its far end.
            let made = range(chunk * all + 1, all, planes(depth, level), 1);
            let sweep = Sweep {
                first: made.start as u32,
                far: lattice.last_of_light(level + 1, chunk) as u32,
                odd_first: [lattice.first_of(level, chunk); 4],
                below_far: lattice.last_of_light(level, chunk) as u32,
                ..sweep
            };
            self.merge_level(axis, sweep, level, made.len());
        }
        let all = 1 << (lattice.chunk - first - 1);
        let sources = range(chunk * all + 1, all, planes(depth, first) / 2 + 1, 1);
        let sweep = Sweep { first: sources.start as u32, ..self.gathered(axis, sweep, chunk) };
        let rows = lattice.rows.div_ceil(TILE as usize);
        self.push(Work::Finish, sweep, [rows, cones(first + 1) / 2, sources.len()]);
    }

    /// Plans light at some planes of a level, from that of the level above.
    fn merge_level(&mut self, axis: &Axis, sweep: Sweep, level: u32, planes: usize) {
        let lattice = &axis.lattice;
        let sweep = Sweep {
            level,
            odd: [lattice.odd(level), 0, 0, 0],
            above: lattice.light(level + 1),
            below: lattice.light(level),
            halves: u32::from(level > lattice.first + 1),
            cones_above: axis.cones(level + 1),
            ..sweep
        };
        let rows = lattice.rows.div_ceil(TILE as usize);
        let runs = cones(level).div_ceil(RUN as usize);
        self.push(Work::Merge, sweep, [rows, runs, planes]);
    }

    /// The parameters of dispatches that gather from the first level.
    fn gathered(&self, axis: &Axis, sweep: Sweep, chunk: usize) -> Sweep {
        let lattice = &axis.lattice;
        let level = lattice.first;
        let far = lattice.last_of_light(level + 1, chunk) as u32;
        Sweep {
            level,
            levels: 1,
            far,
            odd: [lattice.odd(level), 0, 0, 0],
            odd_first: [lattice.first_of(level, chunk); 4],
            above: lattice.light(level + 1),
            below: lattice.light(level),
            below_far: 2 * far,
            cones_above: axis.cones(level + 1),
            footprints: self.views,
            rays: self.geometry.rays,
            ..sweep
        }
    }

    /// Plans the final gather of the pixels whose plane lies in the chunk.
    fn final_gather(&mut self, axis: &Axis, sweep: Sweep, chunk: usize, all: bool) {
        let lattice = &axis.lattice;
        let near =
            |chunk: usize| (chunk << lattice.chunk).saturating_sub(self.geometry.min_length - 1);
        let from = if chunk == 0 { 0 } else { near(chunk) };
        let last = chunk + 1 == lattice.chunks();
        let to = if last { lattice.depth } else { near(chunk + 1) };
        let sweep = Sweep { first: from as u32, ..self.gathered(axis, sweep, chunk) };
        let groups = [lattice.rows.div_ceil(TILE as usize), to - from, 1];
        self.push(if all { Work::Gather } else { Work::Faces }, sweep, groups);
    }
}

impl Axis {
    /// The first entry of a level, from the second on, in the table of cones.
    fn cones(&self, level: u32) -> u32 {
        self.cones[(level - self.lattice.first - 1) as usize]
    }
}

/// The plane of each level, from a chunk's on, whose light is stored.
struct Chain {
    held: Vec<Option<usize>>,
}

impl Chain {
    /// Returns the planes to make, from the top down, for the light at a plane of the lowest level.
    fn missing(&mut self, lattice: &Lattice, plane: usize) -> Vec<(u32, usize)> {
        let mut missing = Vec::new();
        for (level, held) in (lattice.chunk..).zip(&mut self.held) {
            let wanted = plane.div_ceil(1 << (level - lattice.chunk));
            // Beyond the grid there is sky.
            if *held == Some(wanted) || wanted >= planes(lattice.depth, level) {
                break;
            }
            *held = Some(wanted);
            missing.push((level, wanted));
        }
        missing.reverse();
        missing
    }
}

/// The range of `count` planes from one on, without those below `low` and from `end` on.
fn range(from: usize, count: usize, end: usize, low: usize) -> std::ops::Range<usize> {
    let first = from.max(low);
    first..(from + count).min(end).max(first)
}
