//! The CPU backend.

use super::shown::Shown;
use anyhow::{Context as _, Result};
use eframe::egui::{
    Color32, ColorImage, Context, Painter, Pos2, Rect, TextureHandle, TextureOptions,
};
use lamplight::resample::upsample;
use lamplight::{Cells, Light, Settings, Solver};
use std::borrow::Cow;
use std::time::Duration;

/// Light computed on the CPU, drawn as a picture.
pub struct OnCpu {
    context: Context,
    solver: Solver,
    picture: TextureHandle,
}

impl OnCpu {
    pub fn new(context: &Context, settings: &Settings) -> Result<Self> {
        let black = ColorImage::filled([1, 1], Color32::BLACK);
        Ok(Self {
            context: context.clone(),
            solver: Solver::new(settings.clone())?,
            picture: context.load_texture("light", black, TextureOptions::NEAREST),
        })
    }

    /// Another one.
    pub fn beside(&self, settings: &Settings) -> Result<Self> {
        Self::new(&self.context, settings)
    }

    /// Computes the light of a frame.
    pub fn light(&mut self, cells: &Cells, settings: &Settings) -> Result<()> {
        self.solver.set_settings(settings.clone())?;
        self.solver.solve(cells)?;
        Ok(())
    }

    /// Prepares a picture with that light.
    pub fn prepare(&mut self, cells: &Cells, picture: &Cells, shown: Shown) -> Result<()> {
        let found = self.solver.light();
        let light = if [cells.width(), cells.height()] == [picture.width(), picture.height()] {
            Cow::Borrowed(found)
        } else {
            // Lamps are drawn in as the method sees them.
            let drawn = |cells: &'_ Cells| {
                if self.solver.settings().method().lights_lamps() {
                    cells.clone()
                } else {
                    cells.drawn().into_owned()
                }
            };
            let spread = upsample(found, &drawn(cells), &drawn(picture));
            Cow::Owned(spread.context("the light is not of these cells")?)
        };
        let pixels = if shown.light_alone {
            light.picture(&shown.display)?
        } else {
            light.compose(picture, &shown.display)?
        };
        let size = [pixels.width() as usize, pixels.height() as usize];
        let image = ColorImage::from_rgb(size, pixels.as_raw());
        let options = if shown.smooth { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        self.picture.set(image, options);
        Ok(())
    }

    pub fn draw(&self, painter: &Painter, place: Rect) {
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        painter.image(self.picture.id(), place, all, Color32::WHITE);
    }

    /// The light of the last frame.
    pub fn found(&self) -> &Light {
        self.solver.light()
    }

    pub fn stages(&self) -> &[(&'static str, Duration)] {
        self.solver.timings()
    }
}
