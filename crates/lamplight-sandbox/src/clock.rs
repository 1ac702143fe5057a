//! Fixed steps out of seconds, so that a world does not depend on the frame rate.

use crate::worlds::{Input, World};

/// Collects seconds and says how many steps they are worth.
#[derive(Clone, Debug, Default)]
pub struct Clock {
    owed: f64,
    waiting: Input,
}

impl Clock {
    /// Seconds of one step.
    pub const STEP: f64 = 1.0 / 60.0;
    /// Most steps that one frame makes up for; what is owed beyond is forgotten, so that a pause
    /// or a slow machine does not fall ever further behind.
    pub const MOST: u32 = 8;

    /// Steps that are due after `seconds` more; negative and endless seconds count as none.
    pub fn advance(&mut self, seconds: f64) -> u32 {
        if seconds.is_finite() && seconds > 0.0 {
            self.owed += seconds;
        }
        // A hair of slack: six steps of 1/60 s are worth six, whatever rounding says.
        let due = ((self.owed / Self::STEP + 1e-9) as u64).min(u64::from(Self::MOST)) as u32;
        self.owed -= f64::from(due) * Self::STEP;
        if self.owed >= Self::STEP {
            self.owed = 0.0;
        }
        due
    }

    /// Plays one frame of a world and says how many steps that were.
    ///
    /// What is told once (a press, a key struck) reaches exactly one step: it waits for the next
    /// frame where this one has no step, and only the first of several steps sees it.
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
