//! What each stage of a frame takes.

use std::time::Duration;
// The standard one, and in a browser, where that has no clock, the page's.
use web_time::Instant;

/// A stop watch with a lap for each stage.
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

    /// Ends a stage; one that comes again in a frame adds up.
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
