//! The grid as a lamp's rays see it, and their way through it.
//!
//! Cells lie in a frame of "outside", so that a ray knows where it leaves without comparing
//! coordinates.

use super::knots::Knots;
use crate::settings::Walk;
use crate::stages::distance::MARGIN;
use crate::stages::seed::is_occupied;
use crate::stages::transmittance::log_transmittance;
use crate::{Cells, Rgb};
use rayon::prelude::*;

/// What a cell is to a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
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
    kinds: Vec<Kind>,
    /// Natural logarithm of the transmittance of one px; empty without fog and glass.
    logs: Vec<Rgb>,
}

/// Where a ray ended: how far out, and in which cell of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub length: f32,
    pub cell: u32,
}

impl Hit {
    /// The ray met nothing.
    pub const NONE: Self = Self { length: f32::INFINITY, cell: u32::MAX };
}

impl Ground {
    /// Reads the grid; where nothing is translucent, all that is not empty is a wall.
    pub fn prepare(&mut self, cells: &Cells, translucent: bool) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        self.size = [w as i32, h as i32];
        let stride = w + 2;
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

    /// px from a point to the farthest corner of the grid.
    pub fn farthest(&self, from: [f32; 2]) -> f32 {
        let [x, y] =
            std::array::from_fn(|a| from[a].abs().max((self.size[a] as f32 - from[a]).abs()));
        x.hypot(y)
    }

    /// Whether two cells of the frame touch by a side or a corner, or are one.
    pub fn touch(&self, a: u32, b: u32) -> bool {
        let stride = self.size[0] as u32 + 2;
        let near = |a: u32, b: u32| a.abs_diff(b) <= 1;
        a != u32::MAX
            && b != u32::MAX
            && near(a % stride, b % stride)
            && near(a / stride, b / stride)
    }

    /// Walks a ray until a wall, the end of the grid or `reach`; fog and glass on the way are noted
    /// in `knots`. `distance` is the distance field, for [`Walk::Distance`].
    pub fn walk(
        &self,
        walk: Walk,
        distance: &[f32],
        from: [f32; 2],
        direction: [f32; 2],
        reach: f32,
        knots: &mut Knots,
    ) -> Hit {
        // Never 1/0, so that no edge is 0·∞ px away.
        let inverse = direction.map(|d| 1.0 / d.abs().max(f32::MIN_POSITIVE).copysign(d));
        let Some([enter, leave]) = self.span(from, inverse) else { return Hit::NONE };
        if enter >= reach {
            return Hit::NONE;
        }
        match walk {
            Walk::Edge => self.by_edges(from, direction, inverse, [enter, reach], knots),
            Walk::Step => self.by_steps(from, direction, [enter, reach.min(leave)], knots, |_| 1.0),
            Walk::Distance => {
                let leap = |cell: [usize; 2]| {
                    (distance[cell[1] * self.size[0] as usize + cell[0]] - MARGIN).max(1.0)
                };
                self.by_steps(from, direction, [enter, reach.min(leave)], knots, leap)
            }
        }
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
    fn index(&self, [x, y]: [usize; 2]) -> usize {
        (y + 1) * (self.size[0] as usize + 2) + x + 1
    }

    /// From cell edge to cell edge (Amanatides and Woo 1987). Through the exact corner of four cells
    /// light passes unless both cells beside it are walls.
    fn by_edges(
        &self,
        from: [f32; 2],
        direction: [f32; 2],
        inverse: [f32; 2],
        [enter, reach]: [f32; 2],
        knots: &mut Knots,
    ) -> Hit {
        let cell = self.cell(std::array::from_fn(|a| from[a] + direction[a] * enter));
        let mut index = self.index(cell);
        let ahead = inverse.map(|d| d > 0.0);
        let sign = ahead.map(|a| if a { 1.0 } else { -1.0 });
        let stride = self.size[0] as isize + 2;
        let step = [if ahead[0] { 1 } else { -1 }, if ahead[1] { stride } else { -stride }];
        let mut edge: [f32; 2] = std::array::from_fn(|a| cell[a] as f32 + f32::from(ahead[a]));
        let mut next: [f32; 2] = std::array::from_fn(|a| (edge[a] - from[a]) * inverse[a]);
        let mut at = enter;
        loop {
            let leave = next[0].min(next[1]);
            match self.kinds[index] {
                Kind::Wall => return Hit { length: at, cell: index as u32 },
                Kind::Outside => return Hit::NONE,
                Kind::Medium => knots.medium([at, leave.min(reach)], self.logs[index]),
                Kind::Clear => (),
            }
            if leave >= reach {
                return Hit::NONE;
            }
            if next[0] == next[1] {
                let beside = step.map(|s| index.wrapping_add_signed(s));
                if beside.iter().all(|&i| self.kinds[i] == Kind::Wall) {
                    return Hit { length: leave, cell: beside[0] as u32 };
                }
            }
            let both = [next[0] <= next[1], next[1] <= next[0]];
            for a in 0..2 {
                if both[a] {
                    index = index.wrapping_add_signed(step[a]);
                    edge[a] += sign[a];
                    next[a] = (edge[a] - from[a]) * inverse[a];
                }
            }
            at = leave;
        }
    }

    /// By samples, `leap(cell)` px apart, the first at the lamp.
    fn by_steps(
        &self,
        from: [f32; 2],
        direction: [f32; 2],
        [enter, reach]: [f32; 2],
        knots: &mut Knots,
        leap: impl Fn([usize; 2]) -> f32,
    ) -> Hit {
        let mut at = enter.ceil();
        while at < reach {
            let cell = self.cell(std::array::from_fn(|a| from[a] + direction[a] * at));
            let index = self.index(cell);
            let next = at + leap(cell);
            match self.kinds[index] {
                Kind::Wall => return Hit { length: at, cell: index as u32 },
                Kind::Medium => knots.medium([at, next.min(reach)], self.logs[index]),
                Kind::Clear | Kind::Outside => (),
            }
            at = next;
        }
        Hit::NONE
    }
}
