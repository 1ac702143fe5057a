//! Frames in time: how coarse light has to be for them, by what frames took.
//!
//! Sixty frames a second are aimed at. When frames come late for half a second, light is found on cells a
//! step larger; when light would take less than half of a frame a step finer for three seconds, on smaller
//! ones. So it settles: a step finer is taken only where it is foreseen to fit.

/// Seconds of a frame.
pub const FRAME: f64 = 1.0 / 60.0;
/// Seconds of light in a frame; the rest is for the world, the window and the system.
pub const BUDGET: f64 = 0.012;
/// Frames later than this are late; clocks waver.
const LATE: f64 = 1.2 * FRAME;
/// Seconds of late frames until light gets coarser,
const PATIENCE: f64 = 0.5;
/// and of early ones until it gets finer.
const CAUTION: f64 = 3.0;

/// Watches frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    late: f64,
    early: f64,
}

impl Pace {
    /// A frame that came so many seconds after the one before, and its light took so many (none where
    /// nobody can tell): the factor of [`lamplight::coarse`] for the next, from the one at hand, at most
    /// `coarsest`.
    ///
    /// Without a word about light it never gets finer: late frames say what does not fit, frames in
    /// time say nothing.
    pub fn advise(&mut self, frame: f64, light: Option<f64>, factor: u32, coarsest: u32) -> u32 {
        // A frame that was dragged or switched away for a while says nothing.
        let frame = frame.clamp(0.0, 0.25);
        let finer = f64::from(factor) / f64::from((factor - 1).max(1));
        let foreseen = light.map(|seconds| seconds * finer * finer);
        let fits = foreseen.is_some_and(|seconds| seconds < 0.5 * BUDGET);
        // Late for another reason than light: coarser light would not help.
        let to_blame = light.is_none_or(|seconds| seconds > 0.25 * BUDGET);
        self.late = if frame > LATE && to_blame { self.late + frame } else { 0.0 };
        self.early = if frame <= LATE && fits && factor > 1 { self.early + frame } else { 0.0 };
        if self.late > PATIENCE && factor < coarsest {
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
