//! The traffic of the dispatches of a quadrant: everything that a dispatch reads or writes, once.

use super::lattice::Packed;
use super::sweep::Sweep;
use super::work::Work;
use crate::stages::bounce::FACES;
use crate::traffic::Traffic;
use lamplight::internals::holographic::PRIMARY;
use lamplight::internals::holographic::lattice::{cones, planes};

/// Bytes of a word, of packed radiance, and of a texel or of light.
const WORD: u64 = size_of::<u32>() as u64;
const PACKED: u64 = size_of::<Packed>() as u64;
const VEC4: u64 = size_of::<[f32; 4]>() as u64;

/// The bits of a cell, as `slabs.wgsl` writes them.
pub const BITS: u32 = PRIMARY.trailing_zeros() + 1;

/// Returns the traffic of a dispatch, with intervals of `words`.
pub fn traffic(work: Work, sweep: &Sweep, groups: [u32; 3], words: u64) -> Traffic {
    let Sweep { level, levels, .. } = *sweep;
    let [rows, level_size] = [u64::from(sweep.rows), 1 << level];
    let [_, across, deep] = groups.map(u64::from);
    let interval = words * WORD;
    // Bits of the cells near a row: 128 rows for a tile of 64, four bits each, in `slabs` slabs.
    let bits = |slabs: u64| 4 * slabs * rows * 2 / 8;
    match work {
        Work::Slabs => {
            // The first axis also clears irradiance.
            let faces = if sweep.axis == 0 { FACES * PACKED } else { 0 };
            let cells = u64::from(sweep.depth) * rows;
            Traffic { read: cells * VEC4, written: cells * u64::from(BITS) / 8 + cells * faces }
        }
        Work::Trace => Traffic {
            read: across * bits(level_size + 2),
            written: across * (2 * level_size + 1) * rows * interval,
        },
        Work::ExtendOnce | Work::Extend => {
            // All planes of the lowest level; of those above the ones of odd index, of the topmost all.
            // A ray of the lowest level is as many of a higher one as that is levels up.
            let written: u64 =
                (1..=levels).map(|up| (1u64 << (levels - up)).div_ceil(2) << up).sum();
            let [read, written] =
                [1 << levels, written].map(|rays| 2 * level_size * deep * rays * rows * interval);
            Traffic { read, written }
        }
        Work::Merge => {
            let first = u64::from(sweep.first);
            let last = first + deep - 1;
            let odd = last.div_ceil(2) - first / 2;
            // Beyond the last plane there is sky, which is not stored.
            let end = planes(sweep.depth as usize, level + 1) as u64;
            let stored = (last.div_ceil(2) + 1).min(end).saturating_sub(first.div_ceil(2));
            let near = odd * (2 * level_size + 1) * rows * interval;
            let light = |level: u32, planes: u64| planes * cones(level) as u64 * rows * PACKED;
            Traffic { read: near + light(level + 1, stored), written: light(level, deep) }
        }
        Work::Finish => {
            // Each ray serves two cones; the outermost have no light.
            let cones = cones(level + 1) as u64 - 2;
            Traffic {
                read: deep * rows * (cones * PACKED + across * interval),
                written: deep * rows * cones * PACKED,
            }
        }
        Work::Gather => {
            // Slabs share the planes ahead of them.
            let ahead = |slab: u32| (slab + sweep.gather_length).div_ceil(1 << level);
            let last = sweep.first + groups[1] - 1;
            let end = planes(sweep.depth as usize, level) as u32;
            let planes = (ahead(last) + 1).min(end).saturating_sub(ahead(sweep.first));
            let light = u64::from(planes) * cones(level + 1) as u64 * PACKED;
            let before = if sweep.first_quadrant == 1 { 0 } else { across * VEC4 };
            Traffic {
                read: across * bits(2 * level_size) + rows * (light + before),
                written: across * rows * VEC4,
            }
        }
        Work::Faces => Traffic { read: across * bits(2 * level_size), written: 0 },
    }
}

/// Returns the traffic of showing the light of faces: all cells are searched for solid ones.
pub fn of_shown_faces(cells: u64) -> Traffic {
    Traffic { read: cells * VEC4, written: 0 }
}
