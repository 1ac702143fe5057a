//! What a plan takes for granted of matter.

use crate::stages::convergence;
use lamplight::{Bounces, Cells};

/// What is known of matter before it is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Known {
    /// Whether it may let channels through differently.
    pub tinted: bool,
    /// Rounds after which its light has converged, where that is asked and known.
    pub rounds: Option<u32>,
}

impl Known {
    /// Of the host's textures, which only the GPU sees.
    pub const NOTHING: Self = Self { tinted: true, rounds: None };

    pub fn of(cells: &Cells, bounces: Bounces) -> Self {
        let largest = || cells.albedo().as_flattened().iter().fold(0.0f32, |a, &b| a.max(b));
        let rounds = || convergence::rounds(largest(), cells.len());
        Self {
            tinted: cells.tint().iter().any(|[r, g, b]| r != g || g != b),
            rounds: (bounces == Bounces::Converged).then(rounds),
        }
    }

    /// Of the same matter, where light bounces so from now on.
    pub fn under(self, bounces: Bounces) -> Self {
        Self { rounds: self.rounds.filter(|_| bounces == Bounces::Converged), ..self }
    }

    /// Whether a plan that takes this for granted does for what is known now: rounds too many do no
    /// harm, but where nothing is known they are far too many.
    pub fn serves(self, now: Self) -> bool {
        let enough = match (self.rounds, now.rounds) {
            (Some(planned), Some(needed)) => planned >= needed,
            (planned, needed) => planned == needed,
        };
        self.tinted == now.tinted && enough
    }
}
