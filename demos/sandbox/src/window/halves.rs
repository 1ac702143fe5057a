//! One light, or two side by side with a movable divider.

use crate::window::light::{Lit, Shown};
use crate::window::resolution::Resolution;
use anyhow::{Context as _, Result};
use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, Vec2,
};
use lamplight::{Cells, Method, Settings, SettingsTable};

/// The distance from the divider within which it can be dragged, points.
const GRIP: f32 = 8.0;

/// A light and its settings.
pub struct Half {
    pub settings: Settings,
    pub lit: Lit,
    /// Settings of all methods, for when another one is chosen.
    kept: SettingsTable,
    /// True if the last frame has light.
    is_lit: bool,
}

impl Half {
    fn new(settings: Settings, lit: Lit) -> Self {
        Self { settings, lit, kept: SettingsTable::default(), is_lit: false }
    }

    /// Changes settings. Those of other methods than the current one wait until it is chosen.
    pub fn set(&mut self, over: SettingsTable) -> lamplight::Result<()> {
        let mut table = self.kept.clone();
        table.merge(SettingsTable::from(&self.settings));
        // A table leaves out defaults, which must not be those of a scene before.
        table.set("elevation", f64::from(self.settings.elevation));
        table.merge(over);
        self.settings = table.resolve()?;
        self.kept = table;
        Ok(())
    }

    /// Changes the method, and returns to the settings that it had when it was chosen last.
    pub fn choose(&mut self, method: Method) -> lamplight::Result<()> {
        if method == self.settings.method() {
            return Ok(());
        }
        let mut over = SettingsTable::default();
        over.set("method", method.name());
        self.set(over)
    }

    /// Computes the light of the next frame.
    pub fn find(&mut self, cells: &Cells, resolution: &Resolution, shown: Shown) -> Result<()> {
        let settings = resolution.settings(&self.settings);
        let found = self.lit.find(resolution.cells(cells), cells, &settings, shown);
        self.is_lit = found.is_ok();
        found
    }
}

/// The left light and, if the picture is split, the right one.
pub struct Halves {
    pub left: Half,
    pub right: Option<Half>,
    /// True if the panel shows the settings of the right one.
    pub edits_right: bool,
    /// Position of the divider, 0 (left edge) to 1.
    pub divider: f32,
}

impl Halves {
    pub fn new(settings: Settings, lit: Lit) -> Self {
        Self { left: Half::new(settings, lit), right: None, edits_right: false, divider: 0.5 }
    }

    /// The half whose settings the panel shows.
    pub fn edited(&mut self) -> &mut Half {
        match &mut self.right {
            Some(right) if self.edits_right => right,
            _ => &mut self.left,
        }
    }

    /// The half in which a place lies, 0 (left edge) to 1.
    pub fn under(&mut self, across: f32) -> &mut Half {
        match &mut self.right {
            Some(right) if across > self.divider => right,
            _ => &mut self.left,
        }
    }

    /// Splits the picture. Both lights use the same backend.
    pub fn split(&mut self, settings: Settings) -> Result<()> {
        let lit = self.left.lit.beside(&settings)?;
        self.right = Some(Half::new(settings, lit));
        self.edits_right = true;
        Ok(())
    }

    /// Removes the right light.
    pub fn join(&mut self) {
        (self.right, self.edits_right) = (None, false);
    }

    /// The left light and, if there is one, the right one.
    pub fn each(&mut self) -> impl Iterator<Item = &mut Half> {
        std::iter::once(&mut self.left).chain(&mut self.right)
    }

    /// Computes the light of the next frame of both.
    pub fn find(&mut self, cells: &Cells, resolution: &Resolution, shown: Shown) -> Result<()> {
        let left = self.left.find(cells, resolution, shown);
        let Some(right) = &mut self.right else { return left };
        let right = right.find(cells, resolution, shown);
        left.context("on the left").and(right.context("on the right"))
    }

    /// GPU memory of the lights in bytes, if known.
    pub fn memory(&mut self) -> Option<u64> {
        self.each().filter_map(|half| half.lit.memory()).reduce(|a, b| a + b)
    }

    /// Draws the light into a rectangle.
    pub fn draw(&mut self, ui: &mut Ui, place: Rect) {
        let draw = |half: &Half, painter: &Painter| {
            if half.is_lit {
                half.lit.draw(painter, place);
            }
        };
        let Some(right) = &self.right else { return draw(&self.left, ui.painter()) };
        let bar = place.left() + self.divider * place.width();
        let (here, there) = place.split_left_right_at_x(bar);
        draw(&self.left, &ui.painter_at(here));
        draw(right, &ui.painter_at(there));
        let painter = ui.painter_at(place);
        name(&painter, here.left_top(), Align2::LEFT_TOP, &self.left);
        name(&painter, there.right_top(), Align2::RIGHT_TOP, right);
        painter.vline(bar, place.y_range(), Stroke::new(2.0, Color32::from_white_alpha(200)));
        let grip = Rect::from_center_size(
            Pos2::new(bar, place.center().y),
            Vec2::new(2.0 * GRIP, place.height()),
        );
        let held = ui.interact(grip, ui.scope_id().with("divider"), Sense::drag());
        if let (true, Some(at)) = (held.dragged(), held.interact_pointer_pos()) {
            self.divider = ((at.x - place.left()) / place.width()).clamp(0.02, 0.98);
        }
        held.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    }
}

/// Labels a half with its method.
fn name(painter: &Painter, corner: Pos2, align: Align2, half: &Half) {
    let inwards = if align == Align2::LEFT_TOP { 8.0 } else { -8.0 };
    let (at, font) = (corner + Vec2::new(inwards, 6.0), FontId::proportional(14.0));
    let text = painter.layout_no_wrap(half.settings.method().name().into(), font, Color32::WHITE);
    let frame = align.anchor_size(at, text.size());
    painter.rect_filled(frame.expand(3.0), 3.0, Color32::from_black_alpha(150));
    painter.galley(frame.min, text, Color32::WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Context;
    use lamplight::settings::Raymarch;

    #[test]
    fn a_place_lies_in_the_half_that_is_drawn_there() {
        let settings = Settings::new(Method::Polar);
        let lit = Lit::on_cpu(&Context::default(), &settings).unwrap();
        let mut halves = Halves::new(settings, lit);
        let methods =
            |halves: &mut Halves| [0.2, 0.4].map(|across| halves.under(across).settings.method());
        assert_eq!(methods(&mut halves), [Method::Polar; 2]);
        halves.split(Settings::new(Method::Raymarch)).unwrap();
        halves.divider = 0.3;
        assert_eq!(methods(&mut halves), [Method::Polar, Method::Raymarch]);
        // Whichever half the panel shows.
        halves.edits_right = false;
        assert_eq!(methods(&mut halves), [Method::Polar, Method::Raymarch]);
    }

    #[test]
    fn a_method_keeps_its_settings_while_another_is_chosen() {
        let settings = Settings::default();
        let lit = Lit::on_cpu(&Context::default(), &settings).unwrap();
        let mut half = Half::new(settings.clone(), lit);
        let set = |half: &mut Half, text: &str| {
            let mut over = SettingsTable::default();
            over.set_from_text(text).unwrap();
            half.set(over)
        };
        // Set while another method is chosen, or while it is.
        set(&mut half, "raymarch.rays=7").unwrap();
        assert_eq!(half.settings, settings);
        half.choose(Method::Raymarch).unwrap();
        let rays = |rays| Settings::new(Raymarch { rays, ..Raymarch::default() });
        assert_eq!(half.settings, rays(7));
        half.settings = rays(9);
        for method in [Method::Holographic, Method::Polar, Method::Raymarch] {
            half.choose(method).unwrap();
        }
        assert_eq!(half.settings, rays(9));
        assert!(set(&mut half, "raymarch.rays=0").is_err());
        assert_eq!(half.settings, rays(9));
    }
}
