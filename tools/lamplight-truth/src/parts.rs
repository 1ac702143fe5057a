//! The reference part by part, for several machines and for callers that may stop before the end.

use crate::path_tracer::{Estimate, PathTracer, Tracer};
use crate::traverse::Grid;
use lamplight::internals::Walls;
use lamplight::internals::direct::clamp;
use lamplight::internals::elevation::longest_moment;
use lamplight::{Cells, Error, Light, Moment, Result, Rgb};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The most cells that a thread takes at a time, and between two calls of `progress`.
const CHUNK: usize = 128;
/// The fewest chunks per thread: a part ends when the last of them does.
const CHUNKS_PER_THREAD: usize = 16;

/// Cells prepared for the path tracer, which then finds their light part by part.
///
/// Random numbers depend only on the seed, the cell and the path. Parts of any sizes, found anywhere and put together in
/// order, have the bytes of [`PathTracer::render`].
pub struct Tracing<'c> {
    settings: PathTracer,
    /// The cells, with lamps drawn in.
    cells: Cow<'c, Cells>,
    grid: Grid,
}

/// The light that some cells receive, an entry per cell, before it sinks into walls.
#[derive(Clone, Debug, Default)]
pub struct Received {
    /// The light.
    pub rgb: Vec<Rgb>,
    /// Its standard error.
    pub standard_error: Vec<Rgb>,
    /// Its first moment; 0 in solid cells.
    pub moment: Vec<Moment>,
}

impl Received {
    /// Appends the part that follows.
    pub fn append(&mut self, mut next: Self) {
        self.rgb.append(&mut next.rgb);
        self.standard_error.append(&mut next.standard_error);
        self.moment.append(&mut next.moment);
    }
}

impl PathTracer {
    /// Prepares cells to be traced part by part.
    ///
    /// # Errors
    /// Like [`PathTracer::render`].
    pub fn prepare<'c>(&self, cells: &'c Cells) -> Result<Tracing<'c>> {
        self.check(cells)?;
        let cells = cells.drawn();
        let grid = Grid::new(&cells);
        Ok(Tracing { settings: *self, cells, grid })
    }
}

impl Tracing<'_> {
    /// Finds what the cells of a part receive: a range of [`Cells::index`], of which none but the grid's are traced.
    /// `progress` is called with the finished fraction of the part, from any thread and not always in order.
    pub fn trace(&self, part: Range<usize>, progress: &(dyn Fn(f32) + Sync)) -> Received {
        let cells = &*self.cells;
        let tracer = Tracer::new(&self.settings, cells, &self.grid);
        let width = cells.width() as usize;
        let part = part.start.min(cells.len())..part.end.min(cells.len());
        let total = part.len();
        let threads = rayon::current_num_threads();
        let size = (total / (CHUNKS_PER_THREAD * threads)).clamp(1, CHUNK);
        let done = AtomicUsize::new(0);
        let mut received = Received {
            rgb: vec![[0.0; 3]; total],
            standard_error: vec![[0.0; 3]; total],
            moment: vec![Moment::default(); total],
        };
        let Received { rgb, standard_error, moment } = &mut received;
        let chunks = rgb.par_chunks_mut(size).zip(standard_error.par_chunks_mut(size));
        chunks.zip(moment.par_chunks_mut(size)).enumerate().for_each(
            |(chunk, ((rgb, error), moment))| {
                for (k, ((rgb, error), moment)) in rgb.iter_mut().zip(error).zip(moment).enumerate()
                {
                    let i = part.start + chunk * size + k;
                    let at = [i % width, i / width].map(|v| v as i32);
                    let [light, x, y] = tracer.receive(at, |[x, y]| [1.0, x, y]);
                    (*rgb, *error) = light;
                    if !cells.is_solid(i) {
                        *moment = [x.0, y.0];
                    }
                }
                let done = done.fetch_add(rgb.len(), Ordering::Relaxed) + rgb.len();
                progress(done as f32 / total as f32);
            },
        );
        received
    }

    /// Makes light of all parts put together: lets it sink into walls.
    ///
    /// # Errors
    /// Returns an error unless there is one entry per cell.
    pub fn finish(&self, received: Received) -> Result<Estimate> {
        let Received { mut rgb, standard_error, mut moment } = received;
        let (cells, settings) = (&*self.cells, &self.settings);
        for found in [rgb.len(), standard_error.len(), moment.len()] {
            if found != cells.len() {
                let expected = format!("one entry per cell: {}", cells.len());
                return Err(Error::value("received", found, expected));
            }
        }
        let longest = longest_moment(cells.lamps(), cells.suns(), settings.elevation);
        clamp(&mut rgb, Some(&mut moment), longest);
        let mut walls = Walls::default();
        walls.sink_moment(cells, settings.wall_depth, &rgb, &mut moment);
        walls.sink(cells, settings.wall_depth, &mut rgb);
        let light = Light::from_pixels(cells, rgb)?.with_moment(moment, settings.elevation)?;
        Ok(Estimate { light, standard_error })
    }
}
