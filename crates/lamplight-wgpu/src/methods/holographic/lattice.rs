//! The levels of a quadrant, and where they lie in memory.
//!
//! A quadrant is swept in chunks of 2^t slabs from the far end of the grid to the near one, in the direction of
//! light. Of the levels up to t all planes of a chunk are stored, of each level above only one: of intervals
//! the plane of odd index made last, of light the one that is needed. So smaller chunks take less memory and
//! more dispatches.

use lamplight::internals::holographic::lattice::{cones, levels, planes, rays};

/// Rows of a workgroup that gathers.
pub const TILE: u32 = 64;
/// Rows that a workgroup traces and stores; it traces one more to each side.
pub const TRACED: u32 = TILE - 2;
/// The packed radiance of a cone or a face.
pub type Packed = [u32; 2];

/// The grid of a quadrant and its opposite.
#[derive(Debug)]
pub struct Lattice {
    pub depth: usize,
    pub rows: usize,
    /// The level that is traced, and the first level that is not made.
    pub first: u32,
    pub end: u32,
    /// A chunk is 2^chunk slabs.
    pub chunk: u32,
    /// Levels in a group.
    fused: u32,
    odd: Vec<u64>,
    even: [u64; 2],
    /// The number of all intervals.
    pub intervals: u64,
    /// The places of the light of levels in a chunk, in turns, and of each level from `chunk` on.
    turns: [u64; 2],
    chain: Vec<u64>,
    /// Entries of all light.
    pub radiance: u64,
}

impl Lattice {
    /// Lays out a grid of `depth` slabs. Chunks are halved `halvings` times.
    pub fn new([depth, rows]: [usize; 2], first: u32, fused: u32, halvings: u32) -> Self {
        let end = levels(depth, first);
        let chunk = end.saturating_sub(halvings).max(first + 1);
        let mut lattice = Self {
            depth,
            rows,
            first,
            end,
            chunk,
            fused,
            odd: Vec::new(),
            even: [0; 2],
            intervals: 0,
            turns: [0; 2],
            chain: Vec::new(),
            radiance: 0,
        };
        lattice.lay_out();
        lattice
    }

    fn lay_out(&mut self) {
        let mut even = [0; 2];
        for level in self.first..self.end {
            let held = self.held(level) * self.plane(level);
            self.odd.push(self.intervals);
            self.intervals += held;
            // The first plane is only needed by its pixels.
            if planes(self.depth, level) > 2 {
                let even = &mut even[self.turn(level)];
                *even = held.max(*even);
            }
        }
        self.even = [self.intervals, self.intervals + even[0]];
        self.intervals += even[0] + even[1];
        let light = |level: u32| self.planes_of_light(level) * cones(level) * self.rows;
        let all = (self.first + 1..=self.chunk).map(light).max().unwrap_or(0) as u64;
        self.turns = [0, all];
        self.radiance = 2 * all;
        for level in self.chunk..self.end {
            self.chain.push(self.radiance);
            self.radiance += (cones(level) * self.rows) as u64;
        }
    }

    /// The place, of two, for planes of even index of a level. Neighbouring groups use different places.
    fn turn(&self, level: u32) -> usize {
        let of_group = |level: u32| (level - self.first).div_ceil(self.fused);
        let groups = match level.checked_sub(self.chunk) {
            Some(above) => of_group(self.chunk) + above,
            None => of_group(level),
        };
        groups as usize % 2
    }

    /// Intervals of a plane.
    fn plane(&self, level: u32) -> u64 {
        rays(level) as u64 * self.rows as u64
    }

    /// The number of planes of odd index, or of even index, of a level that are stored at a time.
    fn held(&self, level: u32) -> u64 {
        let all = planes(self.depth, level).div_ceil(2) as u64;
        let of_chunk = 1 << self.chunk.saturating_sub(level + 1);
        of_chunk.min(all)
    }

    /// The number of planes of a level whose light a chunk stores.
    fn planes_of_light(&self, level: u32) -> usize {
        self.last_of_light(level, 0).min(1 << (self.chunk - level))
    }

    /// The plane of a level, up to that of chunks, that a chunk stores light of first: its far end, or what follows
    /// the last plane of the grid.
    pub fn last_of_light(&self, level: u32, chunk: usize) -> usize {
        ((chunk + 1) << (self.chunk - level)).min(planes(self.depth, level))
    }

    /// Returns whether chunks are as small as they can be.
    pub fn is_smallest(&self) -> bool {
        self.chunk == self.first + 1
    }

    pub fn chunks(&self) -> usize {
        planes(self.depth, self.chunk)
    }

    /// Groups of levels from one to another: the lowest level, and the number of further ones.
    pub fn groups(&self, from: u32, top: u32) -> impl DoubleEndedIterator<Item = [u32; 2]> {
        let fused = self.fused;
        let count = top.saturating_sub(from).div_ceil(fused);
        (0..count).map(move |i| [from + i * fused, fused.min(top - from - i * fused)])
    }

    /// The first interval of planes of odd index of a level; 0 above the last level.
    pub fn odd(&self, level: u32) -> u32 {
        self.odd.get((level - self.first) as usize).map_or(0, |&at| at as u32)
    }

    /// The first interval of planes of even index of a level.
    pub fn even(&self, level: u32) -> u32 {
        self.even[self.turn(level)] as u32
    }

    /// Half the index of the first plane of a level that is stored in a chunk.
    pub fn first_of(&self, level: u32, chunk: usize) -> u32 {
        match self.chunk.checked_sub(level + 1) {
            Some(shift) => (chunk << shift) as u32,
            // One plane: that at the chunk's near end.
            None => (chunk >> (level - self.chunk + 1)) as u32,
        }
    }

    /// The place of the light of a level. Neighbouring levels use different places.
    pub fn light(&self, level: u32) -> u32 {
        if let Some(above) = level.checked_sub(self.chunk) {
            return self.chain.get(above as usize).map_or(0, |&at| at as u32);
        }
        self.turns[(level - self.first) as usize % 2] as u32
    }
}
