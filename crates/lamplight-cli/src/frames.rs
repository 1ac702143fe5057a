//! One frame after another, for who looks at what came of some and times the others.

use crate::failure::Outcome;
use crate::gpu::{self, Gpu};
use lamplight::{Cells, Light, Settings, Solver};
use std::time::{Duration, Instant};

/// Frames of some cells.
pub enum Frames<'a> {
    /// On the CPU.
    Cpu(Box<Solver>, &'a Cells),
    /// On the GPU.
    Gpu(Box<gpu::Frames<'a>>),
}

impl<'a> Frames<'a> {
    /// On that GPU or the CPU.
    pub fn new(gpu: Option<&'a Gpu>, cells: &'a Cells, settings: Settings) -> Outcome<Self> {
        Ok(match gpu {
            Some(gpu) => Self::Gpu(Box::new(gpu.frames(cells, settings)?.0)),
            None => Self::Cpu(Box::new(Solver::new(settings)?), cells),
        })
    }

    /// Solves the next frame, and says what it took.
    pub fn next(&mut self) -> Outcome<Duration> {
        match self {
            Self::Cpu(solver, cells) => {
                let start = Instant::now();
                solver.solve(cells)?;
                Ok(start.elapsed())
            }
            Self::Gpu(frames) => Ok(frames.next()?.iter().map(|(_, time)| *time).sum()),
        }
    }

    /// The light of the last one.
    pub fn light(&self) -> Outcome<Light> {
        match self {
            Self::Cpu(solver, _) => Ok(solver.light().clone()),
            Self::Gpu(frames) => frames.light(),
        }
    }
}
