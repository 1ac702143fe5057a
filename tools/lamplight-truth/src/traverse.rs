//! Exact traversal of the cells along a ray, in f64, with path lengths.
//!
//! Space and fog of one kind are crossed in squares. For each of the four quadrants of direction
//! every cell knows the side of the largest square of cells of the same matter that has the cell as
//! its near corner (the "maximal square" recurrence: one more than the least of its three
//! neighbours ahead). A ray inside the cell leaves that square through one of its two far sides,
//! and nothing in between can matter. Space outside the grid is empty.
//!
//! **Corners.** A ray that passes exactly through the point where four cells meet is stopped when
//! both cells beside it are solid, so walls that touch only by their corners are light-tight. With
//! one solid cell beside it, it grazes past. (Exactly: as far as f64 tells the two crossings
//! apart; otherwise the ray crosses one of the cells beside the corner, as any ray does.)

use lamplight::Cells;

/// The side of a square of empty space without end, larger than any grid.
const FAR: u16 = 2 * Cells::MAX_SIDE as u16 - 1;

/// The flag of squares that hold matter, in the bits of their side.
const MATTER: u16 = 1 << 15;

/// The index of solid cells among the indices of media.
const SOLID: u32 = u32::MAX;

/// The next thing on the way of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The ray left the grid.
    Sky,
    /// The ray reached a face of the solid cell with this index, at this point; `normal` looks
    /// out of the face, and `outside` is the cell in front of it.
    Wall { cell: usize, point: [f64; 2], normal: [f64; 2], outside: [i32; 2] },
    /// The ray crossed cells that are not solid.
    Medium(Stretch),
}

/// The path of a ray through a square of cells of one matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Index of the first cell.
    pub cell: usize,
    /// Index of its entry in [`Grid::extinction`].
    pub extinction: usize,
    /// The path length, px.
    pub length: f64,
    /// The number of cells along a side of the square.
    pub side: i32,
    near: [i32; 2],
    /// The path length up to it.
    pub entry: f64,
}

/// The cells, prepared for traversal.
pub struct Grid {
    width: i32,
    height: i32,
    /// For quadrants (+x +y), (−x +y), (+x −y), (−x −y): the side of the square ahead, with
    /// [`MATTER`] where it is not empty.
    squares: [Vec<u16>; 4],
    /// For cells with matter: index into `extinction`, or [`SOLID`].
    medium: Vec<u32>,
    /// Extinction σ_t = −ln((1 − α)·tint) per channel, 1/px, of cells that are neither empty nor solid.
    pub extinction: Vec<[f64; 3]>,
}

impl Grid {
    /// Returns whether a point lies in the grid.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (0.0..=f64::from(self.width)).contains(&x) && (0.0..=f64::from(self.height)).contains(&y)
    }

    /// The distance to the border of the grid from a point inside it, px.
    pub fn to_border(&self, from: [f64; 2], way: [f64; 2]) -> f64 {
        let size = [self.width, self.height].map(f64::from);
        let along = |a: usize| {
            let border = if way[a] > 0.0 { size[a] } else { 0.0 };
            if way[a] == 0.0 { f64::INFINITY } else { (border - from[a]) / way[a] }
        };
        along(0).min(along(1))
    }

    /// Prepares the cells.
    pub fn new(cells: &Cells) -> Self {
        let (width, height) = (cells.width() as usize, cells.height() as usize);
        let mut extinction: Vec<[f64; 3]> = Vec::new();
        let mut medium = vec![0; width * height];
        for i in 0..cells.len() {
            if cells.is_solid(i) {
                medium[i] = SOLID;
            } else if i > 0 && cells.matter(i) == cells.matter(i - 1) {
                medium[i] = medium[i - 1];
            } else if !is_clear(cells, i) {
                medium[i] = extinction.len() as u32;
                extinction.push(transmittance(cells, i).map(|t| -t.ln()));
            }
        }
        let squares = std::array::from_fn(|q| squares(cells, q & 1 != 0, q & 2 != 0));
        Self { width: width as i32, height: height as i32, squares, medium, extinction }
    }

    /// True if a cell is solid; no cell outside the grid is.
    #[inline]
    pub fn is_solid(&self, x: i32, y: i32) -> bool {
        self.index(x, y).is_some_and(|i| self.medium[i] == SOLID)
    }

    /// True if a cell is inside the grid and not solid.
    pub fn is_open(&self, x: i32, y: i32) -> bool {
        self.index(x, y).is_some_and(|i| self.medium[i] != SOLID)
    }

    #[inline]
    fn index(&self, x: i32, y: i32) -> Option<usize> {
        ((x as u32) < self.width as u32 && (y as u32) < self.height as u32)
            .then(|| y as usize * self.width as usize + x as usize)
    }
}

/// The transmittance of one px of a cell.
fn transmittance(cells: &Cells, i: usize) -> [f64; 3] {
    let kept = 1.0 - f64::from(cells.opacity()[i]);
    cells.tint()[i].map(|t| kept * f64::from(t))
}

/// True if a cell neither changes light nor adds any.
fn is_clear(cells: &Cells, i: usize) -> bool {
    transmittance(cells, i) == [1.0; 3] && cells.glow().is_none_or(|glow| glow[i] == [0.0; 3])
}

/// The side of the largest square of one matter with its near corner at each cell, looking left or
/// right and up or down.
fn squares(cells: &Cells, left: bool, up: bool) -> Vec<u16> {
    let (width, height) = (cells.width() as usize, cells.height() as usize);
    let mut squares = vec![0; width * height];
    for row in 0..height {
        let y = if up { row } else { height - 1 - row };
        for column in 0..width {
            let x = if left { column } else { width - 1 - column };
            let i = y * width + x;
            let clear = is_clear(cells, i);
            // Side of the square at a cell ahead, if it holds the same matter.
            let side = |dx: usize, dy: usize| {
                if column < dx || row < dy {
                    return if clear { FAR } else { 0 };
                }
                let x = if left { x - dx } else { x + dx };
                let n = (if up { y - dy } else { y + dy }) * width + x;
                let alike =
                    if clear { is_clear(cells, n) } else { cells.matter(n) == cells.matter(i) };
                if alike { squares[n] & !MATTER } else { 0 }
            };
            // What stops light at once is met cell by cell.
            let stops = transmittance(cells, i).contains(&0.0);
            let ahead = if stops { 0 } else { side(1, 0).min(side(0, 1)).min(side(1, 1)) };
            squares[i] = (ahead + 1).min(FAR) | if clear { 0 } else { MATTER };
        }
    }
    squares
}

/// A ray on its way.
pub struct Traversal<'g> {
    grid: &'g Grid,
    squares: &'g [u16],
    cell: [i32; 2],
    origin: [f64; 2],
    direction: [f64; 2],
    /// The path length per px along an axis.
    inverse: [f64; 2],
    step: [i32; 2],
    /// The path length so far.
    t: f64,
    /// The axis along which the present cell was entered.
    entered: usize,
}

impl<'g> Traversal<'g> {
    /// A ray from a point in or on the border of `cell`, which is not solid, along a unit vector.
    #[inline]
    pub fn new(grid: &'g Grid, cell: [i32; 2], origin: [f64; 2], direction: [f64; 2]) -> Self {
        let [left, up] = direction.map(|d| d < 0.0);
        Self {
            grid,
            squares: &grid.squares[usize::from(left) + 2 * usize::from(up)],
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

    /// The start of the ray.
    #[inline]
    pub fn origin(&self) -> [f64; 2] {
        self.origin
    }

    /// The direction of the ray.
    #[inline]
    pub fn direction(&self) -> [f64; 2] {
        self.direction
    }

    /// The next event. After [`Event::Sky`] and [`Event::Wall`] the traversal is over.
    #[inline]
    pub fn next(&mut self) -> Event {
        loop {
            let Some(i) = self.grid.index(self.cell[0], self.cell[1]) else {
                return Event::Sky;
            };
            let square = self.squares[i];
            if square < MATTER {
                self.leave_square(i32::from(square));
                continue;
            }
            let medium = self.grid.medium[i];
            if medium == SOLID {
                return self.wall(i);
            }
            let (near, entry, side) = (self.cell, self.t, i32::from(square & !MATTER));
            self.leave_square(side);
            // Rounding may set the exit before the entry where a ray cuts a corner.
            let length = (self.t - entry).max(0.0);
            let extinction = medium as usize;
            return Event::Medium(Stretch { cell: i, extinction, length, side, near, entry });
        }
    }

    /// The cell that the ray is in after some px of a stretch.
    pub fn cell_after(&self, stretch: &Stretch, px: f64) -> [i32; 2] {
        [0, 1].map(|a| {
            let near = stretch.near[a];
            self.cell_at(a, stretch.entry + px, near, near + (stretch.side - 1) * self.step[a])
        })
    }

    /// Column (axis 0) or row (axis 1) of the cell that the ray is about to be in, also exactly
    /// between two cells; from `near` to `last`.
    #[inline]
    fn cell_at(&self, axis: usize, t: f64, near: i32, last: i32) -> i32 {
        let p = self.origin[axis] + t * self.direction[axis];
        let trunc = p as i32;
        if self.step[axis] > 0 {
            (trunc - i32::from(f64::from(trunc) > p)).clamp(near, last)
        } else {
            (trunc - i32::from(f64::from(trunc) >= p)).clamp(last, near)
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
            let (near, last) = (self.cell[across], far[across] - self.step[across]);
            self.cell[across] = self.cell_at(across, self.t, near, last);
        }
    }

    /// The one of the two cells beside the far corner of a square that the ray passes through (a path of
    /// length 0): the one that is not solid.
    #[cold]
    fn corner(&self, far: [i32; 2]) -> usize {
        let last = [0, 1].map(|a| far[a] - self.step[a]);
        usize::from(self.grid.is_solid(far[0], last[1]) && !self.grid.is_solid(last[0], far[1]))
    }

    /// The position of the grid line through which a cell is entered.
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
    use fastrand::Rng;
    use lamplight::Matter;

    const WALL: Matter = Matter { opacity: 1.0, ..Matter::EMPTY };
    const FOG: Matter = Matter { opacity: 0.25, ..Matter::EMPTY };
    const MIST: Matter = Matter { opacity: 0.125, ..Matter::EMPTY };
    /// Path lengths in grids of up to 60 px, in f64, by two orders of summing.
    const ROUNDING: f64 = 1e-9;

    /// A length of path through one matter: its opacity, from, to.
    type Piece = (f32, f64, f64);

    /// Appends a piece, as part of the last one if it continues it.
    fn push(met: &mut Vec<Piece>, (opacity, from, to): Piece) {
        match met.last_mut() {
            Some(last) if last.0 == opacity && from - last.2 < ROUNDING => last.2 = to,
            _ => met.push((opacity, from, to)),
        }
    }

    /// The events of a ray, found by cutting it at every grid line, without squares. Walls end it.
    fn brute_force(cells: &Cells, origin: [f64; 2], direction: [f64; 2]) -> (Vec<Piece>, bool) {
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
                push(&mut met, (cells.opacity()[i], pair[0], pair[1]));
            }
        }
        (met, false)
    }

    fn walked(cells: &Cells, grid: &Grid, mut walk: Traversal) -> (Vec<Piece>, Event) {
        let mut met = Vec::new();
        loop {
            match walk.next() {
                Event::Medium(stretch) => {
                    let (from, to) = (stretch.entry, stretch.entry + stretch.length);
                    push(&mut met, (cells.opacity()[stretch.cell], from, to));
                    for share in [0.0, 0.3, 1.0] {
                        let [x, y] = walk.cell_after(&stretch, share * stretch.length);
                        let i = cells.index(x as u32, y as u32);
                        assert_eq!(cells.opacity()[i], cells.opacity()[stretch.cell]);
                    }
                }
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
        let mut random = Rng::with_seed(seed);
        let (mut hits, mut fogs) = (0, 0);
        for scene in 0..300 {
            let side = |random: &mut Rng| 1 + (random.f64().powi(2) * 40.0) as u32;
            let mut cells = Cells::new(side(&mut random), side(&mut random)).unwrap();
            // From thin matter in space to thin space in fog.
            let density = random.f64().powi(3) * 0.6;
            let ground = if random.f64() < 0.3 { FOG } else { Matter::EMPTY };
            for i in 0..cells.len() {
                cells.set_matter(i, ground);
                if random.f64() < density {
                    let kinds = [WALL, FOG, MIST, Matter::EMPTY];
                    cells.set_matter(i, kinds[(random.f64() * 4.0) as usize]);
                }
            }
            let grid = Grid::new(&cells);
            for _ in 0..100 {
                let x = (random.f64() * f64::from(cells.width())) as u32;
                let y = (random.f64() * f64::from(cells.height())) as u32;
                if cells.is_solid(cells.index(x, y)) {
                    continue;
                }
                let origin = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                let (sin, cos) = (random.f64() * std::f64::consts::TAU).sin_cos();
                let (expected, hit) = brute_force(&cells, origin, [cos, sin]);
                let walk = Traversal::new(&grid, [x as i32, y as i32], origin, [cos, sin]);
                let (met, end) = walked(&cells, &grid, walk);
                let case = format!("seed {seed}, scene {scene}, from {origin:?} to {cos}, {sin}");
                assert_eq!(met.len(), expected.len(), "{case}");
                for (a, b) in met.iter().zip(&expected) {
                    let near = |a: f64, b: f64| (a - b).abs() < ROUNDING;
                    let same = a.0 == b.0 && near(a.1, b.1) && near(a.2, b.2);
                    assert!(same, "{case}: {a:?} {b:?}");
                }
                assert_eq!(end != Event::Sky, hit, "{case}");
                hits += usize::from(hit);
                fogs += met.len();
            }
        }
        assert!(hits > 1000 && fogs > 1000, "little was met: {hits}, {fogs}");
    }

    /// Rays through the corner (2, 2) from the centre of (0, 0), and back from (3, 3).
    fn through_the_corner(walls: &[[u32; 2]]) -> [Event; 2] {
        let mut cells = Cells::new(4, 4).unwrap();
        walls.iter().for_each(|&[x, y]| cells.set(x, y, WALL));
        let grid = Grid::new(&cells);
        let d = std::f64::consts::FRAC_1_SQRT_2;
        [
            Traversal::new(&grid, [0, 0], [0.5, 0.5], [d, d]).next(),
            Traversal::new(&grid, [3, 3], [3.5, 3.5], [-d, -d]).next(),
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
        match ends[0] {
            Event::Wall { cell: 10, outside: [1, 2], .. } => {}
            other => panic!("{other:?}"),
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
                let (_, end) = walked(&cells, &grid, Traversal::new(&grid, [0, 0], [0.5, 0.5], d));
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
        assert_eq!(Traversal::new(&grid, [0, 1], [0.5, 1.5], [1.0, 0.0]).next(), wall);
        for d in [[-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [-0.0, 1.0]] {
            assert_eq!(Traversal::new(&grid, [0, 1], [0.5, 1.5], d).next(), Event::Sky);
        }
        assert_eq!(Traversal::new(&grid, [5, 1], [5.0, 1.5], [1.0, 0.0]).next(), Event::Sky);
    }

    #[test]
    fn the_comparison_rejects_a_wrong_length() {
        let mut cells = Cells::new(9, 9).unwrap();
        cells.set(5, 4, FOG);
        let (met, _) = brute_force(&cells, [0.5, 4.5], [1.0, 0.0]);
        let d = [1.0f64, 0.01];
        let length = d[0].hypot(d[1]);
        let (slanted, _) = brute_force(&cells, [0.5, 4.5], d.map(|v| v / length));
        assert!((met[0].2 - slanted[0].2).abs() > ROUNDING);
    }
}
