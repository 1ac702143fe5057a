//! Bounces: a number of them, until light has converged, or one per frame.

use super::compare::Compare;
use super::convergence::Convergence;
use super::feedback::Feedback;
use crate::compiler::Compiler;
use crate::error::Result;
use crate::planner::FramePlanner;
use lamplight::Bounces;
use wgpu::Buffer;

/// Faces of a cell; a medium uses the first.
pub const FACES: u64 = 4;

/// The way in which light bounces, with the pipelines that only it needs: `C` compare the bounces of a frame, `F`
/// take over what the frame before has scattered.
#[derive(Debug)]
pub enum Bounce<C, F> {
    Times(u32),
    Converged(Convergence, C),
    Feedback(F),
}

impl<C, F> Bounce<C, F> {
    pub fn new(
        compiler: &Compiler,
        bounces: Bounces,
        compare: impl FnOnce() -> C,
        feedback: impl FnOnce() -> F,
    ) -> Self {
        match bounces {
            Bounces::Count(times) => Self::Times(times),
            Bounces::Converged => Self::Converged(Convergence::new(compiler), compare()),
            Bounces::Feedback => Self::Feedback(feedback()),
        }
    }

    /// Returns whether there are bounces.
    pub fn is_any(&self) -> bool {
        !matches!(self, Self::Times(0))
    }

    /// Returns whether media that scatter are crossed cell by cell from the start. It saves finding squares
    /// again in each of many bounces, most of which are recorded in vain; once a medium is lit its cells differ
    /// anyway.
    pub fn keeps_media_apart(&self) -> bool {
        matches!(self, Self::Converged(..))
    }

    /// Creates a buffer of scattered radiance, `count` values; of a single one if light does not bounce.
    pub fn buffer<T>(&self, planner: &FramePlanner, count: u64) -> Result<Buffer> {
        planner.buffer::<T>("scattered", if self.is_any() { count } else { 1 })
    }

    /// Creates a buffer like [`Self::buffer`], with the scattered radiance of the frame before if it is taken over.
    pub fn kept_buffer<T>(&self, planner: &FramePlanner, count: u64) -> Result<Buffer> {
        match self {
            Self::Feedback(_) => planner.kept_scattered::<T>(count),
            _ => self.buffer::<T>(planner, count),
        }
    }
}

impl Bounce<Compare, Feedback> {
    /// Bounces whose scattered radiance is stored in four floats.
    pub fn in_floats(compiler: &Compiler, bounces: Bounces) -> Self {
        Self::new(compiler, bounces, || Compare::new(compiler), || Feedback::new(compiler))
    }
}
