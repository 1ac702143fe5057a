//! Straight paths through a block of cells, in the directions in which blocks are known.

use std::f64::consts::TAU;

/// Directions in which a block is known; every fourth is along an axis.
pub const DIRECTIONS: usize = 16;
/// Slots of a block: each direction twice, for rays that enter by a step along x and along y.
pub const SLOTS: usize = 2 * DIRECTIONS;

/// Returns the slot of a direction and of the axis along which a ray enters.
pub fn slot(direction: usize, axis: usize) -> usize {
    2 * direction + axis
}

/// Returns whether no ray of a direction enters by a step along this axis: it goes along the other one.
pub fn is_missing(direction: usize, axis: usize) -> bool {
    direction.is_multiple_of(4) && direction / 4 % 2 != axis
}

/// Returns the unit vector of a direction.
pub fn direction(number: usize) -> [f64; 2] {
    let (sin, cos) = (TAU * number as f64 / DIRECTIONS as f64).sin_cos();
    // Exactly 0 along the axes.
    [cos, sin].map(|v| if v.abs() < 1e-9 { 0.0 } else { v })
}

/// A part of a path within one cell.
#[derive(Clone, Copy, Debug)]
pub struct PathStep {
    /// The number of the cell in the block with a margin of one cell, row by row.
    pub cell: usize,
    /// The axis along which the path enters it.
    pub axis: usize,
    /// Length, in sides of a cell.
    pub length: f32,
}

/// A path through a block, for all that enter beside it and cross the same cells.
#[derive(Debug)]
pub struct Path {
    /// Their fraction of all that enter by this side.
    pub weight: f32,
    /// The number of the cell in front of the block from which it enters.
    pub outside: usize,
    pub steps: Vec<PathStep>,
}

/// All paths through a block, by slot.
#[derive(Debug)]
pub struct Paths {
    pub of_slots: [Vec<Path>; SLOTS],
}

impl Paths {
    /// Finds the paths through a block of `side × side` cells.
    pub fn new(side: usize) -> Self {
        let of_slots = std::array::from_fn(|at| {
            let (number, axis) = (at / 2, at % 2);
            if is_missing(number, axis) { Vec::new() } else { paths(side, direction(number), axis) }
        });
        Self { of_slots }
    }
}

/// Returns the paths that enter along an axis.
fn paths(side: usize, direction: [f64; 2], axis: usize) -> Vec<Path> {
    // Corners of cells part the paths that cross different ones.
    let entry = if direction[axis] > 0.0 { 0.0 } else { side as f64 };
    let slope = direction[1 - axis] / direction[axis];
    let corners =
        (0..=side).flat_map(|along| (0..=side).map(move |across| (along as f64, across as f64)));
    let mut places: Vec<f64> = corners
        .map(|(along, across)| across - (along - entry) * slope)
        .filter(|v| (0.0..=side as f64).contains(v))
        .collect();
    places.sort_by(f64::total_cmp);
    let between = places.windows(2).filter(|pair| pair[1] - pair[0] > 1e-6);
    let path = |pair: &[f64]| {
        let weight = (pair[1] - pair[0]) / side as f64;
        path(side, direction, axis, 0.5 * (pair[0] + pair[1]), weight as f32)
    };
    between.map(path).collect()
}

/// Returns the path that enters along an axis, at this place on the side.
fn path(side: usize, direction: [f64; 2], axis: usize, place: f64, weight: f32) -> Path {
    let ahead = direction.map(|v| if v > 0.0 { 1i64 } else { -1 });
    let last = side as i64 - 1;
    let mut at = [place; 2];
    at[axis] = if ahead[axis] > 0 { 0.0 } else { side as f64 };
    let mut cell = [(place as i64).clamp(0, last); 2];
    cell[axis] = if ahead[axis] > 0 { 0 } else { last };
    let number = |cell: [i64; 2]| ((cell[1] + 1) * (last + 3) + cell[0] + 1) as usize;
    let mut outside = cell;
    outside[axis] -= ahead[axis];
    let mut path = Path { weight, outside: number(outside), steps: Vec::new() };
    let mut entered = axis;
    while cell.iter().all(|c| (0..=last).contains(c)) {
        let to_edge = |a: usize| match direction[a] {
            0.0 => f64::INFINITY,
            d => ((cell[a] + i64::from(ahead[a] > 0)) as f64 - at[a]) / d,
        };
        let lengths = [to_edge(0), to_edge(1)];
        let next = usize::from(lengths[1] < lengths[0]);
        let length = lengths[next].max(0.0);
        path.steps.push(PathStep { cell: number(cell), axis: entered, length: length as f32 });
        (0..2).for_each(|a| at[a] += direction[a] * length);
        cell[next] += ahead[next];
        entered = next;
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_paths_together_fill_each_cell() {
        for side in [2, 4] {
            let paths = Paths::new(side);
            for number in 0..DIRECTIONS {
                let way = direction(number);
                let mut areas = vec![0.0; (side + 2).pow(2)];
                for axis in 0..2 {
                    let of_slot = &paths.of_slots[slot(number, axis)];
                    assert_eq!(of_slot.is_empty(), is_missing(number, axis));
                    let sum: f32 = of_slot.iter().map(|path| path.weight).sum();
                    assert!(
                        of_slot.is_empty() || (sum - 1.0).abs() < 1e-6,
                        "{number}, {axis}: {sum}"
                    );
                    for path in of_slot {
                        let width = f64::from(path.weight) * side as f64 * way[axis].abs();
                        for step in &path.steps {
                            areas[step.cell] += width * f64::from(step.length);
                        }
                    }
                }
                for (cell, area) in areas.iter().enumerate() {
                    let [x, y] = [cell % (side + 2), cell / (side + 2)];
                    let inner = [x, y].iter().all(|v| (1..=side).contains(v));
                    assert!((area - f64::from(inner)).abs() < 1e-6, "{number}, {x}, {y}: {area}");
                }
            }
        }
    }
}
