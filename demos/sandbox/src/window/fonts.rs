//! The font: of egui's the one for words, as its others would be a fifth of the web page.

use eframe::egui::{FontData, FontDefinitions, FontFamily};
use epaint_default_fonts::UBUNTU_LIGHT;
use std::sync::Arc;

/// The fonts of the window: one for all. Its digits are of one width, but it has no arrows or blocks.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let name = "Ubuntu Light";
    fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(UBUNTU_LIGHT)));
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec![name.to_owned()]);
    }
    fonts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::inspect::PictureView;
    use eframe::egui::{Context, FontId, RawInput};
    use lamplight::{Cells, Display, Lamp, Method, Scene, Settings, Solver};
    use lamplight_sandbox::worlds::WorldKind;
    use serde_json::Value;

    fn strings(value: &Value, into: &mut Vec<String>) {
        match value {
            Value::String(text) => into.push(text.clone()),
            Value::Array(all) => all.iter().for_each(|value| strings(value, into)),
            Value::Object(all) => all.values().for_each(|value| strings(value, into)),
            _ => {}
        }
    }

    #[test]
    fn the_font_has_every_letter_of_the_texts() {
        let mut texts = Vec::new();
        strings(&serde_json::to_value(Scene::schema()).unwrap(), &mut texts);
        texts.extend(PictureView::ALL.map(|view| view.words().to_owned()));
        for &kind in WorldKind::ALL {
            texts.push(kind.make([96, 54], 1).unwrap().help().to_owned());
        }
        let mut cells = Cells::new(32, 32).unwrap();
        cells.lamps_mut().push(Lamp { position: [16.0, 16.0], ..Lamp::default() });
        for &method in Method::ALL {
            let mut solver = Solver::new(Settings::new(method)).unwrap();
            solver.solve(&cells).unwrap();
            for i in 0..solver.debug_view_count() {
                let view = solver.debug_view(i, &Display::default()).unwrap();
                texts.push(format!("{} {}", view.name, view.description));
            }
        }
        let context = Context::default();
        context.set_fonts(fonts());
        let mut missing = Vec::new();
        let mut output = context.run_ui(RawInput::default(), |ui| {
            missing = ui.ctx().fonts_mut(|fonts| {
                let mut shows = |letter: char| {
                    letter.is_control() || fonts.has_glyph(&FontId::proportional(12.0), letter)
                };
                texts.iter().filter(|text| !text.chars().all(&mut shows)).collect()
            });
        });
        // No renderer takes the font's texture: egui panics on deltas dropped in silence.
        output.textures_delta.clear();
        assert!(texts.len() > 100 && missing.is_empty(), "{missing:?}");
    }
}
