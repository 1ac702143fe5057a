//! Rays that are the same from every cell: the cells that they cross, in order.
//!
//! Rays of a quadrant run from the centre line of one slab to that of another. From every row of a
//! slab a ray of one direction crosses the same cells relative to its start, over the same
//! lengths, so that they are found once for all of them.

use super::slabs::Face;

/// One cell on the way of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Slabs from the start.
    pub slab: usize,
    /// Rows from the start.
    pub row: isize,
    /// px of the way that lie in the cell.
    pub length: f32,
    /// How the ray enters it.
    pub face: Face,
}

impl Crossing {
    /// Where its cell is relative to the first one, `stride` cells from one slab to the next.
    fn offset(&self, stride: isize) -> isize {
        self.slab as isize * stride + self.row
    }
}

/// A crossing where the distance from one slab to the next is known.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// From the cell in which the ray starts.
    pub offset: isize,
    /// Which of the cells of its fan that is.
    pub cell: usize,
    /// px of the way that lie in the cell.
    pub length: f32,
    /// How the ray enters it.
    pub face: Face,
}

/// Rays that are to be followed together.
pub struct Rays {
    pub ways: Vec<Vec<Crossing>>,
    /// Other cells that count, from where the first starts.
    pub others: Vec<isize>,
}

/// Rays that are followed together.
#[derive(Debug)]
pub struct Bundle {
    pub rays: Vec<Vec<Step>>,
    /// Which of the cells of its fan they cross.
    pub cells: Vec<usize>,
}

/// Bundles of rays from the same cells.
#[derive(Debug, Default)]
pub struct Fan {
    pub bundles: Vec<Bundle>,
    /// All cells that any of them crosses, from where the first starts, in rising order.
    pub cells: Vec<isize>,
}

impl Fan {
    /// Bundle by bundle, `stride` cells from one slab to the next.
    pub fn new(bundles: &[Rays], stride: isize) -> Self {
        let offsets = |rays: &Rays| -> Vec<isize> {
            let crossed = rays.ways.iter().flatten().map(|crossing| crossing.offset(stride));
            crossed.chain(rays.others.iter().copied()).collect()
        };
        let mut fan = Self { bundles: Vec::new(), cells: sorted(bundles.iter().flat_map(offsets)) };
        let step = |crossing: &Crossing| {
            let offset = crossing.offset(stride);
            Step { offset, cell: fan.place(offset), length: crossing.length, face: crossing.face }
        };
        let bundle = |rays: &Rays| Bundle {
            rays: rays.ways.iter().map(|way| way.iter().map(step).collect()).collect(),
            cells: sorted(offsets(rays).into_iter().map(|offset| fan.place(offset))),
        };
        fan.bundles = bundles.iter().map(bundle).collect();
        fan
    }

    /// Which of the cells lies at an offset.
    pub fn place(&self, offset: isize) -> usize {
        self.cells.partition_point(|&cell| cell < offset)
    }

    /// Offsets of the cells of a bundle.
    pub fn offsets(&self, bundle: usize) -> impl Iterator<Item = isize> {
        self.bundles[bundle].cells.iter().map(|&cell| self.cells[cell])
    }
}

/// All of them in order, each once.
fn sorted<T: Ord>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut values: Vec<T> = values.collect();
    values.sort_unstable();
    values.dedup();
    values
}

/// The cells that a ray crosses on its way from the centre of a slab, `offset` px above the centre
/// of a row, to the centre of the slab `slabs` further on; `slope` is rows per slab.
///
/// A ray through the very corner of cells would have to choose a side; callers keep rays off them.
pub fn stencil(slabs: usize, slope: f64, offset: f64) -> Vec<Crossing> {
    let stretch = slope.hypot(1.0);
    let (mut at, mut slab, mut row) = (0.0, 0usize, (offset + 0.5).floor() as isize);
    let mut face = Face::Front;
    let mut crossings = Vec::new();
    loop {
        // Distances from the start, in slabs, at which the ray leaves the cell.
        let next_slab = (slab as f64 + 0.5).min(slabs as f64);
        let edge = row as f64 + if slope > 0.0 { 0.5 } else { -0.5 };
        let next_row = if slope == 0.0 { f64::INFINITY } else { (edge - offset) / slope };
        let next = next_slab.min(next_row);
        let length = ((next - at) * stretch) as f32;
        crossings.push(Crossing { slab, row, length, face });
        if next >= slabs as f64 {
            return crossings;
        }
        at = next;
        if next_row < next_slab {
            row += if slope > 0.0 { 1 } else { -1 };
            face = if slope > 0.0 { Face::Low } else { Face::High };
        } else {
            slab += 1;
            face = Face::Front;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_the_cells_under_the_ray_in_order() {
        for (slabs, slope, offset) in
            [(1, 0.0, 0.0), (3, 0.31, 0.0), (8, -0.97, 0.44), (8, 0.999, -0.49), (5, -0.125, 0.061)]
        {
            let crossings = stencil(slabs, slope, offset);
            let stretch = slope.hypot(1.0);
            let mut along = 0.0;
            for crossing in &crossings {
                let length = f64::from(crossing.length);
                let middle = (along + 0.5 * length) / stretch;
                along += length;
                assert_eq!((middle + 0.5).floor() as usize, crossing.slab);
                assert_eq!((offset + slope * middle + 0.5).floor() as isize, crossing.row);
            }
            assert!((along - slabs as f64 * stretch).abs() < 1e-5, "{along} px of {slabs}");
            assert_eq!(crossings[0].face, Face::Front);
            for pair in crossings.windows(2) {
                let step = (pair[1].slab - pair[0].slab, pair[1].row - pair[0].row);
                let face = match step {
                    (1, 0) => Face::Front,
                    (0, 1) => Face::Low,
                    (0, -1) => Face::High,
                    _ => panic!("a ray jumps by {step:?}"),
                };
                assert_eq!(pair[1].face, face);
            }
        }
    }
}
