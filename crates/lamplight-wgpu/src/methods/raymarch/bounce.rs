//! Light sent on by faces of walls and fog: a number of times, until it has converged, or once more
//! each frame.

use super::{Buffers, FOUR, Gather, Raymarch};
use crate::Result;
use crate::kernel::Dispatch;
use crate::site::Site;
use crate::stages::compare::Compare;
use crate::stages::convergence::Convergence;
use crate::stages::feedback::Feedback;
use lamplight::Settings;
use lamplight::settings::{BounceBy, Bounces};
use wgpu::{Buffer, Device};

/// Faces of a cell; fog sends on by the first.
const FACES: u64 = 4;

/// How light bounces.
#[derive(Debug)]
pub enum Bounce {
    Times(u32),
    Converged(Convergence, Compare),
    Feedback(Feedback),
}

impl Bounce {
    pub fn new(device: &Device, settings: &Settings) -> Self {
        match (settings.bounces, settings.raymarch.bounce) {
            (Bounces::Count(0), _) => Self::Times(0),
            (_, BounceBy::Feedback) => Self::Feedback(Feedback::new(device)),
            (Bounces::Count(times), BounceBy::Frame) => Self::Times(times),
            (Bounces::Converged, BounceBy::Frame) => {
                Self::Converged(Convergence::new(device), Compare::new(device))
            }
        }
    }

    /// Whether fog that sends light on is crossed cell by cell from the start. It saves finding squares
    /// anew in each of many rounds, most of which are recorded in vain; once fog is lit its cells differ
    /// anyway.
    pub fn keeps_fog_apart(&self) -> bool {
        matches!(self, Self::Converged(..))
    }

    /// What surfaces send on, before and after a bounce; next to nothing where light does not bounce.
    pub fn buffers(&self, site: &Site) -> Result<[Buffer; 2]> {
        let bytes = match self {
            Self::Times(0) => FOUR,
            _ => site.cells() * FACES * FOUR,
        };
        let after = match self {
            Self::Feedback(_) => site.kept("sent", bytes)?,
            _ => site.buffer("sent", bytes)?,
        };
        Ok([site.buffer("sent", bytes)?, after])
    }
}

impl Raymarch {
    /// All bounces, and what is sent after the last; `find` is repeated where fog sends other light.
    pub(super) fn bounce(
        &self,
        site: &Site,
        buffers: &Buffers,
        sent: &[Buffer; 2],
        find: &[Dispatch],
    ) -> Result<(Vec<Dispatch>, Buffer)> {
        let [one, other] = sent;
        let gather = |step, from, to| self.gather(site, Gather::Sent, buffers, step, [from, to]);
        let follow = |sent: &Buffer| {
            let mut dispatches = vec![self.optics.light_fog(site, &buffers.seen, sent)];
            dispatches.extend_from_slice(find);
            dispatches
        };
        let dispatches = match &self.bounce {
            Bounce::Times(times) => {
                let mut dispatches = Vec::new();
                let (mut from, mut to) = (one, other);
                for bounce in 0..*times {
                    dispatches.push(gather(bounce.min(1), from, to));
                    dispatches.extend(follow(to));
                    (from, to) = (to, from);
                }
                return Ok((dispatches, from.clone()));
            }
            Bounce::Converged(convergence, compare) => {
                let found = Convergence::found(site)?;
                let rounds = [0, 1].map(|step| {
                    let compare = compare.run(site, [one, other], &found, step);
                    let gathered = vec![gather(step, other, one), compare];
                    gathered.into_iter().chain(follow(other)).collect()
                });
                convergence.plan(site, &found, rounds)?
            }
            Bounce::Feedback(feedback) => {
                let mut dispatches = vec![feedback.take_over(site, &buffers.seen, other, one)];
                dispatches.extend(follow(one));
                dispatches.push(gather(1, one, other));
                dispatches.extend(follow(other));
                dispatches
            }
        };
        Ok((dispatches, other.clone()))
    }
}
