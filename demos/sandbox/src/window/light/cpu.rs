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
        let picture = if shown.light_alone {
            light.picture(&shown.display)
        } else {
            light.compose(picture, &shown.display)?
        };
        let size = [picture.width() as usize, picture.height() as usize];
        let image = ColorImage::from_rgb(size, picture.as_raw());
        let options = if shown.smooth { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        self.picture.set(image, options);
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
