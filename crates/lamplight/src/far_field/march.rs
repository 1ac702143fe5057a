//! Rays through the blocks around a window, larger ones farther away.

use super::block::{Bearing, BlockRayState};
use super::levels::{BlockLevel, CLIPPED, EMPTY, SHUT, SOLID, record};
use super::paths::Across;
use super::read::SIDE;
use crate::Rgb;
use crate::math::transmittance::OPAQUE_TRANSMITTANCE;

/// The blocks of each level that rays from a window cross before they come to those of the next one: from the first
/// to the last, exclusive.
#[derive(Debug)]
pub struct Rings {
    levels: Vec<[[i32; 2]; 2]>,
    /// The smallest blocks of the window itself.
    window: [[i32; 2]; 2],
}

/// A direction of rays.
#[derive(Clone, Debug)]
pub struct RayDirection {
    /// The unit vector.
    pub way: [f64; 2],
    across: Across,
    bearing: Bearing,
}

/// A ray that enters a smallest block.
#[derive(Clone, Copy, Debug)]
pub struct BlockRay<'a> {
    /// px of the world.
    pub from: [f64; 2],
    pub direction: &'a RayDirection,
    /// The block that it enters, by column and row.
    pub block: [i32; 2],
    /// The length of the ray, px. Its last block counts as a whole.
    pub reach: f64,
}

impl RayDirection {
    /// Returns that of an angle, radians from +x towards +y.
    pub fn new(angle: f64) -> Self {
        let way = [angle.cos(), angle.sin()];
        Self { way, across: Across::new(way), bearing: Bearing::new(angle) }
    }
}

impl Rings {
    /// Finds those of a window, px, for so many levels, of which each is `width` blocks wide.
    pub fn new(count: usize, first: [i32; 2], end: [i32; 2], width: i32) -> Self {
        let mut edges = [first, end];
        let window = edges.map(|edge| edge.map(|v| v / SIDE as i32));
        let ring = |level: usize| {
            let side = (SIDE as i32) << level;
            if level + 1 == count {
                return [[i32::MIN; 2], [i32::MAX; 2]];
            }
            let [low, high] = &mut edges;
            for a in 0..2 {
                low[a] = (low[a] - width * side).div_euclid(2 * side) * 2 * side;
                high[a] = (high[a] + (width + 2) * side - 1).div_euclid(2 * side) * 2 * side;
            }
            edges.map(|edge| edge.map(|v| v / side))
        };
        Self { levels: (0..count).map(ring).collect(), window }
    }

    /// The blocks of a level that rays may cross, from the first to the last, exclusive; of these, all in the second
    /// rectangle belong to the level before, or to the window.
    pub fn of_level(&self, level: usize) -> [[[i32; 2]; 2]; 2] {
        let nearer =
            level.checked_sub(1).map(|finer| self.levels[finer].map(|edge| edge.map(|v| v / 2)));
        [self.levels[level], nearer.unwrap_or(self.window)]
    }
}

/// A ray among the blocks of a level.
struct LevelRay {
    from: [f64; 2],
    way: [f64; 2],
    /// The signs of its way, and the lengths along it per px along each axis.
    ahead: [i32; 2],
    inverse: [f64; 2],
    /// The side of the blocks, px, and blocks per px.
    side: f64,
    per_px: f64,
}

impl LevelRay {
    /// Returns the length of the ray up to the first edge of a block, along an axis.
    #[inline]
    fn length(&self, axis: usize, edge: i32) -> f64 {
        let distance = f64::from(edge) * self.side - self.from[axis];
        distance * f64::from(self.ahead[axis]) * self.inverse[axis]
    }

    /// Returns the edge by which it leaves blocks from `low` to `high`, exclusive, along an axis.
    #[inline]
    fn last_edge(&self, axis: usize, low: i32, high: i32) -> i32 {
        if self.ahead[axis] > 0 { high } else { low }
    }

    /// Moves from a block to the one behind a rectangle around it, from `low` to `high`, exclusive. Returns the length up
    /// to there. The block is the one that single steps lead to, to the bit.
    #[inline]
    fn leave(&self, cell: &mut [i32; 2], low: [i32; 2], high: [i32; 2]) -> f64 {
        let lengths = [0, 1].map(|a| self.length(a, self.last_edge(a, low[a], high[a])));
        let axis = usize::from(lengths[1] < lengths[0]);
        let (length, other) = (lengths[axis], 1 - axis);
        let ahead = self.ahead[other];
        let is_passed = |cell: i32| {
            let at = self.length(other, self.last_edge(other, cell, cell + 1));
            if axis == 0 { at < length } else { at <= length }
        };
        if high[other] - low[other] > 1 {
            let along = (self.from[other] + length * self.way[other]) * self.per_px;
            let guess = (along as i32).clamp(low[other], high[other] - 1);
            let is_behind = (guess - cell[other]) * ahead < 0;
            let mut found = if is_behind { cell[other] } else { guess };
            while found != cell[other] && !is_passed(found - ahead) {
                found -= ahead;
            }
            while is_passed(found) {
                found += ahead;
            }
            cell[other] = found;
        }
        let edge = self.last_edge(axis, low[axis], high[axis]);
        cell[axis] = if self.ahead[axis] > 0 { edge } else { edge - 1 };
        length
    }
}

/// Returns the radiance that blocks send along a ray, and the transmittance of the way to its end, or out of the world.
pub fn march(levels: &[BlockLevel], rings: &Rings, ray: BlockRay) -> [Rgb; 2] {
    let BlockRay { from, direction, block: mut cell, reach } = ray;
    let RayDirection { way, across, bearing } = direction;
    let offset = across.offset(from);
    let ahead = way.map(|v| if v > 0.0 { 1 } else { -1 });
    let inverse = way.map(|v| 1.0 / if v.abs() < 1e-12 { 1e-12 } else { v.abs() });
    let mut state = BlockRayState::START;
    for (number, (level, ring)) in levels.iter().zip(&rings.levels).enumerate() {
        let side = (SIDE << number) as f64;
        let ray = LevelRay { from, way: *way, ahead, inverse, side, per_px: 1.0 / side };
        let holds = |cell: [i32; 2]| (0..2).all(|a| ring[0][a] <= cell[a] && cell[a] < ring[1][a]);
        while holds(cell) {
            let inside = (0..2).all(|a| (0..level.size[a]).contains(&cell[a]));
            if !inside {
                return [state.light, state.through];
            }
            // The blocks to cross: this one, or the empty ones around it.
            let [mut low, mut high] = [cell, cell.map(|v| v + 1)];
            match level.numbers[(cell[1] * level.size[0] + cell[0]) as usize] {
                EMPTY => {
                    let width = level.clear.width(cell);
                    for a in 0..2 {
                        let first = cell[a] & !(width - 1);
                        low[a] = first.max(ring[0][a]);
                        high[a] = (first + width).min(ring[1][a]);
                    }
                }
                SOLID => state.cross(None),
                number => {
                    let middle = cell.map(|v| f64::from(v) + 0.5);
                    let entry = across.entry(offset / side - across.offset(middle));
                    let crossed = level.blocks[record(number)].crossed(bearing, entry);
                    state.cross(crossed);
                    let is_clear = crossed.is_some_and(|[_, stopped]| stopped == [0.0; 3]);
                    if !is_clear && number & (SHUT | CLIPPED) != 0 {
                        // The rest belongs to the wall.
                        state.cross(None);
                    }
                    if number & SHUT != 0 {
                        state.through = [0.0; 3];
                    }
                }
            }
            if state.through.iter().all(|v| *v < OPAQUE_TRANSMITTANCE) {
                return [state.light, [0.0; 3]];
            }
            if ray.leave(&mut cell, low, high) > reach {
                return [state.light, state.through];
            }
        }
        cell = cell.map(|v| v.div_euclid(2));
    }
    [state.light, state.through]
}

#[cfg(test)]
mod tests {
    use super::super::block::{FarBlock, PackedRgb};
    use super::super::levels::{ClearSquares, FIRST};
    use super::*;
    use std::f64::consts::TAU;

    /// Levels of which about one block in `sparse` has matter: solid, or with light of its own.
    fn levels(random: &mut fastrand::Rng, sparse: u32) -> Vec<BlockLevel> {
        let level = |side: i32| {
            let mut blocks = Vec::new();
            let mut number = || match random.u32(0..4 * sparse) {
                0 => SOLID,
                1..4 => {
                    let mut block = FarBlock::CLEAR;
                    block.sent.fill_with(|| PackedRgb::new([0; 3].map(|_| random.f32())));
                    block.stopped.fill(PackedRgb::new([0.25; 3]));
                    blocks.push(block);
                    blocks.len() as u32 - 1 + FIRST
                }
                _ => EMPTY,
            };
            let numbers = (0..side * side).map(|_| number()).collect();
            let clear = ClearSquares::none([side; 2]);
            BlockLevel { size: [side; 2], numbers, blocks, clear }
        };
        [160, 80, 40, 20].map(level).into()
    }

    #[test]
    fn rays_cross_empty_squares_as_they_cross_their_blocks() {
        let seed = fastrand::u64(..);
        let mut random = fastrand::Rng::with_seed(seed);
        let (mut lit, mut clear) = (0, 0);
        for sparse in [2, 20, 200, 2000] {
            let seed_of_levels = random.u64(..);
            let levels = || levels(&mut fastrand::Rng::with_seed(seed_of_levels), sparse);
            let (single, mut squares) = (levels(), levels());
            for level in &mut squares {
                // All matter is between its first and its last row, and all of those may be known.
                let is_matter =
                    |row: &i32| (0..level.size[0]).any(|x| level.number([x, *row]) != EMPTY);
                let rows = || (0..level.size[1]).filter(is_matter);
                let rows =
                    [rows().next().unwrap_or(0), rows().next_back().map_or(0, |row| row + 1)];
                let known = [[0, rows[0]], [level.size[0], rows[1]]];
                level.clear = ClearSquares::of(level, known);
                let side = 0..level.size[0];
                let widths = side.map(|i| [i; 2]).filter(|at| level.number(*at) == EMPTY);
                clear += widths.filter(|at| level.clear.width(*at) > 1).count();
            }
            let first = [0; 2].map(|_| SIDE as i32 * random.i32(20..120));
            let rings = Rings::new(4, first, first.map(|v| v + 64), 6);
            for number in 0..2000 {
                // Also along the axes, and through corners.
                let angle = match number % 4 {
                    0 => TAU / 8.0 * f64::from(random.i32(0..8)),
                    _ => TAU * random.f64(),
                };
                let direction = RayDirection::new(angle);
                let outside = |a: usize| {
                    let edge = if direction.way[a] > 0.0 { first[a] + 64 } else { first[a] };
                    f64::from(edge)
                };
                let across = usize::from(direction.way[1].abs() > direction.way[0].abs());
                let along = 1 - across;
                let mut from = [0.0; 2];
                from[across] = outside(across);
                let places = if number % 8 < 4 { 0.0 } else { random.f64() };
                from[along] = f64::from(first[along] + random.i32(0..64)) + places;
                let mut block = from.map(|v| (v / SIDE as f64).floor() as i32);
                block[across] -= i32::from(direction.way[across] < 0.0);
                let reach = if random.bool() { f64::INFINITY } else { 500.0 * random.f64() };
                let ray = BlockRay { from, direction: &direction, block, reach };
                let [expected, found] =
                    [&single, &squares].map(|levels| march(levels, &rings, ray));
                assert_eq!(found, expected, "seed {seed}, {sparse}, {angle}: {ray:?}");
                lit += usize::from(found[0] != [0.0; 3]);
            }
        }
        assert!(lit > 1000 && clear > 100, "seed {seed}: {lit}, {clear}");
    }
}
