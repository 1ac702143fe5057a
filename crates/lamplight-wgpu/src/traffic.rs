//! Bytes that a dispatch moves.

use std::iter::Sum;

/// Bytes that go to and from the GPU's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bytes that are read.
    pub read: u64,
    /// Bytes that are written.
    pub written: u64,
}

impl Sum for Traffic {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |a, b| Self {
            read: a.read + b.read,
            written: a.written + b.written,
        })
    }
}
