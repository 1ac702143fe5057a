//! The grid as the rays of lamps see it, and their way through it from cell edge to cell edge.
//!
//! Cells lie in a frame of "outside", so that a ray knows where it leaves without comparing
//! coordinates. Rows are as long as whole vectors, a cell of the frame to either side.

use super::distance::MARGIN;
use super::seed::is_occupied;
use super::transmittance::log_transmittance;
use crate::{Cells, Rgb};
use fearless_simd::{f32x16, i32x16, mask32x16, prelude::*};
use rayon::prelude::*;

/// Rays that are walked together.
pub const LANES: usize = 16;

/// What a cell is to a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Nothing in the way.
    #[default]
    Clear,
    /// Fog or glass.
    Medium,
    /// Ends the ray.
    Wall,
    /// Beyond the grid.
    Outside,
}

/// The grid in its frame.
#[derive(Debug, Default)]
pub struct Ground {
    size: [i32; 2],
    stride: usize,
    kinds: Vec<Kind>,
    /// Natural logarithm of the transmittance of one px; empty without fog and glass.
    logs: Vec<Rgb>,
}

/// Where a ray ended: how far out, and in which cell of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// px from its start, ∞ where it met nothing.
    pub length: f32,
    /// Index of the wall in the frame, the largest number where it met nothing.
    pub cell: u32,
}

impl Hit {
    /// The ray met nothing.
    pub const NONE: Self = Self { length: f32::INFINITY, cell: u32::MAX };
}

/// Where a ray begins its way through the grid.
#[derive(Clone, Copy)]
struct Start {
    /// Where it enters the grid (0 when it starts inside) and leaves it.
    at: f32,
    leave: f32,
    /// Index of the first cell in the frame.
    index: usize,
    /// The edges that lie ahead of it, to which side, and the step to the cells behind them.
    edge: [f32; 2],
    sign: [f32; 2],
    step: [isize; 2],
    /// 1/direction.
    inverse: [f32; 2],
}

impl Start {
    /// `None` for a ray that misses the grid.
    #[inline(always)]
    fn new(ground: &Ground, from: [f32; 2], direction: [f32; 2]) -> Option<Self> {
        // Never 1/0, so that no edge is 0·∞ px away.
        let inverse = direction.map(|d| 1.0 / d.abs().max(f32::MIN_POSITIVE).copysign(d));
        let [at, leave] = ground.span(from, inverse)?;
        let cell = ground.cell(std::array::from_fn(|a| from[a] + direction[a] * at));
        let ahead = inverse.map(|d| d > 0.0);
        let stride = ground.stride as isize;
        Some(Self {
            at,
            leave,
            index: ground.index(cell),
            edge: std::array::from_fn(|a| cell[a] as f32 + f32::from(ahead[a])),
            sign: ahead.map(|a| if a { 1.0 } else { -1.0 }),
            step: [if ahead[0] { 1 } else { -1 }, if ahead[1] { stride } else { -stride }],
            inverse,
        })
    }
}

impl Ground {
    /// Reads the grid; where nothing is translucent, all that is not empty is a wall.
    pub fn prepare(&mut self, cells: &Cells, translucent: bool) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        self.size = [w as i32, h as i32];
        let stride = w.next_multiple_of(LANES) + 2;
        self.stride = stride;
        self.kinds.resize(stride * (h + 2), Kind::Outside);
        let media = self
            .kinds
            .par_chunks_mut(stride)
            .enumerate()
            .map(|(row, kinds)| {
                kinds.fill(Kind::Outside);
                if row == 0 || row > h {
                    return false;
                }
                let mut media = false;
                for (x, kind) in kinds[1..=w].iter_mut().enumerate() {
                    let i = (row - 1) * w + x;
                    *kind = match () {
                        () if cells.is_solid(i) => Kind::Wall,
                        () if !is_occupied(cells, i, 0.0) => Kind::Clear,
                        () if translucent => Kind::Medium,
                        () => Kind::Wall,
                    };
                    media |= *kind == Kind::Medium;
                }
                media
            })
            .reduce(|| false, |a, b| a | b);
        self.logs.clear();
        if media {
            self.logs.resize(self.kinds.len(), [0.0; 3]);
            let rows = self.logs.par_chunks_mut(stride).zip(self.kinds.par_chunks(stride));
            rows.enumerate().for_each(|(row, (logs, kinds))| {
                for x in (1..=w).filter(|&x| kinds[x] == Kind::Medium) {
                    let i = (row - 1) * w + x - 1;
                    logs[x] = log_transmittance(cells.opacity()[i], cells.tint()[i]);
                }
            });
        }
    }

    /// Whether there is fog or glass.
    pub fn has_media(&self) -> bool {
        !self.logs.is_empty()
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> [u32; 2] {
        self.size.map(|v| v as u32)
    }

    /// Whether two cells of the grid (indices in the frame) touch by a side or a corner, or are one.
    pub fn touch(&self, a: u32, b: u32) -> bool {
        // Walls never lie in the frame's own columns, so no row runs over into the next.
        let (stride, apart) = (self.stride as u32, a.abs_diff(b));
        a != u32::MAX && b != u32::MAX && (apart <= 1 || apart.abs_diff(stride) <= 1)
    }

    /// Walks sixteen rays from cell edge to cell edge, to the bit as [`Self::walk`] does; `None` for
    /// those that meet fog or glass, which have to be walked alone. The rays start at one point;
    /// together they take about as long as one of them alone.
    #[inline(always)]
    pub fn walk_together<S: Simd>(
        &self,
        simd: S,
        from: [f32; 2],
        directions: &[[f32; 2]; LANES],
        reach: f32,
    ) -> [Option<Hit>; LANES] {
        let mut hits = [Some(Hit::NONE); LANES];
        let (mut index, mut edge, mut sign, mut inverse) =
            ([0; LANES], [[0.0; LANES]; 2], [[0.0; LANES]; 2], [[0.0; LANES]; 2]);
        let (mut step, mut at, mut going) = ([[0; LANES]; 2], [0.0; LANES], 0u64);
        for l in 0..LANES {
            let start = Start::new(self, from, directions[l]);
            let Some(start) = start.filter(|start| start.at < reach) else { continue };
            going |= 1 << l;
            (index[l], at[l]) = (start.index as i32, start.at);
            for a in 0..2 {
                (edge[a][l], sign[a][l]) = (start.edge[a], start.sign[a]);
                (inverse[a][l], step[a][l]) = (start.inverse[a], start.step[a] as i32);
            }
        }
        let load = |v: [[f32; LANES]; 2]| v.map(|v| f32x16::load_array(simd, v));
        let (mut edge, sign, inverse) = (load(edge), load(sign), load(inverse));
        let step = step.map(|v| i32x16::load_array(simd, v));
        let mut places = i32x16::load_array(simd, index);
        let zero = i32x16::splat(simd, 0);
        let mut at = f32x16::load_array(simd, at);
        let mut next: [_; 2] = std::array::from_fn(|a| (edge[a] - from[a]) * inverse[a]);
        while going != 0 {
            let cells = places.to_array();
            let mut stop = 0;
            for l in 0..LANES {
                stop |= u64::from(self.kinds[cells[l] as usize] != Kind::Clear) << l;
            }
            stop &= going;
            while stop != 0 {
                let l = stop.trailing_zeros() as usize;
                stop &= stop - 1;
                going &= !(1 << l);
                hits[l] = match self.kinds[cells[l] as usize] {
                    Kind::Wall => Some(Hit { length: at[l], cell: cells[l] as u32 }),
                    Kind::Medium => None,
                    Kind::Outside | Kind::Clear => Some(Hit::NONE),
                };
            }
            let leave = next[0].min(next[1]);
            going &= leave.simd_lt(reach).to_bitmask();
            let mut ties = next[0].simd_eq(next[1]).to_bitmask() & going;
            while ties != 0 {
                let l = ties.trailing_zeros() as usize;
                ties &= ties - 1;
                let beside = [step[0][l], step[1][l]].map(|s| (cells[l] + s) as usize);
                if beside.iter().all(|&i| self.kinds[i] == Kind::Wall) {
                    going &= !(1 << l);
                    hits[l] = Some(Hit { length: leave[l], cell: beside[0] as u32 });
                }
            }
            let goes = mask32x16::from_bitmask(simd, going);
            let crosses = [goes & next[0].simd_le(next[1]), goes & next[1].simd_le(next[0])];
            for a in 0..2 {
                places += crosses[a].select(step[a], zero);
                edge[a] = crosses[a].select(edge[a] + sign[a], edge[a]);
                next[a] = (edge[a] - from[a]) * inverse[a];
            }
            at = leave;
        }
        hits
    }

    /// Walks a ray from cell edge to cell edge until a wall, the end of the grid or `reach`. `visit`
    /// is told of each cell on the way: from where to where, and its index in the frame. With
    /// `inside` the ray starts within the cell, even if that is a wall.
    #[inline(always)]
    pub fn walk(
        &self,
        from: [f32; 2],
        direction: [f32; 2],
        reach: f32,
        inside: bool,
        visit: impl FnMut([f32; 2], usize),
    ) -> Hit {
        match Start::new(self, from, direction).filter(|start| start.at < reach) {
            Some(start) => self.by_edges(from, start, reach, inside, visit),
            None => Hit::NONE,
        }
    }

    /// Walks a ray by samples, the first at its start, each `leap(cell)` px from the one before.
    pub fn sample(
        &self,
        from: [f32; 2],
        direction: [f32; 2],
        reach: f32,
        leap: impl Fn([usize; 2]) -> f32,
        mut visit: impl FnMut([f32; 2], usize),
    ) -> Hit {
        let Some(start) = Start::new(self, from, direction) else { return Hit::NONE };
        let (mut at, reach) = (start.at.ceil(), reach.min(start.leave));
        while at < reach {
            let cell = self.cell(std::array::from_fn(|a| from[a] + direction[a] * at));
            let index = self.index(cell);
            let next = at + leap(cell);
            if self.kinds[index] == Kind::Wall {
                return Hit { length: at, cell: index as u32 };
            }
            visit([at, next.min(reach)], index);
            at = next;
        }
        Hit::NONE
    }

    /// How far a sample in a cell is from the next one by the distance field: px that are clear
    /// whatever the direction, at least 1.
    pub fn leap(&self, distance: &[f32], [x, y]: [usize; 2]) -> f32 {
        (distance[y * self.size[0] as usize + x] - MARGIN).max(1.0)
    }

    /// Whether a point lies in the grid.
    pub fn contains(&self, at: [f32; 2]) -> bool {
        (0..2).all(|a| (0.0..self.size[a] as f32).contains(&at[a]))
    }

    /// Whether no wall stands between two points.
    pub fn sees(&self, from: [f32; 2], to: [f32; 2]) -> bool {
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        let direction = way.map(|v| v / length.max(f32::MIN_POSITIVE));
        self.walk(from, direction, length, false, |_, _| ()) == Hit::NONE
    }

    /// Where a ray enters the grid (0 when it starts inside) and leaves it; `None` when it misses.
    fn span(&self, from: [f32; 2], inverse: [f32; 2]) -> Option<[f32; 2]> {
        let [mut enter, mut leave] = [0.0f32, f32::INFINITY];
        for a in 0..2 {
            let (t0, t1) = (-from[a] * inverse[a], (self.size[a] as f32 - from[a]) * inverse[a]);
            enter = enter.max(t0.min(t1));
            leave = leave.min(t0.max(t1));
        }
        (enter < leave).then_some([enter, leave])
    }

    /// The cell at a point, at the border where rounding puts it just outside.
    fn cell(&self, at: [f32; 2]) -> [usize; 2] {
        std::array::from_fn(|a| (at[a].floor() as i32).clamp(0, self.size[a] - 1) as usize)
    }

    /// Index in the frame.
    pub fn index(&self, [x, y]: [usize; 2]) -> usize {
        (y + 1) * self.stride + x + 1
    }

    /// The cell at an index in the frame.
    pub fn place(&self, index: usize) -> [usize; 2] {
        [index % self.stride - 1, index / self.stride - 1]
    }

    /// Cells from a row of the frame to the next.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// What stands in every cell of the frame.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// Natural logarithm of the transmittance of one px of a cell of fog or glass.
    pub fn log(&self, index: usize) -> Rgb {
        self.logs[index]
    }

    /// Amanatides and Woo (1987). Through the exact corner of four cells light passes unless both
    /// cells beside it are walls.
    #[inline(always)]
    fn by_edges(
        &self,
        from: [f32; 2],
        start: Start,
        reach: f32,
        mut inside: bool,
        mut visit: impl FnMut([f32; 2], usize),
    ) -> Hit {
        let Start { mut at, mut index, mut edge, sign, step, inverse, .. } = start;
        let mut next: [f32; 2] = std::array::from_fn(|a| (edge[a] - from[a]) * inverse[a]);
        loop {
            let leave = next[0].min(next[1]);
            match self.kinds[index] {
                Kind::Wall if inside => (),
                Kind::Wall => return Hit { length: at, cell: index as u32 },
                Kind::Outside => return Hit::NONE,
                Kind::Clear | Kind::Medium => visit([at, leave.min(reach)], index),
            }
            inside = false;
            if leave >= reach {
                return Hit::NONE;
            }
            if next[0] == next[1] {
                let beside = step.map(|s| index.wrapping_add_signed(s));
                if beside.iter().all(|&i| self.kinds[i] == Kind::Wall) {
                    return Hit { length: leave, cell: beside[0] as u32 };
                }
            }
            // Without branches: which edge comes next is as good as random.
            let crosses = [next[0] <= next[1], next[1] <= next[0]];
            for a in 0..2 {
                index = index.wrapping_add_signed(step[a] * isize::from(crosses[a]));
                edge[a] += sign[a] * f32::from(crosses[a]);
                next[a] = (edge[a] - from[a]) * inverse[a];
            }
            at = leave;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Matter;
    use crate::stages::circle;
    use fearless_simd::{Level, dispatch};

    /// Walls here and there, and a streak of fog.
    fn ground() -> Ground {
        let mut cells = Cells::new(45, 33).unwrap();
        for i in (0..cells.len()).filter(|i| i * 7919 % 31 == 0) {
            cells.set_matter(i, Matter { opacity: 1.0, ..Matter::EMPTY });
        }
        for x in 20..30 {
            cells.set(x, 25, Matter { opacity: 0.1, ..Matter::EMPTY });
        }
        let mut ground = Ground::default();
        ground.prepare(&cells, true);
        ground
    }

    #[test]
    fn rays_together_go_where_each_goes_alone() {
        let ground = ground();
        let (mut walls, mut fog) = (0, 0);
        for from in [[22.5, 16.5], [0.3, 0.7], [-9.0, 40.0], [45.0, 33.0], [20.0, 10.0]] {
            for first in (0..800).step_by(LANES) {
                let ways: [_; LANES] =
                    std::array::from_fn(|l| circle::direction(first + l as u32, 800));
                let together = dispatch!(Level::new(), simd => {
                    ground.walk_together(simd, from, &ways, 30.0)
                });
                for (way, together) in ways.into_iter().zip(together) {
                    let mut met_fog = false;
                    let alone = ground.walk(from, way, 30.0, false, |_, cell| {
                        met_fog |= ground.kinds()[cell] == Kind::Medium;
                    });
                    walls += u32::from(alone != Hit::NONE);
                    fog += u32::from(met_fog);
                    match together {
                        Some(hit) => assert!(hit == alone && !met_fog, "{from:?} {way:?}"),
                        None => assert!(met_fog, "{from:?} {way:?}"),
                    }
                }
            }
        }
        assert!(walls > 500 && fog > 50, "{walls} {fog}");
    }

    #[test]
    fn a_ray_visits_its_cells_in_order_and_without_gaps() {
        let ground = ground();
        for i in 0..300 {
            let (mut at, mut cells) = (0.0, Vec::new());
            let hit =
                ground.walk([22.5, 16.5], circle::direction(i, 300), 60.0, false, |span, cell| {
                    assert!(span[0] == at && span[1] >= span[0]);
                    at = span[1];
                    cells.push(cell as u32);
                });
            assert!(
                hit == Hit::NONE
                    || (hit.length == at && ground.touch(hit.cell, cells[cells.len() - 1]))
            );
            assert!(
                cells.windows(2).all(|pair| pair[0] != pair[1] && ground.touch(pair[0], pair[1]))
            );
        }
    }

    #[test]
    fn between_two_walls_that_touch_by_a_corner_nothing_is_seen() {
        let mut cells = Cells::new(2, 2).unwrap();
        cells.set(0, 0, Matter { opacity: 1.0, ..Matter::EMPTY });
        let mut ground = Ground::default();
        ground.prepare(&cells, true);
        let ends = ([0.5, 1.5], [1.5, 0.5]);
        assert!(ground.sees(ends.0, ends.1), "past the corner of one");
        cells.set(1, 1, Matter { opacity: 1.0, ..Matter::EMPTY });
        ground.prepare(&cells, true);
        assert!(!ground.sees(ends.0, ends.1) && !ground.sees(ends.1, ends.0));
    }
}
