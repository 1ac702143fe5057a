//! Workgroups that fuse two levels, of intervals (extend.wgsl) or of light (merge.wgsl): their tiles, and what they
//! hold in workgroup memory.
//!
//! A lane is a row. Rays that spread and bend need rows beside the tile, which the next tile makes again.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fit_into_the_memory_of_workgroups() {
        let most = wgpu::Limits::default().max_compute_workgroup_storage_size;
        let pair = size_of::<[u32; 2]>() as u32;
        for pairs in [held_pairs(2), held_pairs(3), (2 * BLOCK + 6) * LANES] {
            assert!(pairs * pair + 16 <= most, "{pairs} pairs");
        }
        const { assert!(WAVES * LINES_LAST <= 2 * BLOCK + 6) };
    }
}
