//! Scenes that stay the same: while nothing moves, light is not computed again, so that a window in which nobody paints
//! leaves the machine alone.

use super::shown::Shown;
use lamplight::{Bounces, Cells, Settings};

/// The scene that was lit last, and the picture drawn with its light.
#[derive(Debug, Default)]
pub struct Still {
    lit: Option<(Cells, Settings)>,
    /// Frames since it changed.
    same_frames: u32,
    /// The picture, and the way it is shown, if its light has settled.
    drawn: Option<(Cells, Shown)>,
}

impl Still {
    /// Counts a frame. Returns true if the light has settled, so that computing it again would not change it.
    pub fn has_settled(&mut self, cells: &Cells, settings: &Settings) -> bool {
        let is_same = self.lit.as_ref().is_some_and(|(known, of)| known == cells && of == settings);
        self.same_frames = if is_same { self.same_frames.saturating_add(1) } else { 0 };
        match &mut self.lit {
            _ if is_same => {}
            // Into its own buffers.
            Some((known, of)) => {
                known.clone_from(cells);
                of.clone_from(settings);
            }
            none => *none = Some((cells.clone(), settings.clone())),
        }
        if settings.repeats() {
            return self.same_frames > 0;
        }
        // Light that is only fed back grows for so many frames; noise changes in all of them.
        let bounces = settings.bounces.within_a_frame();
        self.same_frames > Bounces::MAX && Settings { bounces, ..settings.clone() }.repeats()
    }

    /// Returns true if this picture was drawn last, with light that had settled. Otherwise it counts as drawn now.
    pub fn is_drawn(&mut self, picture: &Cells, shown: Shown, settled: bool) -> bool {
        let is_same = |(known, how): &(Cells, Shown)| *how == shown && known == picture;
        let is_drawn = settled && self.drawn.as_ref().is_some_and(is_same);
        if !is_drawn {
            self.drawn = settled.then(|| (picture.clone(), shown));
        }
        is_drawn
    }

    /// Makes the next frame be computed and drawn.
    pub fn forget(&mut self) {
        self.lit = None;
        self.drawn = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lamplight::Method;

    /// The frame, from 0 on, from which the light of a scene that stays the same has settled, among twice as many as light
    /// may grow over.
    fn first_settled(still: &mut Still, settings: &Settings) -> Option<u32> {
        let cells = Cells::new(4, 4).unwrap();
        (0..2 * Bounces::MAX).find(|_| still.has_settled(&cells, settings))
    }

    #[test]
    fn light_that_grows_over_frames_settles_later_and_noise_never() {
        let of = |method, bounces| Settings { bounces, ..Settings::direct(method) };
        let mut still = Still::default();
        let mut settles = |method, bounces| first_settled(&mut still, &of(method, bounces));
        let none = Bounces::Count(0);
        assert_eq!(settles(Method::Holographic, none), Some(1));
        assert_eq!(settles(Method::Holographic, Bounces::Feedback), Some(Bounces::MAX + 1));
        assert_eq!(settles(Method::Polar, Bounces::Feedback), Some(1), "it has no bounces");
        for bounces in [none, Bounces::Feedback] {
            assert_eq!(settles(Method::Raymarch, bounces), None);
            assert_eq!(settles(Method::Flood, bounces), None);
        }
        let direct = of(Method::Holographic, none);
        assert_eq!(first_settled(&mut still, &direct), Some(1));
        still.forget();
        assert_eq!(first_settled(&mut still, &direct), Some(1), "it was forgotten");
    }
}
