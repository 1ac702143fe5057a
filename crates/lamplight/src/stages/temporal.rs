//! Mean over frames, with history dropped where what a cell sees has changed.
//!
//! A cell's light is the mean of its last frames, at most `frames` of them:
//! `mean += (light − mean) / min(age, frames)`. A still picture loses noise as 1/√frames or faster.
//!
//! Rejection knows what changed, not what looks different: [`Temporal::mark`] compares the matter of
//! every cell with the frame before, the method reports which cells see changed matter (or surfaces
//! that see it), and their history ends. So a lamp that goes out leaves nothing behind, and cells
//! that cannot see it keep their history. Rays are few and may miss a small lamp, so what one cell
//! sees counts for all within [`REACH`] px.

use super::traced::Traced;
use crate::settings;
use crate::{Cells, Rgb};

/// px round a cell that sees a change within which history ends.
pub const REACH: usize = 8;

/// Frames that a bounce by feedback needs to forget: an albedo of ½ leaves 0.4 %.
pub const FEEDBACK: u8 = 8;

/// History and what ends it.
#[derive(Debug, Default)]
pub struct Temporal {
    before: Option<Cells>,
    changed: Vec<bool>,
    mean: Vec<Rgb>,
    age: Vec<u32>,
    /// Frames for which history still ends anew.
    unsettled: Vec<u8>,
    columns: Vec<bool>,
}

impl Temporal {
    /// Cells whose matter changed since the frame before; empty when rejection is off or nothing
    /// came before.
    pub fn mark(&mut self, settings: &settings::Temporal, cells: &Cells) -> &[bool] {
        self.changed.clear();
        let Some(before) = self.before.as_mut() else {
            self.before = Some(cells.clone());
            return &self.changed;
        };
        let size = |c: &Cells| (c.width(), c.height());
        if size(before) != size(cells) || (settings.reject && before.sky() != cells.sky()) {
            self.age.clear();
        } else if settings.reject {
            self.changed.extend((0..cells.len()).map(|i| before.matter(i) != cells.matter(i)));
        }
        before.clone_from(cells);
        &self.changed
    }

    /// Replaces the light by its mean over frames, and the variance by that of the mean.
    pub fn accumulate(
        &mut self,
        settings: &settings::Temporal,
        width: u32,
        feedback: bool,
        traced: &mut Traced,
    ) {
        let Traced { light, variance, stale } = traced;
        if self.age.len() != light.len() {
            self.age.clear();
            self.mean.resize(light.len(), Rgb::default());
            self.unsettled.clear();
        }
        self.age.resize(light.len(), 0);
        self.unsettled.resize(light.len(), 0);
        if stale.contains(&true) {
            self.end_history(width as usize, stale, if feedback { FEEDBACK } else { 1 });
        }
        for (i, light) in light.iter_mut().enumerate() {
            if self.unsettled[i] > 0 {
                self.unsettled[i] -= 1;
                self.age[i] = 0;
            }
            self.age[i] = (self.age[i] + 1).min(settings.frames);
            let share = 1.0 / self.age[i] as f32;
            let mean = &mut self.mean[i];
            if self.age[i] == 1 {
                // Not by way of the old mean: next to a bright one, rounding would swallow it.
                *mean = *light;
            }
            (0..3).for_each(|c| mean[c] += (light[c] - mean[c]) * share);
            *light = *mean;
            variance[i] *= share;
        }
    }

    /// Spreads `stale` over a box of [`REACH`] px, column by column and then row by row.
    fn end_history(&mut self, width: usize, stale: &[bool], frames: u8) {
        let height = stale.len() / width;
        self.columns.clear();
        self.columns.resize(stale.len(), false);
        for (i, _) in stale.iter().enumerate().filter(|(_, stale)| **stale) {
            let (x, y) = (i % width, i / width);
            for y in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
                self.columns[y * width + x] = true;
            }
        }
        for (i, _) in self.columns.iter().enumerate().filter(|(_, stale)| **stale) {
            let (x, row) = (i % width, i - i % width);
            let reached = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
            self.unsettled[row..][reached].fill(frames);
        }
    }
}
