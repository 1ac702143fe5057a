//! A reference that improves pass by pass, for display while it is computed.

use crate::path_tracer::{BATCHES, PathTracer, Tracer};
use crate::traverse::Grid;
use lamplight::internals::Walls;
use lamplight::internals::direct::clamp;
use lamplight::{Cells, Light, Result, Rgb};
use rayon::prelude::*;

/// The mean over all passes of [`PathTracer`] so far.
///
/// A pass has 16 paths per cell. The error falls as 1/√passes or faster. The same seed gives the same
/// bytes, however the cells are divided among calls.
pub struct ProgressiveReference {
    settings: PathTracer,
    /// The cells, with lamps drawn in.
    cells: Cells,
    grid: Grid,
    /// The sums over the passes.
    sums: Vec<[f64; 3]>,
    /// The number of complete passes, and of finished cells in the current one.
    passes: u32,
    next: usize,
}

impl ProgressiveReference {
    /// A reference before its first pass. `samples` of the settings is ignored.
    ///
    /// # Errors
    /// Returns an error if the cells are invalid ([`Cells::check`]).
    pub fn new(settings: PathTracer, cells: &Cells) -> Result<Self> {
        let settings = PathTracer { samples: BATCHES, ..settings };
        settings.check(cells)?;
        let cells = cells.drawn().into_owned();
        let (grid, sums) = (Grid::new(&cells), vec![[0.0; 3]; cells.len()]);
        Ok(Self { settings, cells, grid, sums, passes: 0, next: 0 })
    }

    /// Computes `count` more cells, at most to the end of the current pass.
    pub fn refine(&mut self, count: usize) {
        let seed = self.settings.seed.wrapping_add(u64::from(self.passes));
        let settings = PathTracer { seed, ..self.settings };
        let tracer = Tracer::new(&settings, &self.cells, &self.grid).in_one_batch();
        let width = self.cells.width() as usize;
        let end = (self.next + count).min(self.sums.len());
        self.sums[self.next..end].par_iter_mut().enumerate().for_each(|(k, sum)| {
            let i = self.next + k;
            let [(light, _)] = tracer.receive([i % width, i / width].map(|v| v as i32), |_| [1.0]);
            (0..3).for_each(|c| sum[c] += f64::from(light[c]));
        });
        self.next = end;
        if end == self.sums.len() {
            (self.next, self.passes) = (0, self.passes + 1);
        }
    }

    /// The number of complete passes.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// The light so far, or none before the first pass is complete.
    pub fn light(&self) -> Option<Light> {
        if self.passes == 0 {
            return None;
        }
        let mean = |(i, sum): (usize, &[f64; 3])| {
            let count = f64::from(self.passes + u32::from(i < self.next));
            sum.map(|v| (v / count) as f32)
        };
        let mut rgb: Vec<Rgb> = self.sums.iter().enumerate().map(mean).collect();
        clamp(&mut rgb, None, 1.0);
        Walls::default().sink(&self.cells, self.settings.wall_depth, &mut rgb);
        Light::from_pixels(&self.cells, rgb).ok()
    }
}
