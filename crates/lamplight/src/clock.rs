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

    /// Ends a stage. Laps of a stage that runs several times per frame are added.
    pub fn lap(&mut self, stage: &'static str) {
        let now = Instant::now();
        if let Some(last) = self.last.replace(now) {
            match self.laps.iter_mut().find(|(known, _)| *known == stage) {
                Some((_, time)) => *time += now - last,
                None => self.laps.push((stage, now - last)),
            }
        }
    }
}
