//! Devices for reports: those of this machine, and the one that computed something.

use std::fmt::{Display, Formatter, Result};

/// A GPU of this machine.
pub struct AdapterInfo {
    pub name: String,
    /// The interface that it is used by.
    pub api: &'static str,
    /// The kind of hardware, or software.
    pub kind: &'static str,
    pub driver: String,
    /// Most cells a side.
    pub side: u32,
    /// True if it can time each stage.
    pub times_stages: bool,
}

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
