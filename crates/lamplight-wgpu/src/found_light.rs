//! Direct light that was found ([`crate::stages::direct`]), for methods to add to theirs.

use crate::pipeline::ComputePipelines;
use wgpu::Buffer;

/// The direct light of a plan.
#[derive(Clone, Debug)]
pub struct FoundLight<'a> {
    /// Those of [`crate::programs::ADD_DIRECT`].
    pub pipelines: &'a ComputePipelines,
    /// J of open cells and E/2 of faces, four values per cell.
    pub found: Buffer,
}

/// Entries of [`crate::programs::ADD_DIRECT`]: to the light of cells, and to scattered radiance.
pub const TO_LIGHT: usize = 0;
pub const TO_SCATTERED: usize = 1;
