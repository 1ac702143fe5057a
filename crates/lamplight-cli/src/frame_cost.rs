//! The cost of a frame on the GPU, for reports.

use serde::Serialize;

/// The cost of a frame.
pub struct FrameCost {
    pub kernels: Vec<KernelCost>,
    pub bytes_held: u64,
}

/// The cost of all dispatches of an entry point.
#[derive(Serialize)]
pub struct KernelCost {
    pub shader: &'static str,
    pub entry: &'static str,
    pub dispatches: usize,
    pub bytes_read: u64,
    pub bytes_written: u64,
}

impl FrameCost {
    pub fn dispatches(&self) -> usize {
        self.kernels.iter().map(|kernel| kernel.dispatches).sum()
    }

    pub fn bytes_read(&self) -> u64 {
        self.kernels.iter().map(|kernel| kernel.bytes_read).sum()
    }

    pub fn bytes_written(&self) -> u64 {
        self.kernels.iter().map(|kernel| kernel.bytes_written).sum()
    }
}
