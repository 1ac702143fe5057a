//! Walks a ray through the cells, exactly and in f64: what it meets, in order, with path lengths.
//!
//! Empty space is crossed in squares. For each of the four quadrants of direction every cell knows
//! the side of the largest square of empty cells that has the cell as its near corner (the
//! "maximal square" recurrence: one more than the least of its three neighbours ahead). A ray
//! inside the cell leaves that square through one of its two far sides, and nothing in between
//! can matter. Space outside the grid is empty.
//!
//! **Corners.** A ray that passes exactly through the point where four cells meet is stopped when
//! both cells beside it are solid, so walls that touch only by their corners are light-tight. With
//! one solid cell beside it, it grazes past. (Exactly: as far as f64 tells the two crossings
//! apart; otherwise the ray crosses one of the cells beside the corner, as any ray does.)

use lamplight::Cells;

/// Longer than any grid: the side of a square with nothing in it.
const FAR: u16 = 2 * Cells::MAX_SIDE as u16 - 1;

/// Mark of solid cells among the indices of media.
const SOLID: u32 = u32::MAX;

/// What a ray that leaves the grid, or meets matter, has met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The ray left the grid.
    Sky,
    /// The ray reached a face of the solid cell with this index, at this point; `normal` looks
    /// out of the face, and `outside` is the cell in front of it.
    Wall { cell: usize, point: [f64; 2], normal: [f64; 2], outside: [i32; 2] },
    /// The ray crossed `length` px of the cell with this index, which is not solid; `extinction`
    /// is the index of its entry in [`Grid::extinction`].
    Medium { cell: usize, extinction: usize, length: f64 },
}

/// The cells as rays see them.
pub struct Grid {
    width: i32,
    height: i32,
    /// For quadrants (+x +y), (−x +y), (+x −y), (−x −y): the side of the empty square ahead.
    empty: [Vec<u16>; 4],
    /// For cells with matter: index into `extinction`, or [`SOLID`].
    medium: Vec<u32>,
    /// −ln((1 − α)·τ) a channel, 1/px, of each cell that is neither empty nor solid.
    pub extinction: Vec<[f64; 3]>,
}

impl Grid {
    /// Looks the cells through once.
    pub fn new(cells: &Cells) -> Self {
        let (width, height) = (cells.width() as usize, cells.height() as usize);
        let mut extinction = Vec::new();
        let mut clear = vec![true; width * height];
        let mut medium = vec![0; width * height];
        for i in 0..cells.len() {
            let kept = 1.0 - f64::from(cells.opacity()[i]);
            let transmittance = cells.tint()[i].map(|t| kept * f64::from(t));
            clear[i] = transmittance == [1.0; 3];
            if cells.is_solid(i) {
                medium[i] = SOLID;
            } else if !clear[i] {
                medium[i] = extinction.len() as u32;
                extinction.push(transmittance.map(|t| -t.ln()));
            }
        }
        let empty = std::array::from_fn(|q| squares(&clear, width, height, q & 1 != 0, q & 2 != 0));
        Self { width: width as i32, height: height as i32, empty, medium, extinction }
    }

    /// Whether a cell is a wall; outside the grid nothing is.
    #[inline]
    pub fn is_solid(&self, x: i32, y: i32) -> bool {
        self.index(x, y).is_some_and(|i| self.medium[i] == SOLID)
    }

    #[inline]
    fn index(&self, x: i32, y: i32) -> Option<usize> {
        ((x as u32) < self.width as u32 && (y as u32) < self.height as u32)
            .then(|| y as usize * self.width as usize + x as usize)
    }
}

/// Side of the largest empty square with its near corner at each cell, looking left or right and
/// up or down.
fn squares(clear: &[bool], width: usize, height: usize, left: bool, up: bool) -> Vec<u16> {
    let mut side = vec![0; width * height];
    // The row ahead, and one cell outside at its end, all empty space.
    let mut ahead = vec![FAR; width + 1];
    for row in 0..height {
        let y = if up { row } else { height - 1 - row };
        // Ahead of the row's first cell lies the outside; `diagonal` is what stood in `ahead`.
        let (mut beside, mut diagonal) = (FAR, FAR);
        for column in 0..width {
            let x = if left { column } else { width - 1 - column };
            let here = if clear[y * width + x] {
                beside.min(diagonal).min(ahead[column]).saturating_add(1).min(FAR)
            } else {
                0
            };
            diagonal = ahead[column];
            ahead[column] = here;
            beside = here;
            side[y * width + x] = here;
        }
    }
    side
}

/// A ray on its way.
pub struct Walk<'g> {
    grid: &'g Grid,
    empty: &'g [u16],
    cell: [i32; 2],
    origin: [f64; 2],
    direction: [f64; 2],
    /// px of path for each px along an axis.
    inverse: [f64; 2],
    step: [i32; 2],
    /// Path length so far.
    t: f64,
    /// The axis along which the present cell was entered.
    entered: usize,
}

impl<'g> Walk<'g> {
    /// A ray from a point in or on the border of `cell`, which is not solid, along a unit vector.
    #[inline]
    pub fn new(grid: &'g Grid, cell: [i32; 2], origin: [f64; 2], direction: [f64; 2]) -> Self {
        let [left, up] = direction.map(|d| d < 0.0);
        Self {
            grid,
            empty: &grid.empty[usize::from(left) + 2 * usize::from(up)],
            cell,
            origin,
            direction,
            // Large, but finite: 0 × ∞ would be no number.
            inverse: direction.map(|d| if d == 0.0 { 1e300 } else { 1.0 / d }),
            step: [if left { -1 } else { 1 }, if up { -1 } else { 1 }],
            t: 0.0,
            entered: 0,
        }
    }

    /// The way it goes.
    #[inline]
    pub fn direction(&self) -> [f64; 2] {
        self.direction
    }

    /// The next thing met. After [`Event::Sky`] and [`Event::Wall`] the walk is over.
    #[inline]
    pub fn next(&mut self) -> Event {
        loop {
            let Some(i) = self.grid.index(self.cell[0], self.cell[1]) else {
                return Event::Sky;
            };
            let side = self.empty[i];
            if side > 0 {
                self.leave_square(i32::from(side));
                continue;
            }
            let medium = self.grid.medium[i];
            if medium == SOLID {
                return self.wall(i);
            }
            let entry = self.t;
            self.leave_square(1);
            // Rounding may set the exit before the entry where a ray cuts a corner.
            let length = (self.t - entry).max(0.0);
            return Event::Medium { cell: i, extinction: medium as usize, length };
        }
    }

    /// Moves to the first cell beyond the square of `side` cells that starts at the present one.
    #[inline]
    fn leave_square(&mut self, side: i32) {
        let far = [0, 1].map(|a| self.cell[a] + side * self.step[a]);
        let exit = [0, 1].map(|a| (self.line(a, far[a]) - self.origin[a]) * self.inverse[a]);
        let along =
            if exit[0] == exit[1] { self.corner(far) } else { usize::from(exit[1] < exit[0]) };
        let across = 1 - along;
        self.t = exit[along];
        self.cell[along] = far[along];
        self.entered = along;
        if side > 1 {
            let p = self.origin[across] + self.t * self.direction[across];
            // The cell that the ray is about to be in, also exactly between two cells.
            let trunc = p as i32;
            let (near, last) = (self.cell[across], far[across] - self.step[across]);
            self.cell[across] = if self.step[across] > 0 {
                (trunc - i32::from(f64::from(trunc) > p)).clamp(near, last)
            } else {
                (trunc - i32::from(f64::from(trunc) >= p)).clamp(last, near)
            };
        }
    }

    /// Which of the two cells beside the far corner of a square the ray passes through (a path of
    /// length 0): the one that is not solid.
    #[cold]
    fn corner(&self, far: [i32; 2]) -> usize {
        let last = [0, 1].map(|a| far[a] - self.step[a]);
        usize::from(self.grid.is_solid(far[0], last[1]) && !self.grid.is_solid(last[0], far[1]))
    }

    /// Where the line lies through which a cell is entered.
    #[inline]
    fn line(&self, axis: usize, cell: i32) -> f64 {
        f64::from(cell + i32::from(self.step[axis] < 0))
    }

    fn wall(&self, cell: usize) -> Event {
        let (along, across) = (self.entered, 1 - self.entered);
        let row = f64::from(self.cell[across]);
        let mut point = [0.0; 2];
        point[along] = self.line(along, self.cell[along]);
        point[across] =
            (self.origin[across] + self.t * self.direction[across]).clamp(row, row + 1.0);
        let mut normal = [0.0; 2];
        normal[along] = -f64::from(self.step[along]);
        let mut outside = self.cell;
        outside[along] -= self.step[along];
        Event::Wall { cell, point, normal, outside }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use lamplight::Matter;

    const WALL: Matter = Matter { opacity: 1.0, ..Matter::EMPTY };
    const FOG: Matter = Matter { opacity: 0.25, ..Matter::EMPTY };
    /// Path lengths in grids of up to 60 px, in f64, by two orders of summing.
    const ROUNDING: f64 = 1e-9;

    /// What a ray meets, by cutting it at every grid line: no squares, no steps. Walls end it.
    fn brute_force(
        cells: &Cells,
        origin: [f64; 2],
        direction: [f64; 2],
    ) -> (Vec<(usize, f64)>, bool) {
        let sides = [cells.width(), cells.height()];
        let mut cuts = vec![0.0];
        for axis in 0..2 {
            for line in 0..=sides[axis] {
                let t = (f64::from(line) - origin[axis]) / direction[axis];
                if t.is_finite() && t > 0.0 {
                    cuts.push(t);
                }
            }
        }
        cuts.sort_by(f64::total_cmp);
        let mut met = Vec::new();
        for pair in cuts.windows(2) {
            let middle = (pair[0] + pair[1]) / 2.0;
            let [x, y] = [0, 1].map(|a| (origin[a] + middle * direction[a]).floor() as i64);
            if x < 0 || y < 0 || x >= sides[0].into() || y >= sides[1].into() {
                break;
            }
            let i = cells.index(x as u32, y as u32);
            if cells.is_solid(i) {
                return (met, true);
            }
            if cells.opacity()[i] > 0.0 {
                met.push((i, pair[1] - pair[0]));
            }
        }
        (met, false)
    }

    fn walked(grid: &Grid, mut walk: Walk) -> (Vec<(usize, f64)>, Event) {
        let mut met = Vec::new();
        loop {
            match walk.next() {
                Event::Medium { cell, length, .. } => met.push((cell, length)),
                end => {
                    if let Event::Wall { outside: [x, y], .. } = end {
                        assert!(!grid.is_solid(x, y), "a wall is hit from the open");
                    }
                    return (met, end);
                }
            }
        }
    }

    #[test]
    fn meets_what_brute_force_meets() {
        let seed = 7;
        let mut random = Random::new(seed, 0, 0);
        let mut hits = 0;
        for scene in 0..300 {
            let side = |random: &mut Random| 1 + (random.next().powi(2) * 40.0) as u32;
            let mut cells = Cells::new(side(&mut random), side(&mut random)).unwrap();
            let density = random.next().powi(3) * 0.6;
            for i in 0..cells.len() {
                if random.next() < density {
                    cells.set_matter(i, if random.next() < 0.5 { WALL } else { FOG });
                }
            }
            let grid = Grid::new(&cells);
            for _ in 0..100 {
                let x = (random.next() * f64::from(cells.width())) as u32;
                let y = (random.next() * f64::from(cells.height())) as u32;
                if cells.is_solid(cells.index(x, y)) {
                    continue;
                }
                let origin = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                let (sin, cos) = (random.next() * std::f64::consts::TAU).sin_cos();
                let (expected, hit) = brute_force(&cells, origin, [cos, sin]);
                let walk = Walk::new(&grid, [x as i32, y as i32], origin, [cos, sin]);
                let (met, end) = walked(&grid, walk);
                let case = format!("seed {seed}, scene {scene}, from {origin:?} to {cos}, {sin}");
                assert_eq!(met.len(), expected.len(), "{case}");
                for (a, b) in met.iter().zip(&expected) {
                    assert!(a.0 == b.0 && (a.1 - b.1).abs() < ROUNDING, "{case}: {a:?} {b:?}");
                }
                assert_eq!(end != Event::Sky, hit, "{case}");
                hits += usize::from(hit);
            }
        }
        assert!(hits > 1000, "few rays met a wall: {hits}");
    }

    /// Rays through the corner (2, 2) from the centre of (0, 0), and back from (3, 3).
    fn through_the_corner(walls: &[[u32; 2]]) -> [Event; 2] {
        let mut cells = Cells::new(4, 4).unwrap();
        walls.iter().for_each(|&[x, y]| cells.set(x, y, WALL));
        let grid = Grid::new(&cells);
        let d = std::f64::consts::FRAC_1_SQRT_2;
        [
            Walk::new(&grid, [0, 0], [0.5, 0.5], [d, d]).next(),
            Walk::new(&grid, [3, 3], [3.5, 3.5], [-d, -d]).next(),
        ]
    }

    #[test]
    fn walls_that_touch_by_corners_are_tight_and_one_corner_is_grazed() {
        assert_eq!(through_the_corner(&[]), [Event::Sky; 2]);
        assert_eq!(through_the_corner(&[[2, 1]]), [Event::Sky; 2]);
        assert_eq!(through_the_corner(&[[1, 2]]), [Event::Sky; 2]);
        for end in through_the_corner(&[[2, 1], [1, 2]]) {
            assert!(matches!(end, Event::Wall { .. }), "{end:?}");
        }
        // One solid cell beside the corner and one behind it: hit from the side that is open.
        let ends = through_the_corner(&[[2, 1], [2, 2]]);
        let expected =
            Event::Wall { cell: 10, point: [2.0, 2.0], normal: [-1.0, 0.0], outside: [1, 2] };
        match ends[0] {
            Event::Wall { cell: 10, outside: [1, 2], .. } => {}
            other => panic!("{other:?}, not {expected:?}"),
        }
    }

    #[test]
    fn other_slopes_through_corners_stay_tight() {
        // A diagonal chain of walls from corner to corner: nothing gets from one side to the other.
        let side = 33;
        let mut cells = Cells::new(side, side).unwrap();
        (0..side).for_each(|i| cells.set(i, side - 1 - i, WALL));
        let grid = Grid::new(&cells);
        for dx in 0..60i32 {
            for dy in 0..60i32 {
                let length = f64::from(dx * dx + dy * dy).sqrt();
                if length == 0.0 || dx + dy == 0 {
                    continue;
                }
                let d = [f64::from(dx) / length, f64::from(dy) / length];
                let (_, end) = walked(&grid, Walk::new(&grid, [0, 0], [0.5, 0.5], d));
                assert!(matches!(end, Event::Wall { .. }), "{dx}, {dy}: {end:?}");
            }
        }
    }

    #[test]
    fn axes_and_the_outside() {
        let mut cells = Cells::new(5, 3).unwrap();
        cells.set(4, 1, WALL);
        let grid = Grid::new(&cells);
        let wall = Event::Wall { cell: 9, point: [4.0, 1.5], normal: [-1.0, 0.0], outside: [3, 1] };
        assert_eq!(Walk::new(&grid, [0, 1], [0.5, 1.5], [1.0, 0.0]).next(), wall);
        for d in [[-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [-0.0, 1.0]] {
            assert_eq!(Walk::new(&grid, [0, 1], [0.5, 1.5], d).next(), Event::Sky);
        }
        assert_eq!(Walk::new(&grid, [5, 1], [5.0, 1.5], [1.0, 0.0]).next(), Event::Sky);
    }

    #[test]
    fn the_comparison_rejects_a_wrong_length() {
        let mut cells = Cells::new(9, 9).unwrap();
        cells.set(5, 4, FOG);
        let (met, _) = brute_force(&cells, [0.5, 4.5], [1.0, 0.0]);
        let d = [1.0f64, 0.01];
        let length = d[0].hypot(d[1]);
        let (slanted, _) = brute_force(&cells, [0.5, 4.5], d.map(|v| v / length));
        assert!((met[0].1 - slanted[0].1).abs() > ROUNDING);
    }
}
