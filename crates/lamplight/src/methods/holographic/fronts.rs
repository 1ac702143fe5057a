//! The open cells in front of walls, where the light on faces is gathered.

use super::slabs::Axis;
use crate::Cells;
use crate::stages::bounce::{NORMALS, Surfaces};

/// No face looks into the cell.
const NONE: u32 = u32::MAX;

/// Bits of the cells of the grid, 64 to a word, along both axes.
#[derive(Debug, Default)]
struct Bits {
    /// Words of a slab, by axis.
    words: [usize; 2],
    bits: [Vec<u64>; 2],
}

impl Bits {
    /// None of the cells, or all.
    fn fill(&mut self, [width, height]: [usize; 2], all: bool) {
        self.words = [height.div_ceil(64), width.div_ceil(64)];
        for (axis, [slabs, rows]) in [[width, height], [height, width]].into_iter().enumerate() {
            let (words, bits) = (self.words[axis], &mut self.bits[axis]);
            bits.clear();
            bits.resize(slabs * words, if all { u64::MAX } else { 0 });
            if all && rows % 64 != 0 {
                bits.chunks_exact_mut(words).for_each(|slab| slab[words - 1] >>= 64 - rows % 64);
            }
        }
    }

    fn unset(&mut self, x: usize, y: usize) {
        self.bits[0][x * self.words[0] + y / 64] &= !(1 << (y % 64));
        self.bits[1][y * self.words[1] + x / 64] &= !(1 << (x % 64));
    }

    fn set(&mut self, x: usize, y: usize) {
        self.bits[0][x * self.words[0] + y / 64] |= 1 << (y % 64);
        self.bits[1][y * self.words[1] + x / 64] |= 1 << (x % 64);
    }

    #[inline(always)]
    fn word(&self, axis: Axis, slab: usize, word: usize) -> u64 {
        self.bits[axis as usize][slab * self.words[axis as usize] + word]
    }
}

/// What is to be lit.
#[derive(Debug, Default)]
pub struct Fronts {
    slots: Vec<u32>,
    count: usize,
    open: Bits,
    before_faces: Bits,
    surfaces: Bits,
}

impl Fronts {
    /// Finds the open cells, and has no other ones.
    pub fn clear(&mut self, cells: &Cells) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        self.slots.clear();
        self.slots.resize(cells.len(), NONE);
        self.count = 0;
        self.before_faces.fill([w, h], false);
        self.surfaces.fill([w, h], false);
        self.open.fill([w, h], true);
        cells.for_each_solid(|i| self.open.unset(i % w, i / w));
    }

    /// Finds the cells in front of the faces of walls, and those of fog that send light on.
    pub fn collect(&mut self, cells: &Cells, surfaces: &Surfaces) {
        let w = cells.width() as usize;
        for wall in &surfaces.walls {
            for face in (0..4).filter(|&face| wall.exposed[face]) {
                let front = front(wall.cell as usize, face, w);
                if self.slots[front] == NONE {
                    self.slots[front] = self.count as u32;
                    self.count += 1;
                    self.before_faces.set(front % w, front / w);
                    self.surfaces.set(front % w, front / w);
                }
            }
        }
        for &i in &surfaces.fog {
            self.surfaces.set(i as usize % w, i as usize / w);
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Number of a cell in front of a face.
    #[inline(always)]
    pub fn slot(&self, cell: usize) -> usize {
        self.slots[cell] as usize
    }

    /// Bits of 64 rows of a slab: open cells, cells in front of faces, and those whose light
    /// surfaces need.
    #[inline(always)]
    pub fn bits(&self, axis: Axis, slab: usize, word: usize) -> [u64; 3] {
        [
            self.open.word(axis, slab, word),
            self.before_faces.word(axis, slab, word),
            self.surfaces.word(axis, slab, word),
        ]
    }
}

/// The cell in front of a face of a wall.
pub fn front(wall: usize, face: usize, width: usize) -> usize {
    let [x, y] = NORMALS[face];
    wall.wrapping_add_signed(y as isize * width as isize + x as isize)
}
