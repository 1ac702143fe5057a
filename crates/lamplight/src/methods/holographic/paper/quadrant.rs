//! One quarter of the circle: intervals traced and extended, cones merged.

use super::grid::{Piece, RotatedGrid, pieces};
use super::interval::{Interval, Transmittance};
use crate::{Cells, Rgb, Sky};
use std::f64::consts::FRAC_PI_2;

/// The grid, rotated so that light arrives from +x, between −45° and +45°; and its intervals `T_n`.
/// Level n has planes at x = j·2ⁿ, and from each cell of a plane the rays
/// `v_n(k) = (2ⁿ, 2k − 2ⁿ)`, k = 0 … 2ⁿ.
#[derive(Debug, Default)]
pub struct Quadrant<T> {
    grid: RotatedGrid,
    turn: u32,
    sky: Sky,
    /// Planes × rays × rows, for each level.
    levels: Vec<Vec<Interval<T>>>,
    /// Planes × cones × rows: the level that is made, and the one above it.
    cones: [Vec<Rgb>; 2],
}

impl<T: Transmittance> Quadrant<T> {
    /// Returns N, the level whose rays reach through the whole grid.
    pub fn top(&self) -> u32 {
        self.grid.width.next_power_of_two().ilog2()
    }

    /// Returns the number of planes of a level.
    pub fn planes(&self, level: u32) -> usize {
        self.grid.width.div_ceil(1 << level)
    }

    /// Returns the number of rows of the rotated grid.
    pub fn rows(&self) -> usize {
        self.grid.height
    }

    /// Returns the index in the original grid of the cell at (x, y) here.
    pub fn cell(&self, x: usize, y: usize) -> usize {
        self.grid.cell(x, y)
    }

    /// Reads the cells, rotated by `turn` quarters (0 to 3, from +x towards +y), and makes all
    /// intervals, those up to level `traced` by tracing.
    pub fn prepare(&mut self, cells: &Cells, turn: u32, traced: u32) {
        self.grid.read(cells, turn);
        self.turn = turn;
        self.sky.clone_from(cells.sky());
        self.levels.resize_with(self.top() as usize + 1, Vec::new);
        for level in 0..=self.top() {
            let mut made = std::mem::take(&mut self.levels[level as usize]);
            made.clear();
            if level <= traced {
                self.trace(level, &mut made);
            } else {
                self.extend(level, &mut made);
            }
            self.levels[level as usize] = made;
        }
    }

    /// Returns `T_n(p, k)` with p in row y of a plane; ⟨0, 1⟩ outside the grid.
    pub fn interval(&self, level: u32, plane: usize, y: isize, k: usize) -> Interval<T> {
        at(self.ray(level, plane, k), y).unwrap_or(Interval::EMPTY)
    }

    /// Returns `R_n(p, i)` of a level, planes × 2ⁿ cones × rows.
    pub fn cones(&mut self, level: u32) -> &[Rgb] {
        self.merge_down_to(level);
        &self.cones[0]
    }

    /// Adds `R_0` of each cell, the light that arrives from this quarter of the circle times its
    /// angle, to the cells of the original grid.
    pub fn add_light(&mut self, sum: &mut [Rgb]) {
        self.merge_down_to(0);
        for (x, rows) in self.cones[0].chunks_exact(self.rows()).enumerate() {
            for (y, light) in rows.iter().enumerate() {
                let sum = &mut sum[self.grid.cell(x, y)];
                (0..3).for_each(|c| sum[c] += light[c]);
            }
        }
    }

    /// Returns all rows of one ray of one plane; none outside the grid.
    fn ray(&self, level: u32, plane: usize, k: usize) -> &[Interval<T>] {
        let count = if plane < self.planes(level) { self.rows() } else { 0 };
        let from = (plane * rays(level) + k) * count;
        &self.levels[level as usize][from..][..count]
    }

    fn trace(&self, level: u32, made: &mut Vec<Interval<T>>) {
        let paths = paths(level);
        for plane in 0..self.planes(level) {
            for path in &paths {
                let row = |y| self.grid.trace(plane << level, y, path);
                made.extend((0..self.rows()).map(row));
            }
        }
    }

    /// Composes `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and between two such the mean of both
    /// bent paths: `T_n(p, k) ⊕ T_n(p + v_n(k), k+1)` and `T_n(p, k+1) ⊕ T_n(p + v_n(k+1), k)`.
    fn extend(&self, level: u32, made: &mut Vec<Interval<T>>) {
        let half = level - 1;
        for plane in 0..self.planes(level) {
            let near = |k| self.ray(half, 2 * plane, k);
            let far = |k| self.ray(half, 2 * plane + 1, k);
            for k in 0..rays(level) {
                let (a, b) = (k / 2, k.div_ceil(2));
                let ([near_a, near_b], [far_a, far_b]) = ([a, b].map(near), [a, b].map(far));
                let join = |y: usize, near: &[Interval<T>], first: usize, far: &[Interval<T>]| {
                    let behind = at(far, y as isize + rise(half, first));
                    near[y].then(behind.unwrap_or(Interval::EMPTY))
                };
                if a == b {
                    made.extend((0..self.rows()).map(|y| join(y, near_a, a, far_a)));
                } else {
                    made.extend(
                        (0..self.rows())
                            .map(|y| join(y, near_a, a, far_b).mean(join(y, near_b, b, far_a))),
                    );
                }
            }
        }
    }

    fn merge_down_to(&mut self, last: u32) {
        let [mut made, mut above] = std::mem::take(&mut self.cones);
        for level in (last..=self.top()).rev() {
            std::mem::swap(&mut made, &mut above);
            made.clear();
            self.merge(level, &above, &mut made);
        }
        self.cones = [made, above];
    }

    /// Merges `R_n` from `R_{n+1}`, with s ∈ {0, 1}, j = 2i + s, k = i + s:
    /// - planes of odd index, and the top level:
    ///   `Σ_s [A_{n+1}(j)·r(T_n(p, k)) + t(T_n(p, k))·R_{n+1}(p + v_n(k), j)]`;
    /// - planes of even index: the mean of `Σ_s R_{n+1}(p, j)` and of
    ///   `Σ_s [A_{n+1}(j)·r(U) + t(U)·R_{n+1}(p + 2v_n(k), j)]`, `U = T_{n+1}(p, 2k)`.
    ///
    /// Outside the grid and beyond the top level lies the sky.
    fn merge(&self, level: u32, above: &[Rgb], made: &mut Vec<Rgb>) {
        let rows = self.rows();
        let cones_above = 2 << level;
        let angle: Vec<f32> = (0..cones_above).map(|j| angle(level + 1, j) as f32).collect();
        let sky: Vec<Rgb> = (0..cones_above).map(|j| self.sky_in(level + 1, j)).collect();
        let planes_above = if level == self.top() { 0 } else { self.planes(level + 1) };
        // Returns all rows of one cone of the level above; none outside the grid.
        let cone = |plane: usize, j: usize| -> &[Rgb] {
            let count = if plane < planes_above { rows } else { 0 };
            &above[(plane * cones_above + j) * count..][..count]
        };
        // Returns the light through an interval and then from cone j of another plane.
        let arrives = |met: &Interval<T>, j: usize, behind: &[Rgb], y: isize| -> Rgb {
            let (t, behind) = (met.transmittance.rgb(), at(behind, y).unwrap_or(sky[j]));
            std::array::from_fn(|c| angle[j] * met.light[c] + t[c] * behind[c])
        };
        for plane in 0..self.planes(level) {
            for i in 0..1 << level {
                let (j, k) = ([2 * i, 2 * i + 1], [i, i + 1]);
                let rise = k.map(|k| rise(level, k));
                if level == self.top() || plane % 2 == 1 {
                    let near = k.map(|k| self.ray(level, plane, k));
                    let behind = j.map(|j| cone(plane.div_ceil(2), j));
                    made.extend((0..rows).map(|y| {
                        let side =
                            |s: usize| arrives(&near[s][y], j[s], behind[s], y as isize + rise[s]);
                        plus(side(0), side(1))
                    }));
                } else {
                    let here = j.map(|j| cone(plane / 2, j));
                    let near = k.map(|k| self.ray(level + 1, plane / 2, 2 * k));
                    let behind = j.map(|j| cone(plane / 2 + 1, j));
                    made.extend((0..rows).map(|y| {
                        let side = |s: usize| {
                            arrives(&near[s][y], j[s], behind[s], y as isize + 2 * rise[s])
                        };
                        let (f0, f1) = (plus(here[0][y], here[1][y]), plus(side(0), side(1)));
                        std::array::from_fn(|c| 0.5 * f0[c] + 0.5 * f1[c])
                    }));
                }
            }
        }
    }

    /// Returns the radiance of the sky in cone j of a level, integrated over its angle.
    fn sky_in(&self, level: u32, j: usize) -> Rgb {
        let [from, to] = edges(level, j, self.turn);
        self.sky.mean(from, to).map(|v| (f64::from(v) * angle(level, j)) as f32)
    }
}

/// Returns the paths of all rays of a level, from any cell.
pub fn paths(level: u32) -> Vec<Vec<Piece>> {
    (0..rays(level)).map(|k| pieces([1 << level, rise(level, k) as i32])).collect()
}

/// Returns the angles of the grid between which cone j of a level lies in the quadrant rotated by `turn` quarters.
pub fn edges(level: u32, j: usize, turn: u32) -> [f64; 2] {
    [j, j + 1].map(|k| {
        let (y, x) = (rise(level, k) as f64, f64::from(1u32 << level));
        y.atan2(x) + f64::from(turn) * FRAC_PI_2
    })
}

/// Returns the number of rays of a level from one cell.
pub fn rays(level: u32) -> usize {
    (1 << level) + 1
}

/// Returns the rows from one end of `v_n(k)` to the other.
fn rise(level: u32, k: usize) -> isize {
    2 * k as isize - (1 << level)
}

/// Returns `A_n(i)`, the angle of cone i, between the rays i and i + 1.
fn angle(level: u32, i: usize) -> f64 {
    let [a, b] = [i, i + 1].map(|k| rise(level, k) as f64);
    let x = f64::from(1u32 << level);
    // From the cross and the dot product, so that mirrored cones are equal to the bit.
    (x * (b - a)).atan2(x * x + a * b)
}

/// Returns the value of a row; none outside the grid.
#[inline]
fn at<V: Copy>(rows: &[V], y: isize) -> Option<V> {
    // Rows above the grid wrap around to indices far beyond it.
    rows.get(y as usize).copied()
}

fn plus(a: Rgb, b: Rgb) -> Rgb {
    std::array::from_fn(|c| a[c] + b[c])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f64 sums of up to 4096 angles.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn cone_angles_sum_to_a_quarter_and_mirror() {
        for level in 0..=12 {
            let angles: Vec<f64> = (0..1 << level).map(|i| angle(level, i)).collect();
            let sum: f64 = angles.iter().sum();
            assert!((sum - FRAC_PI_2).abs() < ROUNDING, "level {level}: {sum}");
            assert!(angles.iter().eq(angles.iter().rev()), "level {level}");
            // A cone is what it is split into.
            for (i, whole) in angles.iter().enumerate() {
                let halves = angle(level + 1, 2 * i) + angle(level + 1, 2 * i + 1);
                assert!((halves - whole).abs() < ROUNDING, "level {level}, cone {i}");
            }
        }
        let short: f64 = (1..8).map(|i| angle(3, i)).sum();
        assert!((short - FRAC_PI_2).abs() > ROUNDING, "a cone that is missing passes");
    }
}
