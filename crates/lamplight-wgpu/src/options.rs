//! Options of the GPU. They affect performance, never the result.

use crate::error::CreateError;

/// Creation options of [`crate::Lighting`], for programs that measure; the default is the fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightingOptions {
    /// `holographic`: levels per dispatch, 1 to 3. Intermediate levels stay in workgroup memory, so 3 moves
    /// about half as many bytes as 1.
    pub fused_levels: u32,
}

impl LightingOptions {
    /// The most levels that fit into 16 KiB of workgroup memory.
    pub const MAX_FUSED_LEVELS: u32 = 3;

    pub(crate) fn check(self) -> Result<(), CreateError> {
        if (1..=Self::MAX_FUSED_LEVELS).contains(&self.fused_levels) {
            return Ok(());
        }
        let (name, range) = ("fused_levels", "from 1 to 3");
        Err(CreateError::Option { name, value: self.fused_levels, range })
    }
}

impl Default for LightingOptions {
    fn default() -> Self {
        Self { fused_levels: Self::MAX_FUSED_LEVELS }
    }
}
