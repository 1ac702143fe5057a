//! The cost of a frame, as counted by the code.

use crate::pipeline::Dispatch;
use crate::traffic::Traffic;

/// The cost of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cost {
    /// The cost of each pipeline, in the order of their first dispatches.
    pub pipelines: Vec<PipelineCost>,
    /// Bytes of buffers, without the textures of the matter.
    pub memory: u64,
}

/// The cost of all dispatches of an entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PipelineCost {
    /// The shader's name.
    pub shader: &'static str,
    /// The entry point.
    pub entry: &'static str,
    /// The number of dispatches.
    pub dispatches: usize,
    /// Bytes that are moved: everything that a dispatch reads or writes, once, as if caches kept it that long;
    /// without what depends on the matter (the paths of rays, the faces of solid cells).
    pub traffic: Traffic,
}

impl Cost {
    /// The number of all dispatches.
    pub fn dispatches(&self) -> usize {
        self.pipelines.iter().map(|pipeline| pipeline.dispatches).sum()
    }

    /// Bytes that all dispatches move.
    pub fn traffic(&self) -> Traffic {
        self.pipelines.iter().map(|pipeline| pipeline.traffic).sum()
    }

    pub(crate) fn new<'a>(dispatches: impl Iterator<Item = &'a Dispatch>, memory: u64) -> Self {
        let mut pipelines: Vec<PipelineCost> = Vec::new();
        for Dispatch { pipeline, traffic, .. } in dispatches {
            let name = (pipeline.label, pipeline.entry);
            match pipelines.iter_mut().find(|known| (known.shader, known.entry) == name) {
                Some(known) => {
                    known.dispatches += 1;
                    known.traffic = [known.traffic, *traffic].into_iter().sum();
                }
                None => pipelines.push(PipelineCost {
                    shader: pipeline.label,
                    entry: pipeline.entry,
                    dispatches: 1,
                    traffic: *traffic,
                }),
            }
        }
        Self { pipelines, memory }
    }
}
