//! Limits on the size of a grid, which [`crate::Cells`] checks and [`crate::Error`] states.

/// The longest side, so that squared distances fit 31 bits.
pub(crate) const MAX_SIDE: u32 = 16_384;
/// The largest number of cells, so that an index is exact in 32-bit float: about 1 GiB of matter.
pub(crate) const MAX_CELLS: u64 = 1 << 24;
