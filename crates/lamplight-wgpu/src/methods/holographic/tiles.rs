//! Workgroups that fuse two levels, of intervals (extend.wgsl) or of light (merge.wgsl): their tiles, and what they
//! hold in workgroup memory.
//!
//! A lane is a row. Rays that spread and bend need rows beside the tile, which the next tile makes again.

use super::lattice::{TILE, shown};
use lamplight::internals::holographic::lattice::GatherGeometry;
use std::ops::Range;

/// Lanes of a row of invocations: as many as waves of most GPUs have.
pub const LANES: u32 = 64;
/// Rows of invocations. They share the rays or cones of a group, or each has a ray of its own if a dispatch makes one
/// level of intervals.
pub const WAVES: u32 = 4;

/// A tile of rows.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    /// Lanes before it.
    pub before: u32,
    pub rows: u32,
}

impl Tile {
    const fn new(before: u32, after: u32) -> Self {
        Self { before, rows: LANES - before - after }
    }
}

/// Rays of the lowest level from one group of intervals to the next.
pub const WIDTH: u32 = 2;
/// The tile of intervals. A path that bends away from it needs a row before, and rays spread to rows after it.
pub const EXTENDED: Tile = Tile::new(1, 2 * WIDTH);

/// Intervals of the level between that a workgroup holds: two planes, with a ray more to both sides for paths that bend.
pub const HELD: u32 = 2 * (2 * WIDTH + 2) * LANES;

/// Pairs of words in workgroup memory, of intervals of `words`: one array, because browsers count each array as up
/// to 16 bytes more.
pub const fn held_pairs(words: u32) -> u32 {
    HELD * words.div_ceil(2)
}

/// Cones of the lower level that a workgroup merges light of.
pub const BLOCK: u32 = 12;
/// Lines of light that a wave makes: a cone of the level between each, from all rows. The block's and three to each side
/// are just few enough for the workgroup memory of browsers.
pub const LINES: u32 = (2 * BLOCK + 6).div_ceil(WAVES);
/// Lines for the level that pixels gather from: one workgroup makes all of `default`.
pub const LINES_LAST: u32 = 5;
/// The tile of light. Lines of a run are slanted alike, and up to three rows less or more than a ray.
pub const MERGED: Tile = Tile::new(3, 3);

/// Slabs whose bits a tile of the trace or the gather reads: one behind, its own, and those ahead.
pub const SLABS: u32 = 33;

/// A workgroup of the final gather (gather.wgsl): slabs that look at the same plane, and the light of it that is held in
/// workgroup memory at a time.
#[derive(Clone, Copy, Debug)]
pub struct GatherTile {
    /// Slabs of a workgroup.
    pub depth: u32,
    /// Cones whose light is held at a time: pairs, as it is stored.
    pub cones: u32,
    /// Rows of the plane, and those before the first of the tile.
    pub rows: u32,
    pub before: u32,
}

impl GatherTile {
    /// Workgroup memory, bytes: less than browsers grant, so that more workgroups share a processor. On an NVIDIA H100 a
    /// gather of `default` takes 9 % less time than with all of it.
    const MEMORY: u32 = 12288;
    /// All that browsers grant: used if it holds all cones at once, or for the fewest cones that are worth a round.
    const MOST_MEMORY: u32 = 16384;
    const FEWEST: u32 = 4;
    /// Bytes of a held light, of the bits of cells near a tile, and of the cones that meet matter, per slab and cone.
    const LIGHT: u32 = 16;
    const NEAR: u32 = 4 * SLABS * 16;
    const MEETS: u32 = 24;
    /// Bytes that are left over, since browsers count each array as up to 16 more.
    const SPARE: u32 = 4 * 16;

    pub fn new(geometry: GatherGeometry) -> Self {
        let depth = WAVES.min(1 << geometry.level);
        let all = shown(geometry.first() + 1) as u32;
        // A ray reads the rows beside its end.
        let cones = geometry.cones(geometry.max_length());
        let rays = cones.iter().flat_map(|cone| &cone.rays);
        let rise = rays.map(|ray| ray.row.unsigned_abs() as u32).max().unwrap_or(0);
        let before = rise + 1;
        let rows = TILE + 2 * before;
        let others = Self::NEAR + Self::MEETS * depth * all + Self::SPARE;
        let [fit, most] = [Self::MEMORY, Self::MOST_MEMORY]
            .map(|memory| memory.saturating_sub(others) / (Self::LIGHT * rows));
        let at_a_time = if most >= all { all } else { fit.max(Self::FEWEST.min(most)) };
        // As many each time.
        let pairs = all / 2;
        let times = pairs.div_ceil(at_a_time.clamp(2, u32::BITS) / 2);
        Self { depth, cones: 2 * pairs.div_ceil(times), rows, before }
    }

    /// Returns the blocks of slabs that cover some slabs.
    pub fn blocks(&self, geometry: GatherGeometry, slabs: Range<usize>) -> Range<usize> {
        let [depth, behind] = [self.depth as usize, geometry.min_length - 1];
        (slabs.start + behind) / depth..(slabs.end + behind).div_ceil(depth)
    }
}

#[cfg(test)]
mod tests {
    use super::super::quadrant::RUN;
    use super::*;
    use lamplight::settings::Holographic;

    #[test]
    fn the_light_held_for_gathers_fits_into_the_memory_of_workgroups() {
        for level in 1..=4 {
            for (min_length, spacing_level) in
                [(1, 0), (2, 0), (15, 0), (1, 1), (15, 1), (1, 2), (15, 2)]
            {
                let settings = Holographic {
                    gather_level: level,
                    gather_length: min_length,
                    lattice_spacing: 1 << spacing_level,
                    ..Holographic::default()
                };
                let geometry = GatherGeometry::new(&settings);
                let tile = GatherTile::new(geometry);
                let all = shown(geometry.first() + 1) as u32;
                let bytes = GatherTile::NEAR
                    + GatherTile::MEETS * tile.depth * all
                    + GatherTile::LIGHT * tile.cones * tile.rows;
                let most = wgpu::Limits::default().max_compute_workgroup_storage_size;
                assert!(bytes + GatherTile::SPARE <= most, "{settings:?}: {bytes} bytes");
            }
        }
    }

    #[test]
    fn what_rays_of_bundles_meet_fits_into_the_memory_of_workgroups() {
        let most = wgpu::Limits::default().max_compute_workgroup_storage_size;
        // Arrays of trace.wgsl: the bits of cells, what bundles and rays meet, light, and that of rows that share points.
        let others = GatherTile::NEAR + TILE * (2 * 8 + 2 * 16) + 5 * 16;
        for [level, rays] in [[1, 16], [4, 12], [4, 16]] {
            let bundles = lamplight::internals::holographic::lattice::rays(level) as u32;
            let bytes = others + 16 * bundles * (1 + rays);
            assert!(bytes <= most, "level {level}, {rays} rays: {bytes} bytes");
        }
    }

    #[test]
    fn tiles_fit_into_the_memory_of_workgroups() {
        let most = wgpu::Limits::default().max_compute_workgroup_storage_size;
        let pair = size_of::<[u32; 2]>() as u32;
        for pairs in [held_pairs(2), held_pairs(3), (2 * BLOCK + 6) * LANES] {
            assert!(pairs * pair + 16 <= most, "{pairs} pairs");
        }
        const { assert!(WAVES * LINES_LAST <= 2 * BLOCK + 6) };
        // Cones are stored in pairs.
        const {
            assert!(
                (WAVES * LINES_LAST).is_multiple_of(2)
                    && BLOCK.is_multiple_of(4)
                    && RUN.is_multiple_of(2)
            )
        };
    }
}
