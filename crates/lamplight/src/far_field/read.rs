//! Blocks read from cells.

use super::block::{FarBlock, PackedRgb};
use super::paths::Paths;
use super::shut::WallWay;
use crate::grid::class::CellClass;
use crate::math::transmittance::{attenuation, extinction};
use crate::stages::bounce::{SurfaceLight, Surfaces};
use crate::{Cells, Rgb};
use rayon::prelude::*;

/// Side of the smallest blocks, cells.
pub const SIDE: usize = 4;
/// Cells of a row of a block with its margin.
const WITH_MARGIN: usize = SIDE + 2;

/// A block of cells.
#[derive(Debug)]
pub enum Found {
    Empty,
    /// No ray comes in from open space.
    Solid,
    Matter {
        block: Box<FarBlock>,
        wall: WallWay,
    },
}

/// Reads blocks of some cells.
#[derive(Debug)]
pub struct BlockReader<'a> {
    cells: &'a Cells,
    classes: Vec<CellClass>,
    surfaces: Surfaces,
    paths: Paths,
}

impl<'a> BlockReader<'a> {
    /// Creates one of cells whose surfaces send this on.
    pub fn new(cells: &'a Cells, light: &SurfaceLight) -> Self {
        let mut surfaces = Surfaces::default();
        surfaces.collect(cells, 0.0);
        surfaces.send(light);
        let classes = (0..cells.len()).into_par_iter();
        let classes = classes.map(|index| CellClass::of(cells, index, 0.0)).collect();
        Self { cells, classes, surfaces, paths: Paths::through_cells(SIDE) }
    }

    /// Returns the class of a cell; what lies outside the grid is empty.
    #[inline]
    pub fn class(&self, [x, y]: [i64; 2]) -> CellClass {
        let inside = |v: i64, side: u32| (0..i64::from(side)).contains(&v);
        if !(inside(x, self.cells.width()) && inside(y, self.cells.height())) {
            return CellClass::Empty;
        }
        self.classes[self.index([x, y])]
    }

    fn index(&self, [x, y]: [i64; 2]) -> usize {
        y as usize * self.cells.width() as usize + x as usize
    }

    /// Returns what a ray sees of a cell with matter that it enters by a face: the radiance of what stops it, and the
    /// fractions of light that are stopped on a length and let pass.
    pub fn crossed(&self, at: [i64; 2], class: CellClass, face: usize, length: f32) -> [Rgb; 3] {
        let cell = self.index(at);
        let slot = self.surfaces.slot(cell);
        let matter = self.cells.matter(cell);
        let (sent_on, [stopped, passed]) = match class {
            CellClass::Medium => {
                let crossed = extinction(matter.opacity, matter.tint)
                    .map(|sigma| attenuation(sigma * length));
                let scattered = slot.map(|slot| self.surfaces.medium_scattered[slot]);
                (scattered, [crossed.map(|v| v.1), crossed.map(|v| v.0)])
            }
            _ => (slot.map(|slot| self.surfaces.wall_reflected[slot][face]), [[1.0; 3], [0.0; 3]]),
        };
        let sent_on = sent_on.unwrap_or_default();
        [[0, 1, 2].map(|c| matter.emission[c] + sent_on[c]), stopped, passed]
    }

    /// Returns the way of a wall through a square, at most 9×9.
    pub fn wall(&self, [left, top]: [i64; 2], side: u32) -> WallWay {
        let with_margin = side + 2;
        let at =
            |i: u32| [left + i64::from(i % with_margin) - 1, top + i64::from(i / with_margin) - 1];
        let is_solid = |i: u32| self.class(at(i)) == CellClass::Solid;
        let cells = (0..with_margin * with_margin).filter(|&i| is_solid(i));
        WallWay::of(cells.fold(0, |all, i| all | 1 << i), with_margin)
    }

    /// Reads the block with this first cell; what lies outside the grid is empty.
    pub fn read(&self, [left, top]: [i64; 2]) -> Found {
        let mut classes = [CellClass::Empty; WITH_MARGIN * WITH_MARGIN];
        for (i, class) in classes.iter_mut().enumerate() {
            let [x, y] = [i % WITH_MARGIN, i / WITH_MARGIN].map(|v| v as i64 - 1);
            *class = self.class([left + x, top + y]);
        }
        let inner = |i: usize| (i / SIDE + 1) * WITH_MARGIN + i % SIDE + 1;
        let own = |class: CellClass| (0..SIDE * SIDE).all(|i| classes[inner(i)] == class);
        if own(CellClass::Empty) {
            return Found::Empty;
        }
        let cell = |at: usize| {
            let [x, y] = [at % WITH_MARGIN, at / WITH_MARGIN].map(|v| v as i64 - 1);
            [left + x, top + y]
        };
        let mut block = Box::new(FarBlock::CLEAR);
        let mut reachable = false;
        for (slot, paths) in self.paths.of_slots.iter().enumerate() {
            let mut sum = PathSum::default();
            for path in paths {
                if classes[path.outside] == CellClass::Solid {
                    sum.hidden += path.weight;
                    continue;
                }
                sum.count += path.weight;
                let mut through = [path.weight; 3];
                for step in &path.steps {
                    let class = classes[step.cell];
                    if class == CellClass::Empty {
                        continue;
                    }
                    let [radiance, stopped, passed] =
                        self.crossed(cell(step.cell), class, step.face, step.length);
                    for c in 0..3 {
                        let stopped = through[c] * stopped[c];
                        sum.stopped[c] += stopped;
                        sum.sent[c] += stopped * radiance[c];
                        through[c] *= passed[c];
                    }
                    if class == CellClass::Solid {
                        break;
                    }
                }
            }
            if sum.count == 0.0 {
                block.sent[slot] = PackedRgb::HIDDEN;
                continue;
            }
            reachable = true;
            let count = sum.count + HIDDEN_WEIGHT * sum.hidden;
            let mean = |rgb: Rgb| PackedRgb::new(rgb.map(|v| v / count));
            block.sent[slot] = mean(sum.sent);
            block.stopped[slot] = mean(sum.stopped);
        }
        if !reachable {
            return Found::Solid;
        }
        Found::Matter { block, wall: self.wall([left, top], SIDE as u32) }
    }
}

/// The weight of a path that comes out of a wall in the mean of its slot. With 0 things that borders of blocks part look
/// too wide, because what is seen beside their front counts for all of the slot; with 1 slanting walls let light through.
pub const HIDDEN_WEIGHT: f32 = 0.1;

/// Sums over the paths in a slot.
#[derive(Default)]
struct PathSum {
    /// Weights of those from open space, and of those out of a wall.
    count: f32,
    hidden: f32,
    sent: Rgb,
    stopped: Rgb,
}
