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
        let mut next = [0, 1].map(|a| {
            let edge = f64::from(cell[a] + i32::from(ahead[a] > 0)) * side;
            (edge - from[a]) * f64::from(ahead[a]) * inverse[a]
        });
        let step = inverse.map(|v| v * side);
        let holds = |cell: [i32; 2]| (0..2).all(|a| ring[0][a] <= cell[a] && cell[a] < ring[1][a]);
        while holds(cell) {
            let inside = (0..2).all(|a| (0..level.size[a]).contains(&cell[a]));
            if !inside {
                return [state.light, state.through];
            }
            let crosses = usize::from(next[1] < next[0]);
            match level.numbers[(cell[1] * level.size[0] + cell[0]) as usize] {
                EMPTY => {}
                SOLID => state.cross(None),
                number => {
                    let middle = cell.map(|v| f64::from(v) + 0.5);
                    let entry = across.entry(offset / side - across.offset(middle));
                    let crossed = level.blocks[record(number)].crossed(bearing, entry);
                    state.cross(crossed);
                    let is_clear = || crossed.is_some_and(|[_, stopped]| stopped == [0.0; 3]);
                    if number & SHUT != 0 || number & CLIPPED != 0 && !is_clear() {
                        if number & SHUT == 0 {
                            // The rest belongs to the wall.
                            state.cross(None);
                        }
                        state.through = [0.0; 3];
                    }
                }
            }
            if state.through.iter().all(|v| *v < OPAQUE_TRANSMITTANCE) {
                return [state.light, [0.0; 3]];
            }
            if next[crosses] > reach {
                return [state.light, state.through];
            }
            cell[crosses] += ahead[crosses];
            next[crosses] += step[crosses];
        }
        cell = cell.map(|v| v.div_euclid(2));
    }
    [state.light, state.through]
}
