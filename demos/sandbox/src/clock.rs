//! A clock with fixed steps, so that a world does not depend on the frame rate.

use crate::worlds::{Input, STEP, World};

/// Accumulates seconds and converts them to steps.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    owed: f64,
    waiting: Input,
}

impl Clock {
    /// The largest number of steps per frame. Further time is dropped, so that a pause or a slow machine
    /// does not accumulate a backlog.
    pub const MAX_STEPS: u32 = 8;

    /// The steps due after further `seconds`. Negative and infinite seconds are ignored.
    pub fn advance(&mut self, seconds: f64) -> u32 {
        if seconds.is_finite() && seconds > 0.0 {
            self.owed += seconds;
        }
        // The tolerance makes six steps of 1/60 s six steps despite rounding.
        let due = ((self.owed / STEP + 1e-9) as u64).min(u64::from(Self::MAX_STEPS)) as u32;
        self.owed -= f64::from(due) * STEP;
        if self.owed >= STEP {
            self.owed = 0.0;
        }
        due
    }

    /// Advances a world by one frame and returns the number of steps.
    ///
    /// Events such as a press reach exactly one step: the first of the frame, or of a later frame if this
    /// one has no step.
    pub fn play(&mut self, world: &mut dyn World, seconds: f64, input: &Input) -> u32 {
        self.waiting = input.after(&self.waiting);
        let steps = self.advance(seconds);
        for _ in 0..steps {
            world.step(&self.waiting);
            self.waiting = self.waiting.held();
        }
        steps
    }
}
