//! Samples the GPU time of lighting and warns if it exceeds the frame budget.

use bevy::log::warn;
use lamplight_wgpu::Timer;
use lamplight_wgpu::error::RecordError;
use lamplight_wgpu::wgpu::{CommandEncoder, Device, Queue};
use std::time::Duration;

/// The frame budget: 60 frames per second.
const FRAME: Duration = Duration::from_nanos(16_666_667);
/// Frames per timed frame. Timing makes a frame slightly slower.
const EVERY: u64 = 64;
/// Consecutive timed frames over the budget that cause a warning.
const PATIENCE: u32 = 3;

/// The frame budget of one camera.
pub struct Budget {
    /// `None` if the adapter has no timestamps.
    timer: Option<Timer>,
    frame: u64,
    late: LateFrames,
}

impl Budget {
    /// A budget of which nothing is spent.
    pub fn new(device: &Device, queue: &Queue) -> Self {
        Self { timer: Timer::new(device, queue), frame: 0, late: LateFrames::default() }
    }

    /// Records lighting, in some frames with timestamps. Warns once if it is over the budget.
    pub fn record(
        &mut self,
        lighting: &lamplight_wgpu::Lighting,
        encoder: &mut CommandEncoder,
    ) -> Result<(), RecordError> {
        self.frame += 1;
        let is_timed = self.frame.is_multiple_of(EVERY) && !self.late.has_warned;
        let Some(timer) = self.timer.as_mut().filter(|_| is_timed) else {
            return lighting.record(encoder);
        };
        if let Some(warning) = self.late.observe(timer.read()) {
            warn!("{warning}");
        }
        lighting.record_timed(encoder, timer)
    }
}

/// Counts late frames and decides when to warn.
#[derive(Default)]
struct LateFrames {
    /// Consecutive timed frames over the budget.
    count: u32,
    has_warned: bool,
}

impl LateFrames {
    /// Counts a timed frame. Returns the warning when enough frames in a row were late, once.
    fn observe(&mut self, stages: &[(&str, Duration)]) -> Option<String> {
        let total: Duration = stages.iter().map(|(_, time)| *time).sum();
        self.count = if total > FRAME { self.count + 1 } else { 0 };
        if self.has_warned || self.count < PATIENCE {
            return None;
        }
        self.has_warned = true;
        Some(warning(total, stages))
    }
}

fn warning(total: Duration, stages: &[(&str, Duration)]) -> String {
    let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
    let slowest = stages.iter().max_by_key(|(_, time)| *time);
    let slowest = slowest.map_or(String::new(), |(stage, time)| {
        format!(", {:.1} of them in `{stage}`", milliseconds(*time))
    });
    format!(
        "the light of a camera takes {:.1} ms{slowest}, and a frame at 60 Hz has {:.1}. Larger cells \
         (`CellSize`), a smaller border, fewer bounces or a faster preset make it quicker",
        milliseconds(total),
        milliseconds(FRAME),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_late_frames_in_a_row_cause_one_warning() {
        let (late, quick) = ([("gather", FRAME * 2)], [("gather", FRAME / 2)]);
        let mut frames = LateFrames::default();
        let mut warnings = |observed: &[&[(&str, Duration)]]| {
            observed.iter().filter_map(|stages| frames.observe(stages)).count()
        };
        assert_eq!(warnings(&[&late, &late, &quick, &late, &late, &[]]), 0);
        assert_eq!(warnings(&[&late, &late]), 0);
        assert_eq!(warnings(&[&late]), 1);
        assert_eq!(warnings(&[&late, &late, &late, &late]), 0);
    }

    #[test]
    fn the_warning_has_figures_and_advice() {
        let stages = [("trace", Duration::from_millis(3)), ("gather", Duration::from_millis(21))];
        let text = warning(Duration::from_millis(24), &stages);
        for part in ["24.0 ms", "21.0 of them in `gather`", "16.7", "CellSize"] {
            assert!(text.contains(part), "{text}");
        }
    }
}
