//! Samples the time of lighting, chooses the quality by it ([`LightQuality::Auto`]), and warns if it exceeds the frame budget.

use crate::components::LightQuality;
use bevy::log::warn;
use lamplight_wgpu::error::RecordError;
use lamplight_wgpu::wgpu::{CommandEncoder, Device, Queue};
use lamplight_wgpu::{Backend, Timer};
use std::time::Duration;

/// The frame budget: 60 frames per second.
const FRAME: Duration = Duration::from_nanos(16_666_667);
/// Frames per timed frame on the GPU, and while a quality is chosen. Timing makes a frame slightly slower.
const EVERY: u64 = 64;
const EVERY_OF_CHOICE: u64 = 16;
/// Consecutive timed frames over the budget that cause a warning.
const PATIENCE: u32 = 3;

/// The frame budget of one camera.
#[derive(Default)]
pub struct Budget {
    /// `None` before the camera is lit, and if the adapter has no timestamps.
    timer: Option<Timer>,
    frame: u64,
    late: LateFrames,
    /// If a quality has to be chosen, or was.
    quality: Option<AutoQuality>,
}

impl Budget {
    /// Measures frames on a device from now on.
    pub fn measure(&mut self, device: &Device, queue: &Queue) {
        self.timer = Timer::new(device, queue);
    }

    /// Returns the quality that is wanted, chosen if it is `Auto`.
    pub fn quality(&mut self, wanted: LightQuality) -> LightQuality {
        if wanted != LightQuality::Auto {
            self.quality = None;
            return wanted;
        }
        self.quality.get_or_insert_default().chosen()
    }

    /// Takes account of the stages of a frame on the CPU, if it found light in it.
    pub fn spend(&mut self, stages: &[(&str, Duration)]) {
        if let Some(quality) = self.quality.as_mut().filter(|_| !stages.is_empty()) {
            quality.observe_on_cpu(total(stages));
        }
    }

    /// Records lighting, in some frames with timestamps. Warns once if it is over the budget.
    pub fn record(
        &mut self,
        lighting: &lamplight_wgpu::Lighting,
        encoder: &mut CommandEncoder,
    ) -> Result<(), RecordError> {
        self.frame += 1;
        let choice = self.quality.as_mut().filter(|quality| !quality.is_lowest());
        let (every, has_use) = match choice {
            Some(_) => (EVERY_OF_CHOICE, true),
            None => (EVERY, !self.late.has_warned),
        };
        let on_gpu = lighting.backend() != Backend::Cpu;
        let is_timed = on_gpu && has_use && self.frame.is_multiple_of(every);
        let Some(timer) = self.timer.as_mut().filter(|_| is_timed) else {
            return lighting.record(encoder);
        };
        let stages = timer.read();
        if let Some(quality) = choice {
            quality.observe(total(stages), PATIENCE);
        } else if let Some(warning) = self.late.observe(stages) {
            warn!("{warning}");
        }
        lighting.record_timed(encoder, timer)
    }
}

/// Consecutive slow frames on the CPU, where every frame is timed and the first allocate memory, that change the quality.
const FRAMES_ON_CPU: u32 = 12;

/// The qualities from which one is chosen, each with the time from which on its light is too slow: half of a frame, and
/// all of it, since the last one is seen to be softer.
const QUALITIES: [(LightQuality, Duration); 3] = [
    (LightQuality::Default, Duration::from_millis(8)),
    (LightQuality::Fast, FRAME),
    (LightQuality::Coarse, Duration::MAX),
];

/// The choice of a quality.
#[derive(Default)]
struct AutoQuality {
    /// Consecutive slow frames.
    slow: u32,
    /// The index of the quality.
    chosen: usize,
}

impl AutoQuality {
    /// Takes account of a frame. So many slow ones in a row change the quality, for good.
    fn observe(&mut self, time: Duration, patience: u32) {
        let (_, limit) = QUALITIES[self.chosen];
        self.slow = if time > limit { self.slow + 1 } else { 0 };
        if self.slow >= patience {
            (self.slow, self.chosen) = (0, self.chosen + 1);
        }
    }

    /// Takes account of a frame on the CPU. `Coarse` saves memory traffic, which the CPU does not wait for, so it is not
    /// chosen there.
    fn observe_on_cpu(&mut self, time: Duration) {
        if self.chosen() == LightQuality::Default {
            self.observe(time, FRAMES_ON_CPU);
        }
    }

    fn chosen(&self) -> LightQuality {
        QUALITIES[self.chosen].0
    }

    fn is_lowest(&self) -> bool {
        self.chosen + 1 == QUALITIES.len()
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
        let total = total(stages);
        self.count = if total > FRAME { self.count + 1 } else { 0 };
        if self.has_warned || self.count < PATIENCE {
            return None;
        }
        self.has_warned = true;
        Some(warning(total, stages))
    }
}

fn total(stages: &[(&str, Duration)]) -> Duration {
    stages.iter().map(|(_, time)| *time).sum()
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
    fn slow_frames_in_a_row_change_the_quality_for_good() {
        let mut quality = AutoQuality::default();
        let mut chosen = |milliseconds: &[u64]| {
            let times = milliseconds.iter().map(|&time| Duration::from_millis(time));
            times.for_each(|time| quality.observe(time, 3));
            quality.chosen()
        };
        assert_eq!(chosen(&[9, 9, 8, 90, 90, 8]), LightQuality::Default);
        assert_eq!(chosen(&[9, 9, 9]), LightQuality::Fast);
        assert_eq!(chosen(&[16; 9]), LightQuality::Fast, "less than a frame");
        assert_eq!(chosen(&[17, 17, 16, 17, 17, 16]), LightQuality::Fast);
        assert_eq!(chosen(&[17; 3]), LightQuality::Coarse);
        assert_eq!(chosen(&[1000; 9]), LightQuality::Coarse);
        assert_eq!(chosen(&[1; 100]), LightQuality::Coarse);
        let mut on_cpu = AutoQuality::default();
        (0..100).for_each(|_| on_cpu.observe_on_cpu(Duration::from_secs(1)));
        assert_eq!(on_cpu.chosen(), LightQuality::Fast);
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
