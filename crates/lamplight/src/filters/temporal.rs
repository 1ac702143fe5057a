//! Mean over frames, with history dropped where what a cell sees has changed.
//!
//! A cell's light is the mean of its last frames, at most `frames` of them:
//! `mean += (light − mean) / min(age, frames)`. A still picture loses noise as 1/√frames or faster.
//!
//! History is rejected where the scene changed, not where the light looks different:
//! [`TemporalMean::mark`] compares the matter of every cell with the frame before, and the method reports
//! which cells see changed matter, or surfaces that see it. A lamp that goes out leaves no
//! trail, and cells that cannot see it keep their history. Rays are few and may miss a small lamp, so
//! a change that one cell sees counts for all cells within [`REACH`] px.
//!
//! Light that does not come from matter (the sky, inflow, suns and lamps that are lit exactly) may reach any cell: if some
//! of it comes, goes or has another brightness, all history is rejected. If it only moves, or other inflow enters, history
//! stays and fades: while a torch is carried, hardly any would be left.

use super::estimate::Estimate;
use crate::settings;
use crate::{Cells, Cone, Lamp, Moment, Rgb, Sun};

/// The distance from a cell that sees a change within which history is rejected, px.
pub const REACH: usize = 8;

/// The number of frames for which history is rejected if bounces feed back: an albedo of ½ leaves
/// 0.4 %.
pub const FEEDBACK: u8 = 8;

/// History, and its rejection.
#[derive(Debug, Default)]
pub struct TemporalMean {
    before: Option<Cells>,
    changed: Vec<bool>,
    mean: Vec<Rgb>,
    mean_moment: Vec<Moment>,
    age: Vec<u32>,
    /// The number of frames for which history is still rejected.
    rejected: Vec<u8>,
    columns: Vec<bool>,
}

impl TemporalMean {
    /// Returns the cells whose matter changed since the frame before; empty if rejection is off or there
    /// is no history.
    pub fn mark(&mut self, settings: &settings::Temporal, cells: &Cells) -> &[bool] {
        self.changed.clear();
        let Some(before) = self.before.as_mut() else {
            self.before = Some(cells.clone());
            return &self.changed;
        };
        let size = |c: &Cells| (c.width(), c.height());
        if size(before) != size(cells) || (settings.reject && !are_lit_alike(before, cells)) {
            self.age.clear();
        } else if settings.reject && !self.age.is_empty() {
            self.changed.extend((0..cells.len()).map(|i| before.matter(i) != cells.matter(i)));
        }
        before.clone_from(cells);
        &self.changed
    }

    /// Drops history.
    pub fn reset(&mut self) {
        self.age.clear();
    }

    /// Replaces the light by its mean over frames, and the variance by that of the mean.
    pub fn accumulate(
        &mut self,
        settings: &settings::Temporal,
        width: u32,
        feedback: bool,
        estimate: &mut Estimate,
    ) {
        let Estimate { light, moment, variance, invalidated } = estimate;
        let moments = moment.as_ref().map_or(0, Vec::len);
        if self.age.len() != light.len() || self.mean_moment.len() != moments {
            self.age.clear();
            self.mean.resize(light.len(), Rgb::default());
            self.mean_moment.resize(moments, Moment::default());
            self.rejected.clear();
        }
        self.age.resize(light.len(), 0);
        self.rejected.resize(light.len(), 0);
        if invalidated.contains(&true) {
            self.end_history(width as usize, invalidated, if feedback { FEEDBACK } else { 1 });
        }
        for (i, light) in light.iter_mut().enumerate() {
            if self.rejected[i] > 0 {
                self.rejected[i] -= 1;
                self.age[i] = 0;
            }
            self.age[i] = (self.age[i] + 1).min(settings.history_length);
            let weight = 1.0 / self.age[i] as f32;
            let mean = &mut self.mean[i];
            if self.age[i] == 1 {
                // Not by way of the old mean: its rounding is too coarse if it was bright.
                *mean = *light;
            }
            (0..3).for_each(|c| mean[c] += (light[c] - mean[c]) * weight);
            *light = *mean;
            variance[i] *= weight;
        }
        let moments = moment.iter_mut().flatten().zip(&mut self.mean_moment);
        for ((moment, mean), age) in moments.zip(&self.age) {
            if *age == 1 {
                *mean = *moment;
            }
            let weight = 1.0 / *age as f32;
            for (mean, moment) in mean.iter_mut().zip(&*moment) {
                (0..3).for_each(|c| mean[c] += (moment[c] - mean[c]) * weight);
            }
            *moment = *mean;
        }
    }

    /// Spreads `invalidated` over a box of [`REACH`] px, column by column and then row by row.
    fn end_history(&mut self, width: usize, invalidated: &[bool], frames: u8) {
        let height = invalidated.len() / width;
        self.columns.clear();
        self.columns.resize(invalidated.len(), false);
        for (i, _) in invalidated.iter().enumerate().filter(|(_, cell)| **cell) {
            let (x, y) = (i % width, i / width);
            for y in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
                self.columns[y * width + x] = true;
            }
        }
        for (i, _) in self.columns.iter().enumerate().filter(|(_, cell)| **cell) {
            let (x, row) = (i % width, i - i % width);
            let reached = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
            self.rejected[row..][reached].fill(frames);
        }
    }
}

/// Returns whether the same light reaches both grids from elsewhere than their matter, wherever it comes from.
fn are_lit_alike(a: &Cells, b: &Cells) -> bool {
    a.sky() == b.sky()
        && a.inflow().is_some() == b.inflow().is_some()
        && shine_alike([a.lamps(), b.lamps()], [a.suns(), b.suns()])
}

/// Returns whether exact lamps and suns are the same but for their places and directions.
pub fn shine_alike(lamps: [&[Lamp]; 2], suns: [&[Sun]; 2]) -> bool {
    let still = |lamp: &Lamp| {
        let cone = lamp.cone.map(|cone| Cone { direction: 0.0, ..cone });
        Lamp { position: [0.0; 2], cone, ..lamp.clone() }
    };
    let [lamps, others] = lamps.map(|lamps| lamps.iter().filter(|lamp| lamp.is_exact()).map(still));
    let [suns, other_suns] = suns.map(|suns| suns.iter().map(|sun| Sun { direction: 0.0, ..*sun }));
    lamps.eq(others) && suns.eq(other_suns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Direct;

    #[test]
    fn lights_are_alike_while_they_only_move_or_turn() {
        let lamp = Lamp { direct: Direct::Exact, ..Lamp::default() };
        let drawn = Lamp { direct: Direct::Glow, ..Lamp::default() };
        let moved = Lamp { position: [5.0, 6.0], ..lamp.clone() };
        let dim = Lamp { intensity: 0.5, ..lamp.clone() };
        let alike = |a: &[&Lamp], b: &[&Lamp]| {
            let [a, b] =
                [a, b].map(|lamps| lamps.iter().map(|&lamp| lamp.clone()).collect::<Vec<_>>());
            shine_alike([&a, &b], [&[], &[]])
        };
        assert!(alike(&[&lamp], &[&moved]));
        assert!(alike(&[&lamp, &drawn], &[&lamp]), "it is matter");
        assert!(!alike(&[&lamp], &[&dim]) && !alike(&[&lamp], &[]));
        let sun = Sun::default();
        let suns = |a: &[Sun], b: &[Sun]| shine_alike([&[], &[]], [a, b]);
        assert!(suns(&[sun], &[Sun { direction: 1.0, ..sun }]));
        assert!(!suns(&[sun], &[Sun { intensity: 0.0, ..sun }]) && !suns(&[], &[sun]));
    }
}
