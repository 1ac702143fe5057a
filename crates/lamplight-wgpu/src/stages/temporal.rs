//! The mean over frames.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, whole};
use crate::{programs, shaders};
use lamplight::internals::temporal::{FEEDBACK, REACH};
use lamplight::settings::{Bounces, Hit, Raymarch};
use wgpu::Buffer;

/// The pipelines.
#[derive(Debug)]
pub struct Temporal {
    pipelines: ComputePipelines,
    /// True if cells report that they see a change.
    tracks: bool,
}

impl Temporal {
    /// Returns whether history is rejected cell by cell, from the changes that rays report.
    pub fn tracks(settings: &Raymarch) -> bool {
        let temporal = &settings.temporal;
        temporal.history_length > 1 && temporal.reject && settings.hit == Hit::Edge
    }

    /// Compiles the pipelines. With `traced`, the gather leaves variance and changes, and the variance is
    /// updated.
    pub fn new(
        compiler: &Compiler,
        settings: &Raymarch,
        bounces: Bounces,
        traced: bool,
        moment: bool,
    ) -> Self {
        let temporal = &settings.temporal;
        let everywhere = settings.hit == Hit::Distance;
        let constants = [
            ("HISTORY_LENGTH", f64::from(temporal.history_length)),
            ("TRACED", f64::from(traced)),
            ("REJECTS", f64::from(temporal.reject)),
            ("EVERYWHERE", f64::from(everywhere)),
            ("REACH", REACH as f64),
            (
                "REJECTED_FRAMES",
                if bounces == Bounces::Feedback { f64::from(FEEDBACK) } else { 1.0 },
            ),
            shaders::moment(moment),
        ];
        let pipelines = compiler.program(&programs::TEMPORAL, &constants);
        Self { pipelines, tracks: Self::tracks(settings) }
    }

    /// Plans the replacement of light by its mean. `any_changed` is 1 if any cell changed.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        light: &Buffer,
        traced: &Buffer,
        any_changed: Option<&Buffer>,
    ) -> Result<Vec<Dispatch>> {
        let cells = planner.cells();
        let history = planner.history::<[f32; 4]>("history", cells)?;
        let rejected = planner.history::<u32>("rejected", cells)?;
        let columns = planner.buffer::<u32>("columns", if self.tracks { cells } else { 1 })?;
        let none;
        let any_changed = match any_changed {
            Some(any_changed) => any_changed,
            None => {
                none = planner.buffer::<u32>("no change", 1)?;
                &none
            }
        };
        let moment = |label| {
            if planner.settings.moment {
                planner.history::<[f32; 4]>(label, cells)
            } else {
                planner.buffer::<[f32; 4]>(label, 1)
            }
        };
        let [x, y] = [moment("history of x")?, moment("history of y")?];
        let resources =
            [light, traced, &history, &rejected, &columns, any_changed, &x, &y].map(whole);
        let bound = planner.bind(&self.pipelines, &resources);
        let entries = if self.tracks { 0..2 } else { 1..2 };
        let plan = |entry| planner.over_cells(&self.pipelines, entry, &bound, None);
        Ok(entries.map(plan).collect())
    }
}
