//! The device that computed something, for reports.

use std::fmt::{Display, Formatter, Result};

/// The device that computed something; displayed as the end of "lit by raymarch …".
#[derive(Clone, Debug)]
pub enum DeviceInfo {
    /// The CPU.
    Cpu { threads: usize },
    /// A GPU, by name; `has_clock` if it can time stages.
    Gpu { adapter: String, has_clock: bool },
}

impl DeviceInfo {
    /// The CPU, with the threads of the current pool.
    pub fn cpu() -> Self {
        Self::Cpu { threads: rayon::current_num_threads() }
    }

    /// The name in flags and JSON.
    pub fn backend(&self) -> &'static str {
        match self {
            Self::Cpu { .. } => "cpu",
            Self::Gpu { .. } => "gpu",
        }
    }

    /// A note on how frames are timed, unless the time is simply that of solving one.
    pub fn clock(&self) -> Option<&'static str> {
        match self {
            Self::Cpu { .. } => None,
            Self::Gpu { has_clock: true, .. } => {
                Some("by the GPU's own clock, without the transfers")
            }
            Self::Gpu { has_clock: false, .. } => {
                Some("from submission to completion, because this GPU has no clock")
            }
        }
    }
}

impl Display for DeviceInfo {
    fn fmt(&self, f: &mut Formatter) -> Result {
        match self {
            Self::Cpu { threads: 1 } => write!(f, "on the CPU, 1 thread"),
            Self::Cpu { threads } => write!(f, "on the CPU, {threads} threads"),
            Self::Gpu { adapter, .. } => write!(f, "on the GPU ({adapter})"),
        }
    }
}
