//! What light takes of a frame, measured now and then, and a word where that is too much.

use bevy::log::warn;
use lamplight_wgpu::Timer;
use lamplight_wgpu::wgpu::{CommandEncoder, Device, Queue};
use std::time::Duration;

/// A frame in time.
const FRAME: Duration = Duration::from_nanos(16_666_667);
/// Frames between those that are timed: a timed frame is a little slower.
const EVERY: u64 = 64;
/// Timed frames that come late one after the other until it is said.
const PATIENCE: u32 = 3;

/// Watches what a camera's light takes.
pub struct Budget {
    /// None where the adapter cannot tell.
    timer: Option<Timer>,
    frame: u64,
    judge: Judge,
}

impl Budget {
    pub fn new(device: &Device, queue: &Queue) -> Self {
        Self { timer: Timer::new(device, queue), frame: 0, judge: Judge::default() }
    }

    /// Records light, timed or not; says once where it takes more than a frame has.
    pub fn record(&mut self, lighting: &lamplight_wgpu::Lighting, encoder: &mut CommandEncoder) {
        self.frame += 1;
        let is_timed = self.frame.is_multiple_of(EVERY) && !self.judge.told;
        let Some(timer) = self.timer.as_mut().filter(|_| is_timed) else {
            return lighting.record(encoder);
        };
        if let Some(words) = self.judge.hear(timer.read()) {
            warn!("{words}");
        }
        lighting.record_timed(encoder, timer);
    }
}

/// Decides when there is something to say.
#[derive(Default)]
struct Judge {
    /// Frames, one after the other.
    late: u32,
    told: bool,
}

impl Judge {
    /// What is to be said of a frame that was timed: once, when several were late.
    fn hear(&mut self, stages: &[(&str, Duration)]) -> Option<String> {
        let taken: Duration = stages.iter().map(|(_, time)| *time).sum();
        self.late = if taken > FRAME { self.late + 1 } else { 0 };
        if self.told || self.late < PATIENCE {
            return None;
        }
        self.told = true;
        Some(too_much(taken, stages))
    }
}

/// What is said.
fn too_much(taken: Duration, stages: &[(&str, Duration)]) -> String {
    let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
    let slowest = stages.iter().max_by_key(|(_, time)| *time);
    let slowest = slowest.map_or(String::new(), |(stage, time)| {
        format!(", {:.1} of them in `{stage}`", milliseconds(*time))
    });
    format!(
        "the light of a camera takes {:.1} ms{slowest}, and a frame at 60 Hz has {:.1}. Larger cells \
         (`CellSize`), a smaller border, fewer bounces or a faster preset make it quicker",
        milliseconds(taken),
        milliseconds(FRAME),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_frames_are_told_of_once_and_a_single_one_is_not() {
        let (late, quick) = ([("hop", FRAME * 2)], [("hop", FRAME / 2)]);
        let mut judge = Judge::default();
        let mut hear = |frames: &[&[(&str, Duration)]]| {
            frames.iter().filter_map(|stages| judge.hear(stages)).count()
        };
        assert_eq!(hear(&[&late, &late, &quick, &late, &late, &[]]), 0);
        assert_eq!(hear(&[&late, &late]), 0);
        assert_eq!(hear(&[&late]), 1);
        assert_eq!(hear(&[&late, &late, &late, &late]), 0);
    }

    #[test]
    fn what_is_too_much_is_said_with_figures_and_what_to_do() {
        let stages = [("trace", Duration::from_millis(3)), ("hop", Duration::from_millis(21))];
        let text = too_much(Duration::from_millis(24), &stages);
        for part in ["24.0 ms", "21.0 of them in `hop`", "16.7", "CellSize"] {
            assert!(text.contains(part), "{text}");
        }
    }
}
