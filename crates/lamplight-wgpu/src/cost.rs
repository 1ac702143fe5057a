//! What a frame costs, by the code's own account.

use crate::kernel::Dispatch;
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

/// What a frame takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Runs of kernels, in the order of the first of each.
    pub kernels: Vec<KernelCost>,
    /// Bytes of buffers, without the textures that hold the matter.
    pub memory: u64,
}

/// What all runs of an entry point take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelCost {
    /// The shader.
    pub shader: &'static str,
    /// Its entry point.
    pub entry: &'static str,
    /// How often it runs.
    pub dispatches: usize,
    /// Bytes that are moved: everything that a run reads or writes, once, as if caches kept it that
    /// long; without what depends on the matter (where rays go, the faces of walls).
    pub traffic: Traffic,
}

impl Cost {
    /// Runs of kernels.
    pub fn dispatches(&self) -> usize {
        self.kernels.iter().map(|kernel| kernel.dispatches).sum()
    }

    /// Bytes that all of them move.
    pub fn traffic(&self) -> Traffic {
        self.kernels.iter().map(|kernel| kernel.traffic).sum()
    }

    pub(crate) fn new<'a>(dispatches: impl Iterator<Item = &'a Dispatch>, memory: u64) -> Self {
        let mut kernels: Vec<KernelCost> = Vec::new();
        for Dispatch { kernel, traffic, .. } in dispatches {
            let name = (kernel.label, kernel.entry);
            match kernels.iter_mut().find(|known| (known.shader, known.entry) == name) {
                Some(known) => {
                    known.dispatches += 1;
                    known.traffic = [known.traffic, *traffic].into_iter().sum();
                }
                None => kernels.push(KernelCost {
                    shader: kernel.label,
                    entry: kernel.entry,
                    dispatches: 1,
                    traffic: *traffic,
                }),
            }
        }
        Self { kernels, memory }
    }
}
