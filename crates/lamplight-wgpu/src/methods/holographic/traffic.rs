//! The traffic of the dispatches of a quadrant: everything that a dispatch reads or writes, once.

use super::lattice::{Packed, light_words, shown};
use super::sweep::{LAST_TURN, Sweep};
use super::tiles::WAVES;
use super::work::Work;
use crate::traffic::Traffic;
use lamplight::internals::holographic::PRIMARY;
use lamplight::internals::holographic::lattice::{cones, planes};

/// Bytes of a word, of packed radiance, and of a texel or of light.
const WORD: u64 = size_of::<u32>() as u64;
const PACKED: u64 = size_of::<Packed>() as u64;
const VEC4: u64 = size_of::<[f32; 4]>() as u64;

/// The bits of a cell, as `slabs.wgsl` writes them.
pub const BITS: u32 = PRIMARY.trailing_zeros() + 1;

/// Returns the traffic of a dispatch, with intervals of `words`. `moment`: pixels gather the first moment too.
pub fn traffic(work: Work, sweep: &Sweep, groups: [u32; 3], words: u64, moment: bool) -> Traffic {
    let level = sweep.level;
    let [rows, level_size] = [u64::from(sweep.rows), 1 << level];
    let [_, across, deep] = groups.map(u64::from);
    let interval = words * WORD;
    // Bits of the cells near a row: 128 rows for a tile of 64, four bits each, in `slabs` slabs.
    let cell_rows = u64::from(sweep.cell_rows);
    let bits = |slabs: u64| 4 * slabs * cell_rows * 2 / 8;
    // From a plane to the next, px.
    let apart = level_size << sweep.spacing_level;
    // Slabs of a workgroup that gathers, and the bits that it reads.
    let depth = WAVES.min(apart as u32);
    let near = bits(apart + u64::from(sweep.gather_length) + 1);
    let light_of = |level: u32, planes: u64| planes * light_words(cones(level)) * rows * WORD;
    // The light of a level that leads to the planes from one to another of the level below. Beyond the last plane there is
    // sky, which is not stored.
    let stored = |level: u32, first: u64, last: u64| {
        let end = planes(sweep.depth as usize, level) as u64;
        let held = (last.div_ceil(2) + 1).min(end).saturating_sub(first.div_ceil(2));
        light_of(level, held)
    };
    match work {
        Work::Slabs => {
            let cells = u64::from(sweep.cell_depth) * cell_rows;
            Traffic { read: cells * VEC4, written: 2 * cells * u64::from(BITS) / 8 }
        }
        Work::Trace => Traffic {
            read: across * bits(apart + 2),
            written: across * (2 * level_size + 1) * rows * interval,
        },
        Work::ExtendOnce | Work::Extend => {
            // All planes of the lowest level, and of the topmost.
            let levels = if work == Work::Extend { 2 } else { 1 };
            let rays = |level: u32| (2 << level) + 1;
            let [read, written] = [(deep << levels) * rays(level), deep * rays(level + levels)];
            let [read, written] = [read, written].map(|rays| rays * rows * interval);
            Traffic { read, written }
        }
        Work::MergeOnce => {
            let first = u64::from(sweep.first);
            let last = first + deep - 1;
            let odd = last.div_ceil(2) - first / 2;
            let near = odd * (2 * level_size + 1) * rows * interval;
            let light = stored(level + 1, first, last) + near;
            Traffic { read: light, written: light_of(level, deep) }
        }
        Work::Merge | Work::Finish => {
            // From a plane between of odd index, intervals of the lowest level lead from the plane before, from it
            // and from the next; from one of even index only those from the plane before are read.
            let [first, last] = [u64::from(sweep.first), u64::from(sweep.first) + deep - 1];
            let end = planes(sweep.depth as usize, level) as u64;
            let odd = |q: &u64| q % 2 == 1;
            let read = (first..=last).map(|q| {
                let next = if odd(&q) { 2 * q + 1 } else { 2 * q - 1 };
                // The plane before one of even index was read already.
                let from = if odd(&q) || q == first { 2 * q - 1 } else { 2 * q };
                (next + 1).min(end).saturating_sub(from)
            });
            let near = read.sum::<u64>() * (2 * level_size + 1) * rows * interval;
            let made = (2 * first - 1..=2 * last).filter(|&p| p < end);
            let written = if work == Work::Merge {
                light_of(level, made.count() as u64)
            } else {
                // Those of odd index have as many cones as the level above.
                let above = planes(sweep.depth as usize, level + 1) as u64;
                let planes =
                    made.filter(odd).count() + (first..=last).filter(|&q| q < above).count();
                planes as u64 * light_words(shown(level + 1)) * rows * WORD
            };
            Traffic { read: near + stored(level + 2, first, last), written }
        }
        Work::Gather => {
            // Slabs share the planes ahead of them.
            let from = (depth * sweep.first + 1).saturating_sub(sweep.gather_length);
            let to = depth * (sweep.first + groups[1]) + 1 - sweep.gather_length;
            let to = to.min(sweep.cell_depth);
            let slabs = u64::from(to - from);
            let ahead = |slab: u32| (slab + sweep.gather_length).div_ceil(apart as u32);
            let end = planes(sweep.depth as usize, level) as u32;
            let planes = (ahead(to - 1) + 1).min(end).saturating_sub(ahead(from));
            let light = u64::from(planes) * light_words(shown(level + 1)) * WORD;
            let pixels = slabs * cell_rows;
            let moment = if moment { 2 * VEC4 } else { 0 };
            let before = if sweep.turn == 0 { 0 } else { PACKED + moment };
            let now = moment + if sweep.turn == LAST_TURN { VEC4 } else { PACKED };
            Traffic { read: across * near + rows * light + pixels * before, written: pixels * now }
        }
        Work::Faces => Traffic { read: across * near, written: 0 },
    }
}

/// Returns the traffic of showing the light of faces: the bits of all cells are searched for solid ones, and those for
/// media where there is matter.
pub fn of_shown_faces(cells: u64) -> Traffic {
    Traffic { read: cells / 8, written: 0 }
}
