//! Timing of the stages of a frame.

use std::time::Duration;
// The standard clock panics in a browser; this one uses the page's there.
use web_time::Instant;

/// A stopwatch with one lap per stage.
#[derive(Debug, Default)]
pub struct Clock {
    last: Option<Instant>,
    pub laps: Vec<(&'static str, Duration)>,
}

impl Clock {
    /// Starts a frame.
    pub fn start(&mut self) {
        self.laps.clear();
        self.last = Some(Instant::now());
    }

    /// Ends a stage. Laps of a stage that runs several times per frame are added. A clock that was not started keeps none,
    /// and allocates nothing.
    pub fn lap(&mut self, stage: &'static str) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            let last = std::mem::replace(last, now);
            match self.laps.iter_mut().find(|(known, _)| *known == stage) {
                Some((_, time)) => *time += now - last,
                None => self.laps.push((stage, now - last)),
            }
        }
    }
}
