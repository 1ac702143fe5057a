//! Rays cast to the first solid cell, alone or sixteen at once from one point.
//!
//! Lengths are exact ([`super::traverse`]): this is for methods whose rays start anywhere, such as
//! at a lamp, and whose lengths are kept. Rays from every cell, of which only the light counts, take
//! [`super::packet`].

use super::class::CellClass;
use super::medium_grid::MediumGrid;
use super::traverse::{Real, Step, enter, traverse};
use fearless_simd::{f32x16, i32x16, mask32x16, prelude::*};
use std::ops::ControlFlow;

/// Rays that are cast together.
pub const LANES: usize = 16;

/// The end of a ray at a solid cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance from the origin, px; ∞ if the ray hits nothing.
    pub length: f32,
    /// Index of the solid cell, `u32::MAX` if the ray hits nothing.
    pub cell: u32,
}

impl RayHit {
    /// A ray that hits nothing.
    pub const NONE: Self = Self { length: f32::INFINITY, cell: u32::MAX };
}

impl MediumGrid {
    /// Casts a ray to the first solid cell, at most `reach` px far. `visit` receives each open cell
    /// on the way, and its index. With `inside` the ray may start in a solid
    /// cell.
    #[inline(always)]
    pub fn cast(
        &self,
        from: [f32; 2],
        direction: [f32; 2],
        reach: f32,
        inside: bool,
        mut visit: impl FnMut(&Step<f32>, usize),
    ) -> RayHit {
        let Some((ray, [start, leave])) = enter(self.size, from, direction) else {
            return RayHit::NONE;
        };
        if start >= reach {
            return RayHit::NONE;
        }
        let is_solid = |cell| self.classes[self.index(cell)] == CellClass::Solid;
        let end = traverse(ray, [start, reach.min(leave)], |step| {
            let hit = |cell| {
                let cell = self.index(cell) as u32;
                ControlFlow::Break(RayHit { length: step.span[0], cell })
            };
            if let Some(cell) = step.blocked(is_solid) {
                return hit(cell);
            }
            if !is_solid(step.cell) {
                visit(&step, self.index(step.cell));
            } else if !(inside && step.is_start()) {
                return hit(step.cell);
            }
            ControlFlow::Continue(())
        });
        end.break_value().unwrap_or(RayHit::NONE)
    }

    /// Casts sixteen rays from one point, with the results of [`Self::cast`] to the bit; `None` for
    /// those that meet a medium, which have to be cast alone. Together they take about as long as
    /// one of them alone.
    #[inline(always)]
    pub fn cast_lanes<S: Simd>(
        &self,
        simd: S,
        from: [f32; 2],
        directions: &[[f32; 2]; LANES],
        reach: f32,
    ) -> [Option<RayHit>; LANES] {
        let mut hits = [Some(RayHit::NONE); LANES];
        let (mut index, mut edge, mut sign, mut inverse) =
            ([0; LANES], [[0.0; LANES]; 2], [[0.0; LANES]; 2], [[0.0; LANES]; 2]);
        let (mut step, mut at, mut end, mut going) =
            ([[0; LANES]; 2], [0.0; LANES], [0.0; LANES], 0u64);
        for l in 0..LANES {
            let Some((ray, [start, leave])) = enter(self.size, from, directions[l]) else {
                continue;
            };
            if start >= reach {
                continue;
            }
            going |= 1 << l;
            (index[l], at[l], end[l]) = (self.index(ray.cell) as i32, start, reach.min(leave));
            for a in 0..2 {
                inverse[a][l] = directions[l][a].inverse();
                let ahead = inverse[a][l] > 0.0;
                let next_cell = if a == 0 { 1 } else { self.size[0] };
                (sign[a][l], step[a][l]) =
                    if ahead { (1.0, next_cell) } else { (-1.0, -next_cell) };
                edge[a][l] = (ray.cell[a] + i32::from(ahead)) as f32;
            }
        }
        let load = |v: [[f32; LANES]; 2]| v.map(|v| f32x16::load_array(simd, v));
        let (mut edge, sign, inverse) = (load(edge), load(sign), load(inverse));
        let step = step.map(|v| i32x16::load_array(simd, v));
        let mut places = i32x16::load_array(simd, index);
        let zero = i32x16::splat(simd, 0);
        let [mut at, end] = [at, end].map(|v| f32x16::load_array(simd, v));
        let mut next: [_; 2] = std::array::from_fn(|a| (edge[a] - from[a]) * inverse[a]);
        while going != 0 {
            let cells = places.to_array();
            let mut stop = 0;
            for l in 0..LANES {
                stop |= u64::from(self.classes[cells[l] as usize] != CellClass::Empty) << l;
            }
            stop &= going;
            while stop != 0 {
                let l = stop.trailing_zeros() as usize;
                stop &= stop - 1;
                going &= !(1 << l);
                hits[l] = (self.classes[cells[l] as usize] == CellClass::Solid)
                    .then_some(RayHit { length: at[l], cell: cells[l] as u32 });
            }
            let leave = next[0].min(next[1]);
            going &= leave.simd_lt(end).to_bitmask();
            let mut corners = next[0].simd_eq(next[1]).to_bitmask() & going;
            while corners != 0 {
                let l = corners.trailing_zeros() as usize;
                corners &= corners - 1;
                let beside = [step[0][l], step[1][l]].map(|s| (cells[l] + s) as usize);
                if beside.iter().all(|&i| self.classes[i] == CellClass::Solid) {
                    going &= !(1 << l);
                    hits[l] = Some(RayHit { length: leave[l], cell: beside[0] as u32 });
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

    /// Returns whether no solid cell stands between two points.
    pub fn sees(&self, from: [f32; 2], to: [f32; 2]) -> bool {
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        let direction = way.map(|v| v / length.max(f32::MIN_POSITIVE));
        self.cast(from, direction, length, false, |_, _| ()) == RayHit::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::medium_grid::Reading;
    use crate::math::circle;
    use crate::simd::dispatch;
    use crate::{Cells, Matter};
    use fearless_simd::Level;

    /// Walls here and there, and a streak of fog.
    fn grid() -> MediumGrid {
        let mut cells = Cells::new(45, 33).unwrap();
        for i in (0..cells.len()).filter(|i| i * 7919 % 31 == 0) {
            cells.set_matter(i, Matter { opacity: 1.0, ..Matter::EMPTY });
        }
        for x in 20..30 {
            cells.set(x, 25, Matter { opacity: 0.1, ..Matter::EMPTY });
        }
        let mut grid = MediumGrid::default();
        grid.read(&cells, Reading::default());
        grid
    }

    #[test]
    fn rays_together_go_where_each_goes_alone() {
        let grid = grid();
        let (mut walls, mut fog) = (0, 0);
        for from in [[22.5, 16.5], [0.3, 0.7], [-9.0, 40.0], [45.0, 33.0], [20.0, 10.0]] {
            for first in (0..800).step_by(LANES) {
                let ways: [_; LANES] =
                    std::array::from_fn(|l| circle::direction(first + l as u32, 800));
                let lanes = dispatch!(Level::new(), simd => {
                    grid.cast_lanes(simd, from, &ways, 30.0)
                });
                for (way, lane) in ways.into_iter().zip(lanes) {
                    let mut met_fog = false;
                    let alone = grid.cast(from, way, 30.0, false, |_, cell| {
                        met_fog |= grid.classes[cell] == CellClass::Medium;
                    });
                    walls += u32::from(alone != RayHit::NONE);
                    fog += u32::from(met_fog);
                    match lane {
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
        let grid = grid();
        for i in 0..300 {
            let (mut at, mut cells) = (0.0, Vec::new());
            let hit =
                grid.cast([22.5, 16.5], circle::direction(i, 300), 60.0, false, |step, cell| {
                    let span = step.span;
                    assert!(span[0] == at && span[1] >= span[0]);
                    at = span[1];
                    cells.push(cell as u32);
                });
            assert!(
                hit == RayHit::NONE
                    || (hit.length == at && grid.touch(hit.cell, cells[cells.len() - 1]))
            );
            assert!(
                cells.windows(2).all(|pair| pair[0] != pair[1] && grid.touch(pair[0], pair[1]))
            );
        }
    }

    #[test]
    fn between_two_walls_that_touch_by_a_corner_nothing_is_seen() {
        let mut cells = Cells::new(2, 2).unwrap();
        cells.set(0, 0, Matter { opacity: 1.0, ..Matter::EMPTY });
        let mut grid = MediumGrid::default();
        grid.read(&cells, Reading::default());
        let ends = ([0.5, 1.5], [1.5, 0.5]);
        assert!(grid.sees(ends.0, ends.1), "past the corner of one");
        cells.set(1, 1, Matter { opacity: 1.0, ..Matter::EMPTY });
        grid.read(&cells, Reading::default());
        assert!(!grid.sees(ends.0, ends.1) && !grid.sees(ends.1, ends.0));
    }
}
