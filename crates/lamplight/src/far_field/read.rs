//! Blocks read from cells.

use super::block::{FarBlock, PackedRgb};
use super::paths::{Paths, SLOTS, direction};
use super::shut::is_cut;
use crate::grid::class::CellClass;
use crate::math::transmittance::{attenuation, extinction};
use crate::stages::faces::NORMALS;
use crate::{Cells, Rgb};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

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
        /// True if a wall cuts it in two.
        is_cut: bool,
        reflection: Option<Box<Reflection>>,
    },
}

/// The fractions of light that a block sends on of what it stops, by slot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reflection {
    /// Shares of the irradiance of its faces: of those that are entered along x, and along y.
    pub walls: [[PackedRgb; 2]; SLOTS],
    /// Shares of the mean radiance in its media, if it has any that scatter.
    pub media: Option<Box<[PackedRgb; SLOTS]>>,
    /// Open cells around the block, a bit each: along the left side from the top, along the right, along the top from
    /// the left, along the bottom.
    pub open: u16,
    /// The fraction of its faces that see as far as [`NEAR`], of those that are entered along x and along y by light from
    /// each of [`LOOKS`] directions, in 255ths.
    pub sees: [[u8; 2]; LOOKS],
}

/// Directions in which a block looks around.
pub const LOOKS: usize = 32;
/// The length on which cells next to faces are known, px.
pub const NEAR: f64 = 16.0;

/// Reads blocks of some cells.
#[derive(Debug)]
pub struct BlockReader<'a> {
    cells: &'a Cells,
    paths: Paths,
}

impl<'a> BlockReader<'a> {
    pub fn new(cells: &'a Cells) -> Self {
        Self { cells, paths: Paths::new(SIDE) }
    }

    /// Returns the class of a cell; what lies outside the grid is empty.
    pub fn class(&self, [x, y]: [i64; 2]) -> CellClass {
        let inside = |v: i64, side: u32| (0..i64::from(side)).contains(&v);
        if !(inside(x, self.cells.width()) && inside(y, self.cells.height())) {
            return CellClass::Empty;
        }
        CellClass::of(self.cells, self.index([x, y]), 0.0)
    }

    fn index(&self, [x, y]: [i64; 2]) -> usize {
        y as usize * self.cells.width() as usize + x as usize
    }

    /// Returns the emission and the albedo of a cell with matter, and the fractions of light that it stops on a length
    /// and lets pass.
    pub fn crossed(&self, at: [i64; 2], class: CellClass, length: f32) -> [Rgb; 4] {
        let matter = self.cells.matter(self.index(at));
        let [stopped, passed] = match class {
            CellClass::Medium => {
                let crossed = extinction(matter.opacity, matter.tint)
                    .map(|sigma| attenuation(sigma * length));
                [crossed.map(|v| v.1), crossed.map(|v| v.0)]
            }
            _ => [[1.0; 3], [0.0; 3]],
        };
        [matter.emission, matter.albedo, stopped, passed]
    }

    /// Returns the solid cells of a square, at most 8×8, a bit each.
    pub fn solid(&self, [left, top]: [i64; 2], side: u32) -> u64 {
        let at = |i: u32| [left + i64::from(i % side), top + i64::from(i / side)];
        let is_solid = |i: u32| self.class(at(i)) == CellClass::Solid;
        (0..side * side).filter(|&i| is_solid(i)).fold(0, |all, i| all | 1 << i)
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
        let mut walls = [[PackedRgb::default(); 2]; SLOTS];
        let mut media = [PackedRgb::default(); SLOTS];
        let (mut reachable, mut reflects, mut scatters) = (false, false, false);
        for (slot, paths) in self.paths.of_slots.iter().enumerate() {
            let mut sum = SlotSum::default();
            for path in paths.iter().filter(|path| classes[path.outside] != CellClass::Solid) {
                sum.count += path.weight;
                let mut through = [path.weight; 3];
                for step in &path.steps {
                    let class = classes[step.cell];
                    if class == CellClass::Empty {
                        continue;
                    }
                    let [emission, albedo, stopped, passed] =
                        self.crossed(cell(step.cell), class, step.length);
                    let stopped = [0, 1, 2].map(|c| through[c] * stopped[c]);
                    add(&mut sum.sent, stopped, emission);
                    (0..3).for_each(|c| through[c] *= passed[c]);
                    if class == CellClass::Solid {
                        add(&mut sum.walls[step.axis], stopped, albedo);
                        break;
                    }
                    add(&mut sum.media, stopped, albedo);
                }
                add(&mut sum.stopped, [1.0; 3], through.map(|v| path.weight - v));
            }
            if sum.count == 0.0 {
                block.sent[slot] = PackedRgb::HIDDEN;
                continue;
            }
            reachable = true;
            let mean = |rgb: Rgb| PackedRgb::new(rgb.map(|v| v / sum.count));
            block.sent[slot] = mean(sum.sent);
            block.stopped[slot] = mean(sum.stopped);
            let of_stopped = |rgb: Rgb| {
                let share = |c: usize| if rgb[c] > 0.0 { rgb[c] / sum.stopped[c] } else { 0.0 };
                PackedRgb::new([0, 1, 2].map(share))
            };
            walls[slot] = sum.walls.map(of_stopped);
            media[slot] = of_stopped(sum.media);
            reflects |= sum.walls != [[0.0; 3]; 2];
            scatters |= sum.media != [0.0; 3];
        }
        if !reachable {
            return Found::Solid;
        }
        let media = scatters.then(|| Box::new(media));
        let open = (0..4 * SIDE).filter(|&i| {
            let (side, along) = (i / SIDE, i % SIDE + 1);
            let across = if side % 2 == 0 { 0 } else { SIDE + 1 };
            let [x, y] = if side < 2 { [across, along] } else { [along, across] };
            classes[y * WITH_MARGIN + x] != CellClass::Solid
        });
        let open = open.fold(0, |all, i| all | 1 << i);
        let reflection = (reflects || scatters).then(|| {
            let sees = if reflects { self.sees([left, top]) } else { Default::default() };
            Box::new(Reflection { walls, media, open, sees })
        });
        let is_cut = is_cut(self.solid([left, top], SIDE as u32), SIDE as u32);
        Found::Matter { block, is_cut, reflection }
    }

    /// Finds how far the faces of a block see.
    fn sees(&self, [left, top]: [i64; 2]) -> [[u8; 2]; LOOKS] {
        let mut faces: [Vec<[i64; 2]>; 4] = Default::default();
        let side = SIDE as i64;
        let cells = (top..top + side).flat_map(|y| (left..left + side).map(move |x| [x, y]));
        for cell in cells.filter(|&cell| self.class(cell) == CellClass::Solid) {
            for (of_normal, normal) in faces.iter_mut().zip(NORMALS) {
                let front: [i64; 2] = std::array::from_fn(|a| cell[a] + i64::from(normal[a]));
                if self.class(front) != CellClass::Solid {
                    of_normal.push(front);
                }
            }
        }
        std::array::from_fn(|look| {
            let (sin, cos) = look_angle(look as f64 + 0.5).sin_cos();
            let way = [cos, sin];
            [0, 1].map(|axis| {
                let fronts = &faces[2 * axis + usize::from(way[axis] > 0.0)];
                let seen = fronts.iter().filter(|&&front| self.sees_from(front, axis, way)).count();
                (255 * seen / fronts.len().max(1)) as u8
            })
        })
    }

    /// Returns whether no solid cell stands near a face, from the cell in front of it on.
    fn sees_from(&self, front: [i64; 2], axis: usize, way: [f64; 2]) -> bool {
        let ahead = way.map(|v| if v > 0.0 { 1i64 } else { -1 });
        let mut from = front.map(|v| v as f64 + 0.5);
        from[axis] -= 0.5 * ahead[axis] as f64;
        let mut cell = front;
        let step = way.map(|v| 1.0 / v.abs().max(1e-9));
        let mut next: [f64; 2] = std::array::from_fn(|a| {
            let edge = cell[a] + i64::from(ahead[a] > 0);
            (edge as f64 - from[a]).abs() * step[a]
        });
        loop {
            let a = usize::from(next[1] < next[0]);
            if next[a] > NEAR {
                return true;
            }
            cell[a] += ahead[a];
            next[a] += step[a];
            if self.class(cell) == CellClass::Solid {
                return false;
            }
        }
    }
}

/// Returns the angle of a place among the directions in which a block looks around, radians.
pub fn look_angle(place: f64) -> f64 {
    TAU * place / LOOKS as f64
}

/// Sums over the paths of a slot.
#[derive(Default)]
struct SlotSum {
    count: f32,
    sent: Rgb,
    stopped: Rgb,
    walls: [Rgb; 2],
    media: Rgb,
}

fn add(sum: &mut Rgb, weight: Rgb, value: Rgb) {
    (0..3).for_each(|c| sum[c] += weight[c] * value[c]);
}

/// Returns the face by which a ray of a slot's direction enters a cell along an axis: left, right, top, bottom.
pub fn face(slot: usize, axis: usize) -> usize {
    2 * axis + usize::from(direction(slot / 2)[axis] < 0.0)
}
