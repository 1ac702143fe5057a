//! Mean over frames.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{FOUR, ONE, Site, whole};
use lamplight::Settings;
use lamplight::settings::{BounceBy, Bounces, Hit};
use lamplight::stages::temporal::{FEEDBACK, REACH};
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Temporal {
    kernels: Kernels,
    /// Whether cells tell if they see a change.
    tracks: bool,
}

impl Temporal {
    /// Where history ends cell by cell: `traced` tells which see a change.
    pub fn tracks(settings: &Settings) -> bool {
        let temporal = &settings.temporal;
        temporal.frames > 1 && temporal.reject && settings.raymarch.hit == Hit::Edge
    }

    /// With `traced`, what the gather leaves there is read and its variance kept up.
    pub fn new(device: &Device, settings: &Settings, traced: bool) -> Self {
        use Slot::{Read, Uniform, Write};
        let slots = [Uniform, Write, Write, Write, Write, Write, Read];
        let temporal = &settings.temporal;
        let feedback =
            settings.bounces != Bounces::Count(0) && settings.raymarch.bounce == BounceBy::Feedback;
        let everywhere = settings.raymarch.hit == Hit::Distance;
        let constants = [
            ("FRAMES", f64::from(temporal.frames)),
            ("TRACED", f64::from(traced)),
            ("REJECTS", f64::from(temporal.reject)),
            ("EVERYWHERE", f64::from(everywhere)),
            ("REACH", REACH as f64),
            ("UNSETTLED", if feedback { f64::from(FEEDBACK) } else { 1.0 }),
        ];
        let entries = ["spread", "accumulate"];
        let kernels = Kernels::new(device, &shaders::TEMPORAL, &entries, &slots, &constants);
        Self { kernels, tracks: Self::tracks(settings) }
    }

    /// Replaces the light by its mean; `changed` is 1 where any cell changed.
    pub fn plan(
        &self,
        site: &Site,
        light: &Buffer,
        traced: &Buffer,
        changed: Option<&Buffer>,
    ) -> Result<Vec<Dispatch>> {
        let cells = site.cells();
        let history = site.kept("history", cells * FOUR)?;
        let unsettled = site.kept("unsettled", cells * ONE)?;
        let columns = site.buffer("columns", if self.tracks { cells } else { 1 } * ONE)?;
        let none;
        let changed = match changed {
            Some(changed) => changed,
            None => {
                none = site.buffer("no change", ONE)?;
                &none
            }
        };
        let resources = [light, traced, &history, &unsettled, &columns, changed].map(whole);
        let bound = site.bind(&self.kernels, &resources);
        let entries = if self.tracks { 0..2 } else { 1..2 };
        Ok(entries.map(|entry| site.over_cells(&self.kernels, entry, &bound, None)).collect())
    }
}
