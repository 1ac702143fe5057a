//! Straight paths through a block of cells, in the directions in which blocks are known.

use std::f64::consts::TAU;

/// Directions in which a block is known; every fourth is along an axis.
pub const DIRECTIONS: usize = 16;
/// Strips of equal width across a block, side by side along each direction.
const STRIPS: usize = 4;
/// Slots of a direction: its strips, with the one in which the block's nearest corner lies parted there. What enters a
/// block on both sides of a corner may come from both sides of a wall.
pub const PER_DIRECTION: usize = STRIPS + 1;
/// Slots of a block.
pub const SLOTS: usize = PER_DIRECTION * DIRECTIONS;

/// Returns the slot of a direction by its number in it.
pub fn slot(direction: usize, number: usize) -> usize {
    PER_DIRECTION * direction + number
}

/// Returns the unit vector of a direction.
pub fn direction(number: usize) -> [f64; 2] {
    let (sin, cos) = (TAU * number as f64 / DIRECTIONS as f64).sin_cos();
    // Exactly 0 along the axes.
    [cos, sin].map(|v| if v.abs() < 1e-9 { 0.0 } else { v })
}

/// Returns the face by which a ray enters a cell along an axis: left, right, top, bottom.
pub fn face(way: [f64; 2], axis: usize) -> usize {
    2 * axis + usize::from(way[axis] < 0.0)
}

/// The way in which parallel rays lie across blocks. They enter a block by two sides; a ray passes its middle at an
/// offset.
#[derive(Clone, Copy, Debug)]
pub struct Across {
    /// The unit vector to the left of the way.
    normal: [f64; 2],
    /// The width of a block of side 1, seen along the way, and that of its side with the least offsets.
    pub width: f64,
    first: f64,
}

/// The place at which a ray enters a block.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// True if it enters by the side with the largest offsets.
    is_last: bool,
    strip: usize,
}

impl Across {
    pub fn new([x, y]: [f64; 2]) -> Self {
        let first = if x * y > 0.0 || x == 0.0 { y } else { x };
        Self { normal: [-y, x], width: x.abs() + y.abs(), first: first.abs() }
    }

    /// Returns the offset of a place.
    #[inline]
    pub fn offset(&self, [x, y]: [f64; 2]) -> f64 {
        self.normal[0] * x + self.normal[1] * y
    }

    /// Returns where a ray enters a block of side 1, by its offset from the middle.
    #[inline]
    pub fn entry(&self, offset: f64) -> Entry {
        let at = offset + 0.5 * self.width;
        let strip = (at / self.width * STRIPS as f64).max(0.0) as usize;
        Entry { is_last: at >= self.first, strip: strip.min(STRIPS - 1) }
    }
}

/// The slots of a direction.
#[derive(Clone, Copy, Debug)]
pub struct Strips {
    /// Rays enter by the first side in the strips before `first_end`, and by the last one in those from `last_begin` on.
    first_end: usize,
    last_begin: usize,
}

impl Strips {
    pub fn new(across: &Across) -> Self {
        let corner = across.first / across.width * STRIPS as f64;
        let [before, after] = [corner - 1e-9, corner + 1e-9].map(|v| v.max(0.0));
        Self { first_end: before.ceil() as usize, last_begin: after.floor() as usize }
    }

    /// Returns the number of the slot of a ray. Where rays of this direction enter only by the other side, it is that of
    /// these.
    #[inline]
    pub fn number(&self, Entry { is_last, strip }: Entry) -> usize {
        let by_last = if is_last { strip >= self.last_begin } else { strip >= self.first_end };
        strip + usize::from(by_last)
    }

    /// Returns the ends of each slot of a block of side 1, as offsets from its middle; they are the same if no ray of this
    /// direction is in it.
    fn ends(&self, across: &Across) -> [[f64; 2]; PER_DIRECTION] {
        let Across { width, first, .. } = *across;
        let end = |strip: usize| width * strip as f64 / STRIPS as f64;
        std::array::from_fn(|number| {
            let ends = if number < self.first_end {
                [end(number), end(number + 1).min(first)]
            } else if number > self.last_begin {
                [end(number - 1).max(first), end(number)]
            } else {
                [first; 2]
            };
            ends.map(|v| v - 0.5 * width)
        })
    }
}

/// A part of a path within one cell.
#[derive(Clone, Copy, Debug)]
pub struct PathStep {
    /// The number of the cell in the block with a margin of one cell, row by row.
    pub cell: usize,
    /// The face by which the path enters it.
    pub face: usize,
    /// The number of its slot in the direction, if the cell is a block.
    pub number: usize,
    /// Length, in sides of a cell.
    pub length: f32,
}

/// A path through a block, for all beside it.
#[derive(Debug)]
pub struct Path {
    /// Their fraction of all in the slot.
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
    /// Finds the paths through a block of `side × side` cells: one for all that cross the same cells.
    pub fn through_cells(side: usize) -> Self {
        Self::between(side, |across, _| {
            let corners = (0..=side).flat_map(|x| (0..=side).map(move |y| [x, y]));
            let middle = 0.5 * side as f64;
            corners.map(|corner| across.offset(corner.map(|v| v as f64 - middle))).collect()
        })
    }

    /// Finds the paths through a block of `side × side` smaller blocks: one for all that cross the same strips of these.
    pub fn through_blocks(side: usize) -> Self {
        Self::between(side, |across, strips| {
            let blocks = (0..side).flat_map(|x| (0..side).map(move |y| [x, y]));
            let middle = 0.5 * (side - 1) as f64;
            let offsets = blocks.map(|block| across.offset(block.map(|v| v as f64 - middle)));
            let ends = strips.ends(across);
            offsets
                .flat_map(|offset| ends.as_flattened().iter().map(move |end| offset + end))
                .collect()
        })
    }

    /// Finds the paths in the middle between these offsets from the middle of the block, and the ends of its slots.
    fn between(side: usize, edges: impl Fn(&Across, Strips) -> Vec<f64>) -> Self {
        let mut of_slots = std::array::from_fn(|_| Vec::new());
        for number in 0..DIRECTIONS {
            let across = Across::new(direction(number));
            let strips = Strips::new(&across);
            let ends = strips.ends(&across).map(|ends| ends.map(|end| end * side as f64));
            let mut edges = edges(&across, strips);
            edges.extend(ends.as_flattened());
            edges.sort_by(f64::total_cmp);
            for (part, [begin, end]) in ends.into_iter().enumerate() {
                let inside = |pair: &&[f64]| {
                    begin <= pair[0] + 1e-9 && pair[1] <= end + 1e-9 && pair[1] - pair[0] > 1e-6
                };
                let paths = edges.windows(2).filter(inside).map(|pair| {
                    let weight = (pair[1] - pair[0]) / (end - begin);
                    path(side, direction(number), 0.5 * (pair[0] + pair[1]), weight as f32)
                });
                of_slots[slot(number, part)] = paths.collect();
            }
        }
        Self { of_slots }
    }
}

/// Returns the path at an offset from the middle of the block.
fn path(side: usize, direction: [f64; 2], offset: f64, weight: f32) -> Path {
    let ahead = direction.map(|v| if v > 0.0 { 1i64 } else { -1 });
    let across = Across::new(direction);
    let strips = Strips::new(&across);
    let half = 0.5 * side as f64;
    let last = side as i64 - 1;
    let foot = across.normal.map(|v| half + offset * v);
    // Where it has entered the range of the block along both axes.
    let enters = |a: usize| match direction[a] {
        0.0 => f64::NEG_INFINITY,
        d => (half - half * ahead[a] as f64 - foot[a]) / d,
    };
    let axis = usize::from(enters(1) > enters(0));
    let mut at = [0, 1].map(|a| foot[a] + direction[a] * enters(axis));
    let mut cell = at.map(|v| (v as i64).clamp(0, last));
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
        let middle = cell.map(|v| v as f64 + 0.5 - half);
        let entry = across.entry(offset - across.offset(middle));
        path.steps.push(PathStep {
            cell: number(cell),
            face: face(direction, entered),
            number: strips.number(entry),
            length: length as f32,
        });
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
        for (side, paths) in [(4, Paths::through_cells(4)), (2, Paths::through_blocks(2))] {
            for number in 0..DIRECTIONS {
                let across = Across::new(direction(number));
                let ends = Strips::new(&across).ends(&across);
                let width = |part: usize| ends[part][1] - ends[part][0];
                let mut areas = vec![0.0; (side + 2usize).pow(2)];
                // The width of the paths in each slot of a cell.
                let mut widths = vec![[0.0; PER_DIRECTION]; (side + 2).pow(2)];
                for part in 0..PER_DIRECTION {
                    let of_slot = &paths.of_slots[slot(number, part)];
                    let sum: f32 = of_slot.iter().map(|path| path.weight).sum();
                    assert!(
                        of_slot.is_empty() && width(part) < 1e-6 || (sum - 1.0).abs() < 1e-6,
                        "{number}, {part}: {sum}"
                    );
                    for path in of_slot {
                        let width = side as f64 * width(part);
                        for step in &path.steps {
                            areas[step.cell] += f64::from(path.weight * step.length) * width;
                            widths[step.cell][step.number] += f64::from(path.weight) * width;
                        }
                    }
                }
                for cell in 0..areas.len() {
                    let [x, y] = [cell % (side + 2), cell / (side + 2)];
                    let inner = f64::from([x, y].iter().all(|v| (1..=side).contains(v)));
                    if side == 4 {
                        let area = areas[cell];
                        assert!((area - inner).abs() < 1e-6, "{number}, {x}, {y}: {area}");
                        continue;
                    }
                    for (part, found) in widths[cell].into_iter().enumerate() {
                        let expected = inner * width(part);
                        assert!((found - expected).abs() < 1e-6, "{number}, {x}, {y}: {found}");
                    }
                }
            }
        }
    }

    #[test]
    fn paths_of_a_slot_enter_by_one_side() {
        for paths in [Paths::through_cells(4), Paths::through_blocks(2)] {
            for (slot, of_slot) in paths.of_slots.iter().enumerate() {
                let faces: Vec<usize> = of_slot.iter().map(|path| path.steps[0].face).collect();
                assert!(faces.windows(2).all(|pair| pair[0] == pair[1]), "{slot}: {faces:?}");
            }
        }
    }
}
