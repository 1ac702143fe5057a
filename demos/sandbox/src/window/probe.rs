//! The brightness at the pointer and of the player.

use crate::window::light::{Asked, Lit};
use crate::window::resolution::factor;
use anyhow::Result;
use eframe::egui::{Align2, Color32, FontId, Rect, Ui, Vec2};
use lamplight::{Cells, Light};

/// Frames per readback of light.
const EVERY: u32 = 6;

/// The light read back last.
#[derive(Default)]
pub struct Probe {
    light: Option<Light>,
    asked: Option<Asked>,
    at: Option<[f32; 2]>,
    frame: u32,
}

impl Probe {
    /// Reads light back every few frames, if the pointer is over the picture or `is_needed`.
    pub fn look(
        &mut self,
        lit: &Lit,
        cells: &Cells,
        at: Option<[f32; 2]>,
        is_needed: bool,
    ) -> Result<()> {
        if let Some(come) = lit.take(&mut self.asked)? {
            self.light = Some(come);
        }
        if self.frame.is_multiple_of(EVERY) && self.asked.is_none() && (is_needed || at.is_some()) {
            self.asked = Some(lit.ask(cells)?);
        }
        self.frame = self.frame.wrapping_add(1);
        self.at = at;
        Ok(())
    }

    pub fn light(&self) -> Option<&Light> {
        self.light.as_ref()
    }

    /// The light at the pointer, in a picture of `width` columns.
    pub fn words(&self, width: u32) -> String {
        let (Some(light), Some(at)) = (&self.light, self.at) else {
            return "point at something".into();
        };
        let size = factor(light, width) as f32;
        let [r, g, b] = light.sample(at.map(|v| v / size));
        let [x, y] = at.map(f32::floor);
        format!("{x:.0}, {y:.0}: {r:.3} {g:.3} {b:.3}")
    }
}

/// Draws the brightness of the player, 0 to 1, in a corner of the picture.
pub fn meter(ui: &Ui, place: Rect, lit: f32) {
    let size = Vec2::new(160.0, 14.0);
    let corner = place.left_bottom() + Vec2::new(10.0, -10.0 - size.y);
    let frame = Rect::from_min_size(corner, size);
    let painter = ui.painter();
    painter.rect_filled(frame.expand(2.0), 3.0, Color32::from_black_alpha(170));
    let lit = lit.clamp(0.0, 1.0);
    let shade = 60 + (150.0 * lit) as u8;
    let filled = Rect::from_min_size(corner, Vec2::new(size.x * lit, size.y));
    painter.rect_filled(filled, 2.0, Color32::from_rgb(shade, shade, shade / 2));
    let words = format!("you are {:.0} % lit", 100.0 * lit);
    let font = FontId::proportional(12.0);
    painter.text(frame.center(), Align2::CENTER_CENTER, words, font, Color32::WHITE);
}
