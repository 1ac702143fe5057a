//! Properties of the scene that a frame plan relies on.

use lamplight::internals::CONVERGED;
use lamplight::{Bounces, Cells};

/// Numbers of scattered radiance per cell: four faces, three channels.
const NUMBERS_PER_CELL: f64 = 4.0 * 3.0;

/// The granularity of the planned number of bounces, so that another albedo seldom needs another plan.
const BOUNCE_STEP: u32 = 16;

/// Properties of the scene that are known before it is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneHints {
    /// True if matter may have a tint.
    pub tinted: bool,
    /// The number of bounces after which light has converged, if convergence is wanted and the number known.
    pub bounces: Option<u32>,
}

impl SceneHints {
    /// The hints for the host's textures, which only the GPU reads.
    pub const UNKNOWN: Self = Self { tinted: true, bounces: None };

    /// The hints for a grid of cells.
    pub fn of(cells: &Cells, bounces: Bounces) -> Self {
        let albedo = || cells.albedo().as_flattened().iter().fold(0.0f32, |a, &b| a.max(b));
        let count = || bounces_to_convergence(albedo(), cells.len());
        Self {
            tinted: cells.tint().iter().any(|[r, g, b]| r != g || g != b),
            bounces: (bounces == Bounces::Converged).then(count),
        }
    }

    /// Returns whether a plan that was made with these hints serves a scene with others. A few bounces too many
    /// do no harm, but if their number was unknown there are far too many.
    pub fn serves(self, other: Self) -> bool {
        let enough = match (self.bounces, other.bounces) {
            (Some(planned), Some(needed)) => planned >= needed,
            (planned, needed) => planned == needed,
        };
        self.tinted == other.tinted && enough
    }
}

/// The number of bounces after which light between surfaces of at most this albedo has converged.
///
/// The largest change of a bounce is at most albedo × that of the one before. The mean scattered radiance, which
/// only grows, is at least the largest change of the first bounce ÷ the count of these numbers. In practice
/// the first is far smaller and the second far larger, which leaves room for methods that gain a little light.
fn bounces_to_convergence(albedo: f32, cells: usize) -> u32 {
    let most = Bounces::Converged.limit();
    if albedo >= 1.0 {
        return most;
    }
    let smallest = f64::from(CONVERGED) / (NUMBERS_PER_CELL * cells as f64);
    // Without any albedo nothing is left after the first bounce: ln 0 is −∞.
    let later = smallest.ln() / f64::from(albedo).ln();
    (1 + later.ceil() as u32).next_multiple_of(BOUNCE_STEP).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_bounces_grows_with_the_albedo() {
        let of = |albedo| bounces_to_convergence(albedo, 320 * 180);
        assert_eq!([0.0, 0.5, 0.8, 0.9, 0.95, 1.0].map(of), [16, 32, 96, 208, 256, 256]);
    }
}
