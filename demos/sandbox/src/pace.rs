//! Adaptive resolution of light, from measured frame times.
//!
//! The target is 60 frames per second. If frames are late for half a second, cells of light become a step
//! larger. If light on cells a step smaller would fit half of its budget for three seconds, they become
//! smaller. So the resolution settles.

/// Seconds per frame.
pub const FRAME: f64 = 1.0 / 60.0;
/// Seconds of light per frame. The rest is for the world, the window and the system.
pub const BUDGET: f64 = 0.012;
/// Frames longer than this are late. The tolerance absorbs jitter.
const LATE: f64 = 1.2 * FRAME;
/// Seconds of late frames after which light becomes coarser.
const PATIENCE: f64 = 0.5;
/// Seconds of early frames after which light becomes finer.
const CAUTION: f64 = 3.0;

/// Observes frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    late: f64,
    early: f64,
}

impl Pace {
    /// Returns the factor of [`lamplight::resample`] for the next frame, at most `max_factor`. `factor` is the
    /// present one, `frame` the seconds since the previous frame, and `light` the seconds of light, if known.
    ///
    /// If `light` is unknown, the factor never decreases: frames in time do not show how much time is left.
    pub fn advise(&mut self, frame: f64, light: Option<f64>, factor: u32, max_factor: u32) -> u32 {
        // The picture may have become smaller.
        let factor = factor.min(max_factor);
        // Frames while the window is dragged or hidden do not count.
        let frame = frame.clamp(0.0, 0.25);
        let finer = f64::from(factor) / f64::from((factor - 1).max(1));
        let foreseen = light.map(|seconds| seconds * finer * finer);
        let fits = foreseen.is_some_and(|seconds| seconds < 0.5 * BUDGET);
        // If frames are late for another reason, coarser light does not help.
        let to_blame = light.is_none_or(|seconds| seconds > 0.25 * BUDGET);
        self.late = if frame > LATE && to_blame { self.late + frame } else { 0.0 };
        self.early = if frame <= LATE && fits && factor > 1 { self.early + frame } else { 0.0 };
        if self.late > PATIENCE && factor < max_factor {
            *self = Self::default();
            return factor + 1;
        }
        if self.early > CAUTION {
            *self = Self::default();
            return factor - 1;
        }
        factor
    }
}
