//! The result of a plan.

use crate::methods::holographic::sky::ConeSky;
use crate::pipeline::Dispatch;
use crate::stage::Stage;
use wgpu::Buffer;

/// The dispatches of a frame, in order, and their results.
#[derive(Debug)]
pub struct PassList {
    pub dispatches: Vec<Dispatch>,
    /// Buffers that can be read back.
    pub stages: Vec<(Stage, Buffer)>,
    /// The buffer for lamps that are lit by rule, written before each frame.
    pub lamps: Option<Buffer>,
    /// The light of a panorama in cones, written before each frame in which it is another.
    pub sky: Option<ConeSky>,
}

impl PassList {
    /// A list that needs nothing written.
    pub fn new(dispatches: Vec<Dispatch>, stages: Vec<(Stage, Buffer)>) -> Self {
        Self { dispatches, stages, lamps: None, sky: None }
    }
}
