//! The size of a grid that a device can light.

use crate::error::{PrepareError, Result};
use wgpu::Device;

/// Rejects a grid of more columns or rows than the textures of a device have, before a host makes its own for it.
///
/// # Errors
/// Returns [`PrepareError::TooLarge`], as [`crate::Lighting::prepare`] would.
pub fn check_grid(device: &Device, size: [u32; 2]) -> Result<()> {
    GridSize::new(device, size).map(|_| ())
}

/// Columns and rows, checked once against the limits of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSize {
    pub width: u32,
    pub height: u32,
}

impl GridSize {
    /// Checks a size against the largest texture of a device.
    pub fn new(device: &Device, [width, height]: [u32; 2]) -> Result<Self> {
        let size = Self { width, height };
        let (side, most) = (width.max(height), device.limits().max_texture_dimension_2d);
        if side > most {
            return Err(size.too_large("px a side", side.into(), most.into()));
        }
        Ok(size)
    }

    /// The number of cells.
    pub fn cells(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// The error that a grid of this size needs more than the device allows.
    pub fn too_large(self, what: &'static str, needed: u64, allowed: u64) -> PrepareError {
        PrepareError::TooLarge { width: self.width, height: self.height, what, needed, allowed }
    }
}

impl From<GridSize> for [u32; 2] {
    fn from(size: GridSize) -> Self {
        [size.width, size.height]
    }
}
