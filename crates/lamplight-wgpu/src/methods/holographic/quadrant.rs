//! The dispatches of a gather over all quadrants, in order.

use super::lattice::{Lattice, TILE, shown, traced};
use super::sky::ConeTable;
use super::sweep::{QUADRANTS, STEPS, Sweep, Together};
use super::tables::Footprints;
use super::tiles::{BLOCK, EXTENDED, GatherTile, LANES, LINES_LAST, MERGED, WAVES, WIDTH};
use super::traffic::traffic;
use super::work::Work;
use crate::traffic::Traffic;
use lamplight::internals::holographic::lattice::{GatherGeometry, cones, planes};

/// Cones that a thread merges if a dispatch makes one level, one after another.
pub const RUN: u32 = 8;

/// The grid along an axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// 0: slabs are columns; 1: rows.
    pub axis: u32,
    pub lattice: Lattice,
    /// Slabs of cells, and rows of a slab.
    pub cells: [usize; 2],
    /// The first entry of each level, from the second on, in the table of cones.
    pub cones: Vec<u32>,
    /// The first word of the cell bits.
    pub cell_bits: u32,
}

/// A planned dispatch, before it is bound.
#[derive(Debug)]
pub struct PlannedWork {
    pub work: Work,
    /// The lowest level, and the one that intervals are extended to.
    pub levels: [u32; 2],
    /// The step of its sweeps.
    pub step: u32,
    pub groups: [u32; 3],
    pub traffic: Traffic,
}

/// A quadrant's part of a dispatch.
#[derive(Clone, Copy, Debug)]
struct Part {
    work: Work,
    levels: [u32; 2],
    sweep: Sweep,
    groups: [u32; 3],
}

impl Part {
    /// The order in which quadrants that share dispatches do their work: upwards, then downwards through the levels.
    /// Parts that are equal in it can share one.
    fn order(&self) -> (Work, [i64; 2]) {
        let levels = self.levels.map(i64::from);
        (self.work, if self.work.is_merge() { levels.map(|level| -level) } else { levels })
    }
}

/// Returns the workgroups of a dispatch that parts share: along each dimension, as many as any of them needs.
fn groups(parts: &[Part]) -> [u32; 3] {
    let most = |i: usize| parts.iter().map(|part| part.groups[i]).max().unwrap_or(0);
    [most(0), most(1), parts.len() as u32 * most(2)]
}

/// Returns whether a part fits to others: of the workgroups of a dispatch that they share, at least half have work.
fn fit(parts: &[Part], part: &Part) -> bool {
    let count = |groups: [u32; 3]| groups.map(u64::from).iter().product::<u64>();
    let together = [parts, &[*part]].concat();
    let own: u64 = together.iter().map(|part| count(part.groups)).sum();
    count(groups(&together)) <= 2 * own
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
    /// Words of an interval.
    words: u32,
    /// Pixels gather the first moment too.
    moment: bool,
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
        words: u32,
        moment: bool,
        together: usize,
    ) -> Self {
        let Footprints { bundles, views, .. } = *footprints;
        let (cones, sweeps, parts) = (cones.entries(), Vec::new(), Vec::new());
        Self { geometry, bundles, views, cones, words, moment, together, sweeps, parts }
    }

    /// The sweeps of all dispatches planned so far.
    pub fn sweeps(&self) -> &[Together] {
        &self.sweeps
    }

    /// Plans a gather of light from all sides. `indirect`: with scattered radiance; `all`: for all pixels, else
    /// for faces and media only.
    pub fn gather(&mut self, axes: &[Axis], indirect: bool, all: bool) -> Vec<PlannedWork> {
        // Both axes have their bits from one dispatch, along x.
        if let Some(axis) = axes.first() {
            let [width, height] = axis.cells;
            let groups = [width.div_ceil(64), height.div_ceil(32), 1];
            self.push(Work::Slabs, self.sweep(axis, indirect), groups);
        }
        let slabs = [std::mem::take(&mut self.parts)];
        let mut quadrants = Vec::new();
        let (mut intervals, mut light) = (Vec::new(), [0; 2]);
        for axis in axes {
            let sweep = self.sweep(axis, indirect);
            for reversed in [0, 1] {
                let turn = 2 * axis.axis + reversed;
                let sky = ConeTable::light_of(self.cones, axis.axis, reversed);
                if quadrants.len() % self.together == 0 {
                    (intervals, light) = (vec![0; u32::BITS as usize], [0; 2]);
                }
                let lattice = axis.lattice.after(&intervals, light);
                let placed = Axis { lattice, ..axis.clone() };
                self.quadrant(&placed, Sweep { reversed, turn, sky, ..sweep }, all);
                let held = &axis.lattice.intervals;
                intervals.iter_mut().zip(held).for_each(|(place, held)| *place += held);
                light = [light[0] + axis.lattice.radiance, light[1] + axis.lattice.shown];
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
        while let Some(next) = left.iter().filter_map(|parts| Some(parts.first()?.order())).min() {
            let mut parts = Vec::new();
            for left in &mut left {
                if let Some((part, rest)) = left.split_first()
                    && part.order() == next
                    && (parts.is_empty() || part.work.is_apart() && fit(&parts, part))
                {
                    parts.push(*part);
                    *left = rest;
                }
            }
            planned.push(self.plan(&parts));
        }
        planned
    }

    fn plan(&mut self, parts: &[Part]) -> PlannedWork {
        let Part { work, levels, .. } = parts[0];
        let quadrants = parts.len() as u32;
        let groups = groups(parts);
        let mut together = [Sweep::default(); QUADRANTS];
        for (sweep, part) in together.iter_mut().zip(parts) {
            *sweep = Sweep { quadrants, ..part.sweep };
        }
        let step = STEPS * self.sweeps.len() as u32;
        self.sweeps.push(together);
        let (words, moment) = (self.words.into(), self.moment);
        let traffic = |part: &Part| traffic(work, &part.sweep, part.groups, words, moment);
        PlannedWork { work, levels, step, groups, traffic: parts.iter().map(traffic).sum() }
    }

    /// The parameters that all dispatches of an axis share.
    fn sweep(&self, axis: &Axis, indirect: bool) -> Sweep {
        let [cell_depth, cell_rows] = axis.cells.map(|side| side as u32);
        Sweep {
            spacing_level: self.geometry.spacing_level,
            cell_depth,
            cell_rows,
            cell_words: cell_rows.div_ceil(32),
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
        self.push_levels(work, [sweep.level; 2], sweep, groups);
    }

    fn push_levels(&mut self, work: Work, levels: [u32; 2], sweep: Sweep, groups: [usize; 3]) {
        let groups = groups.map(|count| count as u32);
        if groups.iter().all(|&count| count > 0) {
            let planes = groups[if work == Work::Trace { 1 } else { 2 }];
            self.parts.push(Part { work, levels, sweep: Sweep { planes, ..sweep }, groups });
        }
    }

    fn quadrant(&mut self, axis: &Axis, sweep: Sweep, all: bool) {
        let lattice = &axis.lattice;
        let mut chain = Chain { held: vec![None; (lattice.end - lattice.chunk) as usize] };
        for chunk in (0..lattice.chunks()).rev() {
            self.trace(axis, sweep, chunk);
            self.extend(lattice, sweep, chunk);
            self.merge_chain(axis, sweep, chunk, &mut chain);
            self.merge(axis, sweep, chunk);
            self.final_gather(axis, sweep, chunk, all);
        }
    }

    /// Plans the first level: all planes of the chunk except the grid's first.
    fn trace(&mut self, axis: &Axis, sweep: Sweep, chunk: usize) {
        let lattice = &axis.lattice;
        let level = lattice.first;
        let all = 1 << (lattice.chunk - level);
        let planes = range(chunk * all, all, planes(lattice.depth, level), 1);
        let sweep = Sweep {
            level,
            first: planes.start as u32,
            odd: lattice.odd(level),
            even: lattice.even(level),
            stored: lattice.first_of(level, chunk),
            footprints: self.bundles,
            ..sweep
        };
        let traced = traced(1 << self.geometry.spacing_level) as usize;
        self.push(Work::Trace, sweep, [axis.cells[1].div_ceil(traced), planes.len(), 1]);
    }

    /// Plans the levels above: those within the chunk, and those that its near end completes.
    fn extend(&mut self, lattice: &Lattice, sweep: Sweep, chunk: usize) {
        for [level, levels] in lattice.groups(lattice.first, lattice.chunk) {
            let above = level + levels;
            // Nothing needs what begins at the grid's near end.
            let all = 1 << (lattice.chunk - above);
            let planes = range(chunk * all, all, planes(lattice.depth, above), 1);
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
        let above = level + levels;
        let sweep = Sweep {
            level,
            first: planes.start as u32,
            odd: lattice.odd(level),
            even: lattice.even(level),
            stored: lattice.first_of(level, chunk),
            odd_top: lattice.odd(above),
            even_top: lattice.even(above),
            stored_top: lattice.first_of(above, chunk),
            ..sweep
        };
        let rays = 2usize << level;
        let (work, rows, width) = match levels {
            1 => (Work::ExtendOnce, LANES, WAVES * WIDTH),
            _ => (Work::Extend, EXTENDED.rows, WIDTH),
        };
        let tiles = lattice.rows.div_ceil(rows as usize);
        let groups = [tiles, rays.div_ceil(width as usize), planes.len()];
        self.push_levels(work, [level, above], sweep, groups);
    }

    /// Plans light at the far end of the chunk, from that at the planes of higher levels behind it.
    fn merge_chain(&mut self, axis: &Axis, sweep: Sweep, chunk: usize, chain: &mut Chain) {
        for (level, plane) in chain.missing(&axis.lattice, chunk + 1) {
            let sweep = Sweep {
                first: plane as u32,
                far: plane.div_ceil(2) as u32,
                stored: plane as u32 / 2,
                below_far: plane as u32,
                ..sweep
            };
            self.merge_group(axis, sweep, [level, 1], 1);
        }
    }

    /// Plans light at all planes of the chunk, down to the level that pixels gather from.
    fn merge(&mut self, axis: &Axis, sweep: Sweep, chunk: usize) {
        let lattice = &axis.lattice;
        let (first, depth) = (lattice.first, lattice.depth);
        for [level, levels] in lattice.groups(first + 2, lattice.chunk).rev() {
            // From behind the near end of the chunk to its far end. Two levels are made from planes between them.
            let all = 1 << (lattice.chunk - level - levels + 1);
            let end = planes(depth, level) / levels as usize + levels as usize - 1;
            let made = range(chunk * all + 1, all, end, 1);
            let sweep = Sweep {
                first: made.start as u32,
                far: lattice.last_of_light(level + levels, chunk) as u32,
                stored: lattice.first_of(level, chunk),
                below_far: lattice.last_of_light(level, chunk) as u32,
                ..sweep
            };
            self.merge_group(axis, sweep, [level, levels], made.len());
        }
        let all = 1 << (lattice.chunk - first - 1);
        let between = range(chunk * all + 1, all, planes(depth, first) / 2 + 1, 1);
        // The smallest grids have no level above these two.
        let above = (first + 2).min(lattice.end);
        let sweep = Sweep {
            level: first,
            first: between.start as u32,
            far: lattice.last_of_light(above, chunk) as u32,
            odd: lattice.odd(first),
            even: lattice.even(first),
            stored: lattice.first_of(first, chunk),
            cones_above: axis.cones(above),
            cones_between: axis.cones(first + 1),
            above: lattice.light(above),
            between: lattice.light(first + 1),
            below: lattice.light(first),
            below_far: 2 * lattice.last_of_light(first + 1, chunk) as u32,
            ..sweep
        };
        let blocks = shown(first + 1).div_ceil((WAVES * LINES_LAST) as usize);
        self.push(Work::Finish, sweep, [merged_tiles(lattice, first), blocks, between.len()]);
    }

    /// Plans light at some planes of the lowest level of a group, or of the one above it if there are two.
    fn merge_group(&mut self, axis: &Axis, sweep: Sweep, [level, levels]: [u32; 2], planes: usize) {
        let lattice = &axis.lattice;
        let above = level + levels;
        let sweep = Sweep {
            level,
            odd: lattice.odd(level),
            even: lattice.even(level),
            above: lattice.light(above),
            below: lattice.light(level),
            cones_above: axis.cones(above),
            cones_between: axis.cones(level + 1),
            ..sweep
        };
        if levels == 1 {
            let rows = lattice.rows.div_ceil(LANES as usize);
            let runs = cones(level).div_ceil(RUN as usize);
            self.push(Work::MergeOnce, sweep, [rows, runs, planes]);
        } else {
            let blocks = cones(level).div_ceil(BLOCK as usize);
            self.push(Work::Merge, sweep, [merged_tiles(lattice, level), blocks, planes]);
        }
    }

    /// The parameters of dispatches that gather from the first level.
    fn gathered(&self, axis: &Axis, sweep: Sweep, chunk: usize) -> Sweep {
        let lattice = &axis.lattice;
        let level = lattice.first;
        let far = lattice.last_of_light(level + 1, chunk) as u32;
        Sweep {
            level,
            far,
            above: lattice.light(level + 1),
            below: lattice.light(level),
            cones_above: axis.cones(level + 1),
            footprints: self.views,
            rays: self.geometry.rays,
            ..sweep
        }
    }

    /// Plans the final gather of the pixels whose plane lies in the chunk.
    fn final_gather(&mut self, axis: &Axis, sweep: Sweep, chunk: usize, all: bool) {
        let lattice = &axis.lattice;
        let px = lattice.chunk + self.geometry.spacing_level;
        let near = |chunk: usize| (chunk << px).saturating_sub(self.geometry.min_length - 1);
        let from = if chunk == 0 { 0 } else { near(chunk) };
        let last = chunk + 1 == lattice.chunks();
        let [depth, rows] = axis.cells;
        let to = if last { depth } else { near(chunk + 1) };
        let blocks = GatherTile::new(self.geometry).blocks(self.geometry, from..to);
        let sweep = Sweep { first: blocks.start as u32, ..self.gathered(axis, sweep, chunk) };
        let groups = [rows.div_ceil(TILE as usize), blocks.len(), 1];
        self.push(if all { Work::Gather } else { Work::Faces }, sweep, groups);
    }
}

impl Axis {
    /// The first entry of a level, from the second on, in the table of cones.
    fn cones(&self, level: u32) -> u32 {
        self.cones[(level - self.lattice.first - 1) as usize]
    }
}

/// The tiles of workgroups that merge two levels, from `level` up. They are slanted by as many rows as its rays.
fn merged_tiles(lattice: &Lattice, level: u32) -> usize {
    let slant = (1 << level) + BLOCK as usize;
    (lattice.rows + slant).div_ceil(MERGED.rows as usize)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_share_a_dispatch_if_at_least_half_of_its_workgroups_have_work() {
        let part = |groups| {
            let sweep = Sweep::default();
            Part { work: Work::Trace, levels: [2; 2], sweep, groups }
        };
        // Of a grid of 1920×1080 along both axes, and of one of 4096×16.
        let [wide, high] = [part([19, 479, 1]), part([33, 269, 1])];
        let [long, thin] = [part([1, 1023, 1]), part([67, 3, 1])];
        assert_eq!(groups(&[wide, wide, high]), [33, 479, 3]);
        assert!(fit(&[], &wide) && fit(&[wide], &wide));
        assert!(fit(&[wide, wide], &high) && fit(&[wide, wide, high], &high));
        assert!(fit(&[long], &long));
        assert!(!fit(&[long, long], &thin));
    }
}
