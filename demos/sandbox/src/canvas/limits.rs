//! Limits of a canvas, which it checks and its errors state.

/// The largest number of cells: 1920×1080 and a little more.
pub const MAX_CELLS: u32 = 1 << 21;
/// The largest number of lamps.
pub const MAX_LAMPS: usize = 1024;
/// Most px of an image that is read: 4096×4096.
pub const MAX_PIXELS: u32 = 1 << 24;
