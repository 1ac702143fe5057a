//! Viewers: where an eye is, and how far and which way it looks.

use crate::{Cone, Error, Lamp, Result, check};
use std::fmt::Display;

/// A viewer, for [`SightSolver`](crate::SightSolver).
///
/// A place at distance d from the eye, in the direction φ, has the visibility
///
/// `V = v·T·cone(φ)·fade(d)`,
///
/// where v is the fraction of the eye's disc that no wall hides from the place, T the mean transmittance of media
/// between the two (its luminance), `cone` the share of the cone and `fade` the soft end of the range. In the open,
/// close by, V is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// The centre of the eye, px. Beyond the grid it looks in from outside, as if there were empty space; inside a wall
    /// it sees nothing.
    pub position: [f32; 2],
    /// The radius of the eye, px, 0.05 to 512. Higher: softer edges behind corners. Parts of the eye inside a wall, or
    /// behind one as seen from its centre, are blind, and the rest stands for all of it.
    pub size: f32,
    /// The distance from which on nothing is seen, px, 1 to 100 000. Higher: a field takes time in proportion to the
    /// square of it, a query to the distance of its point at most.
    pub range: f32,
    /// The fraction of the range, from its end inwards, over which sight fades (smoothstep), 0 to 1: 0 is a hard end, 1
    /// fades from the eye on.
    pub fade: f32,
    /// The cone that the eye looks in; `None` to look all round.
    pub cone: Option<Cone>,
}

impl Default for Sight {
    fn default() -> Self {
        Self { position: [0.0; 2], size: 1.0, range: 256.0, fade: 0.1, cone: None }
    }
}

impl Sight {
    /// Validates the viewer; `key` names it in the error.
    pub fn check(&self, key: &dyn Display) -> Result<()> {
        self.lamp().check(key)?;
        if self.cone.is_some_and(|cone| cone.profile.is_some()) {
            let expected = "none: only lamps have a profile";
            return Err(Error::value(format!("{key}.cone.profile"), "a list", expected));
        }
        check::number(format_args!("{key}.fade"), self.fade, 0.0..=1.0)
    }

    /// The lamp whose light falls on what the eye sees.
    pub(crate) fn lamp(&self) -> Lamp {
        let Self { position, size, range, cone, .. } = *self;
        Lamp { position, size, range, cone, ..Lamp::default() }
    }

    /// Returns the visibility without walls and media at an offset from the eye: 1 at the eye itself.
    pub(crate) fn share(&self, off: [f32; 2]) -> f32 {
        let distance = off[0].hypot(off[1]);
        if distance == 0.0 {
            return 1.0;
        }
        let left = self.range - distance;
        if left <= 0.0 {
            return 0.0;
        }
        let soft = self.fade * self.range;
        let t = if left < soft { left / soft } else { 1.0 };
        let fade = t * t * (3.0 - 2.0 * t);
        self.cone.map_or(fade, |cone| fade * cone.share(off[1].atan2(off[0])))
    }
}
