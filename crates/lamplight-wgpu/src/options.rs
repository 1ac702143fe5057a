//! How the GPU goes about it: what changes the cost of light, never the light.

use crate::{Error, Result};

/// For programs that measure; the default is the fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// `holographic`: levels that one dispatch makes, 1 to 4. Those in between never leave the GPU's
    /// workgroup memory, so that with 4 about half as many bytes are moved as with 1.
    pub fused_levels: u32,
}

impl Options {
    /// The most levels that fit into 16 KiB of workgroup memory.
    pub const MOST_FUSED: u32 = 4;

    pub(crate) fn check(self) -> Result<()> {
        if (1..=Self::MOST_FUSED).contains(&self.fused_levels) {
            return Ok(());
        }
        Err(Error::Option { name: "fused_levels", value: self.fused_levels, range: "from 1 to 4" })
    }
}

impl Default for Options {
    fn default() -> Self {
        Self { fused_levels: Self::MOST_FUSED }
    }
}
