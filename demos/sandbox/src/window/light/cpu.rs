//! The CPU backend.

use super::shown::Shown;
use anyhow::{Context as _, Result};
use eframe::egui::{
    Color32, ColorImage, Context, Painter, Pos2, Rect, TextureHandle, TextureOptions,
};
use lamplight::resample::upsample;
use lamplight::{Bounces, Cells, Light, Settings, Solver};
use std::borrow::Cow;
use std::time::Duration;

/// Light computed on the CPU, drawn as a picture.
pub struct OnCpu {
    context: Context,
    settings: Settings,
    solver: Solver,
    /// The cells lit last.
    cells: Option<Cells>,
    /// Frames since they changed.
    same_frames: u32,
    picture: TextureHandle,
    /// The cells that the picture shows, and the way, if its light has settled.
    drawn: Option<(Cells, Shown)>,
}

impl OnCpu {
    pub fn new(context: &Context, settings: &Settings) -> Result<Self> {
        let black = ColorImage::filled([1, 1], Color32::BLACK);
        Ok(Self {
            context: context.clone(),
            settings: settings.clone(),
            solver: Solver::new(settings.clone())?,
            cells: None,
            same_frames: 0,
            picture: context.load_texture("light", black, TextureOptions::NEAREST),
            drawn: None,
        })
    }

    /// Another one.
    pub fn beside(&self, settings: &Settings) -> Result<Self> {
        Self::new(&self.context, settings)
    }

    /// Forces the next frame to be computed.
    pub fn forget(&mut self) {
        self.cells = None;
    }

    pub fn find(
        &mut self,
        cells: &Cells,
        picture: &Cells,
        settings: &Settings,
        shown: Shown,
    ) -> Result<()> {
        if self.settings != *settings {
            self.solver = Solver::new(settings.clone())?;
            self.settings = settings.clone();
            self.cells = None;
        }
        let is_same = self.cells.as_ref() == Some(cells);
        self.same_frames = if is_same { self.same_frames.saturating_add(1) } else { 0 };
        let settled = match settings.bounces {
            Bounces::Feedback => self.same_frames > Bounces::MAX,
            _ => is_same && settings.repeats(),
        };
        if !settled {
            let mut known = self.cells.take();
            self.solver.solve(cells)?;
            // Into its own buffers.
            match &mut known {
                Some(known) => known.clone_from(cells),
                None => known = Some(cells.clone()),
            }
            self.cells = known;
        }
        let drawn = self.drawn.take().filter(|_| settled);
        if drawn.as_ref().is_some_and(|(known, how)| *how == shown && known == picture) {
            self.drawn = drawn;
            return Ok(());
        }
        let found = self.solver.light();
        let light = if [cells.width(), cells.height()] == [picture.width(), picture.height()] {
            Cow::Borrowed(found)
        } else {
            // Lamps are drawn in as the method sees them.
            let drawn = |cells: &'_ Cells| {
                if settings.method().lights_lamps() {
                    cells.clone()
                } else {
                    cells.drawn().into_owned()
                }
            };
            let spread = upsample(found, &drawn(cells), &drawn(picture));
            Cow::Owned(spread.context("the light is not of these cells")?)
        };
        let pixels = if shown.light_alone {
            light.picture(&shown.display)
        } else {
            light.compose(picture, &shown.display)?
        };
        let size = [pixels.width() as usize, pixels.height() as usize];
        let image = ColorImage::from_rgb(size, pixels.as_raw());
        let options = if shown.smooth { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        self.picture.set(image, options);
        self.drawn = settled.then(|| (picture.clone(), shown));
        Ok(())
    }

    pub fn draw(&self, painter: &Painter, place: Rect) {
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        painter.image(self.picture.id(), place, all, Color32::WHITE);
    }

    pub fn light(&self) -> &Light {
        self.solver.light()
    }

    pub fn stages(&self) -> &[(&'static str, Duration)] {
        self.solver.timings()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lamplight::{Display, Method};

    #[test]
    fn what_has_not_changed_is_not_drawn_again() {
        let context = Context::default();
        let settings = Settings::direct(Method::Holographic);
        let mut lit = OnCpu::new(&context, &settings).unwrap();
        let cells = Cells::new(16, 8).unwrap();
        let coarse = Cells::new(8, 4).unwrap();
        let mut is_drawn = |cells: &Cells, picture: &Cells, exposure| {
            context.tex_manager().write().take_delta().clear();
            let shown =
                Shown { display: Display { exposure, ..Display::default() }, ..Shown::default() };
            lit.find(cells, picture, &settings, shown).unwrap();
            let mut delta = context.tex_manager().write().take_delta();
            let is_drawn = !delta.set.is_empty();
            delta.clear();
            is_drawn
        };
        let mut colored = cells.clone();
        colored.color_mut().fill([0.2; 3]);
        for (cells, picture) in [(&colored, &colored), (&coarse, &cells), (&coarse, &colored)] {
            // Light is drawn when it is found, and once more as what stays.
            is_drawn(cells, picture, 0.0);
            is_drawn(cells, picture, 0.0);
            assert!(!is_drawn(cells, picture, 0.0));
            assert!(is_drawn(cells, picture, 1.0));
            assert!(!is_drawn(cells, picture, 1.0));
        }
        colored.color_mut()[3] = [0.3; 3];
        assert!(is_drawn(&coarse, &colored, 1.0));
        let mut lamps = coarse.clone();
        lamps.lamps_mut().push(lamplight::Lamp::default());
        assert!(is_drawn(&lamps, &colored, 1.0));
    }
}
