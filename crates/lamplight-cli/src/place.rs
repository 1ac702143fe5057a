//! Where something was computed.

use crate::args::threads_in_words;
use std::fmt::{Display, Formatter, Result};

/// Where something was computed; shown as what follows "lit by raymarch".
#[derive(Clone, Debug)]
pub enum Place {
    /// The CPU.
    Cpu { threads: usize },
    /// A GPU, by name; whether it can tell what stages take.
    Gpu { adapter: String, has_clock: bool },
}

impl Place {
    /// The CPU, with the threads of the pool this is called in.
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

    /// What a time of a frame is, where it is not simply that of solving it.
    pub fn clock(&self) -> Option<&'static str> {
        match self {
            Self::Cpu { .. } => None,
            Self::Gpu { has_clock: true, .. } => {
                Some("by the GPU's own clock, without what goes there and comes back")
            }
            Self::Gpu { has_clock: false, .. } => {
                Some("from handing it to the GPU until that is done, which has no clock to ask")
            }
        }
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter) -> Result {
        match self {
            Self::Cpu { threads } => write!(f, "on the CPU, {}", threads_in_words(*threads)),
            Self::Gpu { adapter, .. } => write!(f, "on the GPU ({adapter})"),
        }
    }
}
