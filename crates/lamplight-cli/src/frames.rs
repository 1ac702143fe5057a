//! Frames of the same cells on either device, to be timed and looked at.

use crate::error::Result;
use crate::gpu::{Gpu, GpuFrames};
use lamplight::{Cells, Light, Settings, Solver};
use std::time::{Duration, Instant};

/// Frames of the same cells.
pub enum Frames<'a> {
    /// On the CPU.
    Cpu(Box<Solver>, &'a Cells),
    /// On the GPU.
    Gpu(Box<GpuFrames<'a>>),
}

impl<'a> Frames<'a> {
    /// Frames on `gpu` or, without one, on the CPU.
    pub fn new(gpu: Option<&'a Gpu>, cells: &'a Cells, settings: Settings) -> Result<Self> {
        Ok(match gpu {
            Some(gpu) => Self::Gpu(Box::new(gpu.frames(cells, settings)?.0)),
            None => Self::Cpu(Box::new(Solver::new(settings)?), cells),
        })
    }

    /// Solves the next frame and returns the time it took.
    pub fn next(&mut self) -> Result<Duration> {
        match self {
            Self::Cpu(solver, cells) => {
                let start = Instant::now();
                solver.solve(cells)?;
                Ok(start.elapsed())
            }
            Self::Gpu(frames) => Ok(frames.next()?.iter().map(|(_, time)| *time).sum()),
        }
    }

    /// The light of the last frame.
    pub fn light(&self) -> Result<Light> {
        match self {
            Self::Cpu(solver, _) => Ok(solver.light().clone()),
            Self::Gpu(frames) => frames.light(),
        }
    }
}
