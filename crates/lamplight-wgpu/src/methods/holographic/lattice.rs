//! The levels of a quadrant, and where they lie in memory.
//!
//! A quadrant is swept in chunks of 2^t slabs from the far end of the grid to the near one, in the direction of
//! light. Below level t all planes of a chunk are stored, except those of levels inside a group, which never are. At t and
//! above one plane per level is stored: for intervals the one of odd index made last, for light the one that is needed. So
//! smaller chunks take less memory and more dispatches. The light that pixels gather
//! lies in buffers of intervals that nothing reads any more by then.

use lamplight::internals::holographic::lattice::{cones, levels, planes, rays};

/// Rows of a workgroup that gathers.
pub const TILE: u32 = 64;
/// Rows of cells that a workgroup traces and stores, if so many share a point of the lattice; it traces those of one
/// more point to each side.
pub const fn traced(spacing: u32) -> u32 {
    TILE - 2 * spacing
}
/// Cones of a level that pixels gather from: the outermost have no light.
pub const fn shown(level: u32) -> usize {
    cones(level) - 2
}
/// The packed radiance of a face.
pub type Packed = [u32; 2];
/// The packed radiance of two cones beside each other, a word in each of three rows.
pub type PackedPair = [u32; 3];
/// The words of the light of an even number of cones at a point.
pub const fn light_words(cones: usize) -> u64 {
    (cones / 2 * size_of::<PackedPair>() / size_of::<u32>()) as u64
}

/// The lattice of a quadrant and its opposite, `depth` × `rows` points.
#[derive(Clone, Debug)]
pub struct Lattice {
    pub depth: usize,
    pub rows: usize,
    /// The level that is traced, and the first level that is not made.
    pub first: u32,
    pub end: u32,
    /// A chunk is 2^chunk points deep.
    pub chunk: u32,
    /// Levels in a group.
    fused: u32,
    /// The first interval of each level's planes of odd index, and of even index; levels have a buffer each.
    odd: Vec<u64>,
    even: Vec<u64>,
    /// The number of each level's intervals.
    pub intervals: Vec<u64>,
    /// The places of the light of levels in a chunk, in turns, and of each level from `chunk` on.
    turns: [u64; 2],
    chain: Vec<u64>,
    /// Words of that light.
    pub radiance: u64,
    /// The place, and the words, of the light that pixels gather: on planes of odd index, and on those of even index.
    shown_at: u64,
    pub shown: u64,
}

impl Lattice {
    /// Lays out a lattice of `depth` × `rows` points. Chunks are halved `halvings` times.
    pub fn new([depth, rows]: [usize; 2], first: u32, fused: u32, halvings: u32) -> Self {
        let end = levels(depth, first);
        let chunk = end.saturating_sub(halvings).max(first + 2).min(end);
        let mut lattice = Self {
            depth,
            rows,
            first,
            end,
            chunk,
            fused,
            odd: Vec::new(),
            even: Vec::new(),
            intervals: Vec::new(),
            turns: [0; 2],
            chain: Vec::new(),
            radiance: 0,
            shown_at: 0,
            shown: 0,
        };
        lattice.lay_out();
        lattice
    }

    fn lay_out(&mut self) {
        for level in self.first..self.end {
            let [odd, even] = [true, false].map(|odd| self.held(level, odd));
            // The grid's first plane is only needed by its pixels, which it would be stored before.
            let missing = u64::from(self.chunks() == 1 && even > 0);
            let plane = self.plane(level);
            self.odd.push(0);
            self.even.push((odd - missing) * plane);
            self.intervals.push((odd + even - missing) * plane);
        }
        // Planes of odd index have as many cones as those of even index, of the level above.
        let planes = self.planes_of_light(self.first + 1);
        self.shown = planes as u64 * light_words(shown(self.first + 1)) * self.rows as u64;
        for turn in 0..self.turns.len() {
            self.turns[turn] = self.radiance;
            let levels = (self.first + 2..self.chunk).filter(|&level| self.turn(level) == turn);
            let light = levels.map(|level| self.light_of(level)).max();
            self.radiance += light.unwrap_or(0);
        }
        for level in self.chunk..self.end {
            self.chain.push(self.radiance);
            self.radiance += light_words(cones(level)) * self.rows as u64;
        }
    }

    /// Returns whether intervals of a level are stored.
    fn is_stored(&self, level: u32) -> bool {
        level >= self.chunk || (level - self.first).is_multiple_of(self.fused)
    }

    /// The place, of two, of the light of a level in a chunk. Neighbouring groups use different places.
    fn turn(&self, level: u32) -> usize {
        ((level - self.first - 2) / self.fused % 2) as usize
    }

    /// Intervals of a plane.
    fn plane(&self, level: u32) -> u64 {
        rays(level) as u64 * self.rows as u64
    }

    /// The number of planes of odd index, or of even index, of a level that are stored at a time.
    fn held(&self, level: u32, odd: bool) -> u64 {
        if !self.is_stored(level) {
            return 0;
        }
        let all = planes(self.depth, level);
        // The first plane alone is not needed.
        let even = if all > 2 { all.div_ceil(2) } else { 0 };
        let of_chunk = 1 << self.chunk.saturating_sub(level + 1);
        of_chunk.min(if odd { all / 2 } else { even } as u64)
    }

    /// The number of planes of a level whose light a chunk stores.
    fn planes_of_light(&self, level: u32) -> usize {
        self.last_of_light(level, 0).min(1 << (self.chunk - level))
    }

    /// Words of the light of a level that a chunk stores.
    fn light_of(&self, level: u32) -> u64 {
        self.planes_of_light(level) as u64 * light_words(cones(level)) * self.rows as u64
    }

    /// Places the lattice in buffers after others, whose intervals of each level and light come first.
    pub fn after(&self, intervals: &[u64], [radiance, shown]: [u64; 2]) -> Self {
        let moved = |places: &[u64]| places.iter().zip(intervals).map(|(at, by)| at + by).collect();
        Self {
            odd: moved(&self.odd),
            even: moved(&self.even),
            turns: self.turns.map(|at| at + radiance),
            chain: self.chain.iter().map(|at| at + radiance).collect(),
            shown_at: self.shown_at + shown,
            ..self.clone()
        }
    }

    /// The plane of a level, up to that of chunks, that a chunk stores light of first: its far end, or what follows
    /// the last plane of the grid.
    pub fn last_of_light(&self, level: u32, chunk: usize) -> usize {
        // The level that pixels gather from has a last plane beyond that of the level above.
        let beyond = usize::from(level == self.first + 1);
        ((chunk + 1) << (self.chunk - level)).min(planes(self.depth, level) - 1 + beyond)
    }

    /// Returns whether chunks are as small as they can be.
    pub fn is_smallest(&self) -> bool {
        self.chunk <= self.first + 2
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

    /// Likewise of planes of even index.
    pub fn even(&self, level: u32) -> u32 {
        self.even.get((level - self.first) as usize).map_or(0, |&at| at as u32)
    }

    /// Half the index of the first plane of a level that is stored in a chunk.
    pub fn first_of(&self, level: u32, chunk: usize) -> u32 {
        match self.chunk.checked_sub(level + 1) {
            Some(shift) => (chunk << shift) as u32,
            // One plane: that at the chunk's near end.
            None => (chunk >> (level - self.chunk + 1)) as u32,
        }
    }

    /// The place of the light of a level.
    pub fn light(&self, level: u32) -> u32 {
        if let Some(above) = level.checked_sub(self.chunk) {
            return self.chain.get(above as usize).map_or(0, |&at| at as u32);
        }
        match level - self.first {
            0 | 1 => self.shown_at as u32,
            _ => self.turns[self.turn(level)] as u32,
        }
    }
}
