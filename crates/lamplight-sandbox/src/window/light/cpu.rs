//! On the CPU, where there is no GPU that can.

use super::Shown;
use anyhow::Result;
use eframe::egui::{
    Color32, ColorImage, Context, Painter, Pos2, Rect, TextureHandle, TextureOptions,
};
use lamplight::{Cells, Light, Settings, Solver};
use std::time::Duration;

/// Light on the CPU, handed to the window as a picture.
pub struct OnCpu {
    context: Context,
    settings: Settings,
    solver: Solver,
    /// What was lit last.
    cells: Option<Cells>,
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
            picture: context.load_texture("light", black, TextureOptions::NEAREST),
        })
    }

    /// Another one.
    pub fn beside(&self, settings: &Settings) -> Result<Self> {
        Self::new(&self.context, settings)
    }

    /// Finds light anew even where nothing has changed.
    pub fn forget(&mut self) {
        self.cells = None;
    }

    pub fn find(&mut self, cells: &Cells, settings: &Settings, shown: Shown) -> Result<()> {
        if self.settings != *settings {
            self.solver = Solver::new(settings.clone())?;
            self.settings = settings.clone();
            self.cells = None;
        }
        let is_still = settings.method.repeats() && self.cells.as_ref() == Some(cells);
        if !is_still {
            let mut known = self.cells.take();
            self.solver.solve(cells)?;
            // Into its own buffers.
            match &mut known {
                Some(known) => known.clone_from(cells),
                None => known = Some(cells.clone()),
            }
            self.cells = known;
        }
        let light = self.solver.light();
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
