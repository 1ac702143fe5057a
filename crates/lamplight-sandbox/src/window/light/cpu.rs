//! On the CPU, where there is no GPU that can.

use super::Shown;
use anyhow::Result;
use eframe::egui::{Color32, ColorImage, Context, Pos2, Rect, TextureHandle, TextureOptions, Ui};
use lamplight::{Cells, Light, Settings, Solver};
use std::time::Duration;

/// Light on the CPU, handed to the window as a picture.
pub struct OnCpu {
    settings: Settings,
    solver: Solver,
    picture: TextureHandle,
}

impl OnCpu {
    pub fn new(context: &Context, settings: &Settings) -> Result<Self> {
        let black = ColorImage::filled([1, 1], Color32::BLACK);
        Ok(Self {
            settings: settings.clone(),
            solver: Solver::new(settings.clone())?,
            picture: context.load_texture("light", black, TextureOptions::NEAREST),
        })
    }

    pub fn find(&mut self, cells: &Cells, settings: &Settings, shown: Shown) -> Result<()> {
        if self.settings != *settings {
            self.solver = Solver::new(settings.clone())?;
            self.settings = settings.clone();
        }
        let light = self.solver.solve(cells)?;
        let picture = match shown.light_alone {
            true => light.picture(&shown.display),
            false => light.compose(cells, &shown.display)?,
        };
        let size = [picture.width() as usize, picture.height() as usize];
        let image = ColorImage::from_rgb(size, picture.as_raw());
        let options = if shown.smooth { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        self.picture.set(image, options);
        Ok(())
    }

    pub fn draw(&self, ui: &Ui, place: Rect) {
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        ui.painter().image(self.picture.id(), place, all, Color32::WHITE);
    }

    pub fn light(&self) -> &Light {
        self.solver.light()
    }

    pub fn stages(&self) -> &[(&'static str, Duration)] {
        self.solver.timings()
    }
}
